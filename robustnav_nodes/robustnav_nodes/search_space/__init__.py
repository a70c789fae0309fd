"""What a search can do: from a floor map to poses (G), candidate locations (H) and what sees what (L)."""

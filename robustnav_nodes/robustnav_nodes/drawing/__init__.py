"""What pictures of a search have in common."""

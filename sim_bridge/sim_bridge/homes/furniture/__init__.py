"""The kinds of furniture, room by room; `catalogue` knows them all."""

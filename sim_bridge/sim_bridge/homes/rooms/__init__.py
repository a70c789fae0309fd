"""Rooms: which a home has, how they are cut from its floor, and the walls around them."""

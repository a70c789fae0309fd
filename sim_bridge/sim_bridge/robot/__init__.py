"""The robot: how it moves, and how it finds its way without touching anything."""

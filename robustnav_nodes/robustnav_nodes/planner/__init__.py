"""Where to look next and how to end: POMCP over the search space, docking, and the course of one search."""

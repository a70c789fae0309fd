"""Homes as data: drawn from seeds or read from scene files, checked, and drawn as maps."""

"""Things moved into a home that no map knows."""

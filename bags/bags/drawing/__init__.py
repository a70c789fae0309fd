"""The parts of a search's picture, each drawn onto matplotlib axes in the map's metres."""

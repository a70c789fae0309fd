"""The tables of the thesis, and those of our own, runnable: scenes, episodes, figures and their intervals."""

"""Colours: quiet for the place, one warm scale for belief, one cool scale for time."""

from matplotlib.colors import LinearSegmentedColormap, LogNorm

INK, MUTED, FAINT = "#22272e", "#5b626c", "#8a919b"
FLOOR, UNKNOWN, WALL, UNTOLD = "#fafaf7", "#e2e3e0", "#4a515c", "#d9d3c7"
FALSE_ALARM, TARGET = "#d0021b", "#ffc61a"
BELIEF_COLORS = LinearSegmentedColormap.from_list("belief", ["#ece7dc", "#f6c48a", "#ec7c30", "#9c2f0b"])
TIME_COLORS = LinearSegmentedColormap.from_list("time", ["#34c3b5", "#2c7fd6", "#352f8f"])
BELIEF_SPAN = 100.0  # times as unlikely, and as likely, as in a uniform belief, at the ends of the colours


def belief_norm() -> LogNorm:
    """Maps how many times as likely as in a uniform belief a place is to 0..1, in logarithms."""
    return LogNorm(vmin=1.0 / BELIEF_SPAN, vmax=BELIEF_SPAN)

"""How fast images are looked at: rate and latency over the last ones."""

from collections import deque

import numpy as np

KEEP = 50


class Pace:
    """Times of the last `KEEP` images, seconds of any one clock that never jumps back."""

    def __init__(self) -> None:
        self._done_s: deque[float] = deque(maxlen=KEEP)
        self._latency_s: deque[float] = deque(maxlen=KEEP)

    def add(self, came_s: float, done_s: float) -> None:
        """An image that came at `came_s` was answered at `done_s`."""
        self._done_s.append(done_s)
        self._latency_s.append(done_s - came_s)

    def figures(self) -> dict[str, float]:
        """By name, for /diagnostics; without the rate until it can be told."""
        found = {}
        if self._latency_s:
            median, late = np.percentile(np.array(self._latency_s) * 1e3, (50.0, 95.0))
            found = {"latency ms, median": float(median), "latency ms, 95 %": float(late)}
        span_s = self._done_s[-1] - self._done_s[0] if self._done_s else 0.0
        if span_s > 0.0:
            found["images a second"] = (len(self._done_s) - 1) / span_s
        return found

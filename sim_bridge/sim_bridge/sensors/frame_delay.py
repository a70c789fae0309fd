"""Pictures on their way from the camera: some never arrive, the others arrive late."""

import math
from collections import deque
from typing import Generic, TypeVar

from robustnav_msgs_py.errors import BadParameterError
from sim_bridge.sensors.frame_noise import frame_rng

DROP_STREAM, DELAY_STREAM = 5, 6
NS_PER_S = 1_000_000_000
# More pictures than this are never on their way at once; the oldest give way.
MOST_UNDER_WAY = 64

Frame = TypeVar("Frame")


class FrameDropper:
    """Loses frames with probability `p_drop`, each by its number. Immutable."""

    def __init__(self, p_drop: float, seed: int) -> None:
        """Raises BadParameterError where `p_drop` is no probability."""
        if not 0.0 <= p_drop <= 1.0:
            raise BadParameterError(f"the probability to drop a frame must lie in 0..1, not {p_drop!r}")
        self._p_drop = p_drop
        self._seed = seed

    def drops(self, frame: int) -> bool:
        """Whether frame number `frame` gets lost."""
        return self._p_drop > 0.0 and frame_rng(self._seed, frame, DROP_STREAM).random() < self._p_drop


class FrameDelay(Generic[Frame]):
    """Frames on a line that keeps their order, in simulated time. Use it from one thread.

    Each takes `delay_s` plus something even in 0..`jitter_s`, and waits for those before it. What a frame
    holds, its stamp too, stays as it is.
    """

    def __init__(self, delay_s: float, jitter_s: float, seed: int, most: int = MOST_UNDER_WAY) -> None:
        """Raises BadParameterError for times that are negative or not finite, and room for no frame."""
        if not (math.isfinite(delay_s) and math.isfinite(jitter_s) and delay_s >= 0.0 and jitter_s >= 0.0):
            raise BadParameterError(
                f"frames cannot be late by {delay_s!r} s and up to {jitter_s!r} s more: give 0 s or more"
            )
        if most < 1:
            raise BadParameterError(f"a line with room for {most!r} frames loses all of them: give 1 or more")
        self._delay_s = delay_s
        self._jitter_s = jitter_s
        self._seed = seed
        self._line: deque[tuple[int, Frame]] = deque(maxlen=most)
        self.lost = 0

    def __len__(self) -> int:
        return len(self._line)

    def add(self, frame: Frame, number: int, now_ns: int) -> None:
        """Send frame number `number` at `now_ns`, in the order of their stamps.

        Where the line is full, its oldest frame is lost, and `lost` counts it.
        """
        jitter_s = 0.0
        if self._jitter_s > 0.0:
            jitter_s = frame_rng(self._seed, number, DELAY_STREAM).uniform(0.0, self._jitter_s)
        due_ns = now_ns + round((self._delay_s + jitter_s) * NS_PER_S)
        self.lost += len(self._line) == self._line.maxlen
        self._line.append((due_ns, frame))

    def due(self, now_ns: int) -> list[Frame]:
        """The frames that have arrived by `now_ns` and were not given out yet, in the order sent."""
        arrived = []
        while self._line and self._line[0][0] <= now_ns:
            arrived.append(self._line.popleft()[1])
        return arrived

    def reset(self) -> None:
        """Forget what is under way."""
        self._line.clear()
        self.lost = 0

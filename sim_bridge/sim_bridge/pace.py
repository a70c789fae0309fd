"""How many steps of simulated time are due as wall time goes by."""

# How long the executor may be kept busy before other callbacks get their turn; one image may take longer.
TURN_S = 0.01
# Wall time that is made up for after the executor was held up; more is dropped.
MOST_BEHIND_S = 0.2
SHORTEST_TIMER_S = 0.002
# A timer of exactly one period owes one step each time, however the seconds are rounded.
ROUNDING_STEPS = 1e-6


class Pace:
    """Keeps simulated time in step with wall time; what cannot be kept up with is dropped, not saved up.

    A machine that is too slow, or was asleep, then shows slower simulated time instead of a burst of steps.
    """

    def __init__(self, period_s: float, most_behind_s: float) -> None:
        """`period_s`: simulated time of one step; no more wall time than `most_behind_s` is made up for."""
        self._period_s = period_s
        self._most_behind_s = most_behind_s
        self._last_s: float | None = None
        self._owed = 0.0

    def restart(self) -> None:
        """Owe nothing, and start to count at the next `due`: after a pause."""
        self._last_s = None
        self._owed = 0.0

    def due(self, now_s: float, real_time_factor: float) -> int:
        """Steps that are owed at wall time `now_s`; call `done` for each that was made."""
        steps_per_s = real_time_factor / self._period_s
        if self._last_s is not None:
            self._owed += (now_s - self._last_s) * steps_per_s
        self._last_s = now_s
        self._owed = min(self._owed, max(1.0, self._most_behind_s * steps_per_s))
        return int(self._owed + ROUNDING_STEPS)

    def done(self) -> None:
        """One owed step was made."""
        self._owed -= 1.0

"""The health of one node, as it stands in /diagnostics once a second."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from robustnav_msgs_py.values import OK, WARN, Status

REMEMBER_S = 10.0
FORGET_S = 600.0


@dataclass(slots=True)
class _Problem:
    sentence: str
    logged: str
    level: int
    count: int
    last_s: float
    logged_s: float


class Health:
    """Collects figures and problems of one node; owned by the node, used in its executor thread only.

    A problem is logged when it first appears, again when it says something else (at most once in `REMEMBER_S`
    seconds for each place), and again when it comes back after `FORGET_S` seconds; it stays the node's
    message for `REMEMBER_S` seconds after its last occurrence.
    `log` takes a level (WARN or ERROR) and a sentence; `clock` gives monotonic seconds.
    """

    def __init__(self, log: Callable[[int, str], None], clock: Callable[[], float] = time.monotonic) -> None:
        self._log = log
        self._clock = clock
        self._figures: dict[str, str] = {}
        self._problems: dict[str, _Problem] = {}

    def figure(self, name: str, value: object) -> None:
        """Show `value` under `name` from now on; floats with four digits."""
        self._figures[name] = f"{value:.4g}" if isinstance(value, float) else str(value)

    def count(self, name: str, by: int = 1) -> None:
        """Add to the whole number shown under `name`."""
        self._figures[name] = str(int(self._figures.get(name, "0")) + by)

    def problem(self, where: str, sentence: str, level: int = WARN, detail: str = "") -> None:
        """Say that something is wrong at `where` (a topic, a file, a part of the node).

        `detail` (a traceback) goes to the log only.
        """
        now = self._clock()
        known = self._problems.get(where)
        if known is None or now - known.last_s > FORGET_S:
            self._problems[where] = _Problem(sentence, sentence, level, 1, now, now)
            self._log(level, f"{where}: {sentence}{detail}")
            return
        known.count, known.last_s, known.level = known.count + 1, now, level
        known.sentence = sentence
        if sentence != known.logged and now - known.logged_s > REMEMBER_S:
            known.logged, known.logged_s = sentence, now
            self._log(level, f"{where}: {sentence}{detail}")

    def status(self, name: str, waiting_for: list[str]) -> Status:
        """The status as of now; `waiting_for` lists inputs that have not come yet, which is no problem."""
        now = self._clock()
        recent = {
            where: problem for where, problem in self._problems.items() if now - problem.last_s <= REMEMBER_S
        }
        values = dict(self._figures)
        for where, problem in self._problems.items():
            values[f"problem {where}"] = f"{problem.sentence} ({problem.count} times)"
        if recent:
            worst = max(recent.values(), key=lambda problem: (problem.level, problem.last_s))
            return Status(name=name, level=max(worst.level, WARN), message=worst.sentence, values=values)
        message = f"waiting for {', '.join(waiting_for)}" if waiting_for else "ok"
        return Status(name=name, level=OK, message=message, values=values)

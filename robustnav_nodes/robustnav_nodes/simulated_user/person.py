"""The person, without ROS: what they say, given what they hear and how long they have waited."""

import math
import re
from collections import Counter
from collections.abc import Sequence
from enum import StrEnum

import numpy as np

from robustnav_msgs_py.values import ObjectInstance

NEAR_M = 1.0  # a place that the robot tells is right within this distance of the object
_PLACE = re.compile(r"x = (-?\d+(?:\.\d+)?) m, y = (-?\d+(?:\.\d+)?) m")


class Mood(StrEnum):
    """What the person is doing."""

    WANTS = "wants something"
    WAITS_FOR_ANSWER = "waits for an answer"
    WAITS_FOR_OBJECT = "waits for the object"
    DONE = "done"


def choose_target(objects: Sequence[ObjectInstance], seed: int) -> str | None:
    """A class to ask for, by seed: one with a single instance where there is one; None in an empty home."""
    counts = Counter(item.label for item in objects)
    single = sorted(label for label, count in counts.items() if count == 1)
    choices = single or sorted(counts)
    return choices[int(np.random.default_rng(seed).integers(len(choices)))] if choices else None


class Person:
    """Asks for `target`, asks again when nobody answers, thanks in the end, or says that it is not it.

    objects: what there really is. `hear` and `wait` return what the person says, or None. Times are seconds
    of any one clock.
    """

    def __init__(self, target: str, ask_again_s: float, objects: Sequence[ObjectInstance] = ()) -> None:
        self.target = target
        self._places_m = [(item.x_m, item.y_m) for item in objects if item.label == target]
        self.mood = Mood.WANTS
        self._ask_again_s = ask_again_s
        self._asked_s = 0.0

    def wait(self, now_s: float) -> str | None:
        """Time passes."""
        unanswered = self.mood is Mood.WAITS_FOR_ANSWER and now_s - self._asked_s >= self._ask_again_s
        if self.mood is not Mood.WANTS and not unanswered:
            return None
        self.mood, self._asked_s = Mood.WAITS_FOR_ANSWER, now_s
        return f"find the {self.target}"

    def hear(self, line: str) -> str | None:
        """The robot says something."""
        words = line.casefold()
        if self.mood is Mood.WAITS_FOR_ANSWER and "looking for the" in words:
            self.mood = Mood.WAITS_FOR_OBJECT
            return None
        if self.mood is Mood.WAITS_FOR_OBJECT and words.startswith("i found"):
            self.mood = Mood.DONE
            return "thank you" if self._is_there(line) else "no, that is not it"
        if self.mood is Mood.WAITS_FOR_OBJECT and words.startswith("i did not find"):
            self.mood = Mood.DONE
            return "thanks for trying"
        return None

    def _is_there(self, line: str) -> bool:
        """Whether the line tells a place of the target; nobody contradicts without knowing."""
        told = _PLACE.search(line)
        if told is None or not self._places_m:
            return True
        x_m, y_m = (float(number) for number in told.groups())
        return any(math.hypot(x_m - at[0], y_m - at[1]) <= NEAR_M for at in self._places_m)

"""One search for several targets at once."""

import time

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.course import Course, Step
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.watch import Watch
from robustnav_nodes.search_space.space import SearchSpace


class SeveralTargets(Course):
    """Looks for `targets` targets on one way through the place. Used from one thread at a time.

    Each target has its own belief and its own ending; where to look next is planned on the mean of the
    beliefs about those that are not found yet, so that every policy serves. A target that is found is noted
    in `found` and dropped; with docking, the robot goes up to it first. The last step's phase is FOUND once
    all of them are found, NOT_FOUND where some are not: `found` says which.

    found: for each target the candidate that it was found at, None where it was not. Used like a Search.
    """

    def __init__(
        self,
        *,
        space: SearchSpace,
        parameters: PlannerParameters,
        targets: int,
        rng: np.random.Generator,
        clock: Clock = time.monotonic,
    ) -> None:
        super().__init__(space=space, parameters=parameters, rng=rng, clock=clock)
        self._watches = [Watch(space.candidates, parameters) for _ in range(targets)]
        self._docking_to = 0  # target found last, which the robot may be docking to
        self.found: list[int | None] = [None] * targets

    @property
    def remaining(self) -> list[int]:
        """The targets that are not found yet."""
        return [target for target, location in enumerate(self.found) if location is None]

    def look(self, pose: int, in_view: Bool, probability: Float64) -> Step:
        """Take in what the robot knows at `pose` (in_view: bool [k]; probability: float64 [targets, k])."""
        sights = {
            target: self._watches[target].look(pose, in_view, probability[target])
            for target in self.remaining
        }
        step = self._next(sights, was_dropped=False)
        while step.phase is SearchPhase.FOUND:
            self.found[self._docking_to] = step.location
            self._docking_at, self._docking_view = None, None
            del sights[self._docking_to]
            if not sights:
                break
            step = self._next(sights, was_dropped=True)
        return step

    def move_to(self, space: SearchSpace) -> None:
        """See Course and Watch. What was found keeps its old candidate."""
        super().move_to(space)
        for watch in self._watches:
            watch.move_to(space.candidates, self._parameters)

    def _next(self, sights: dict[int, Sight], *, was_dropped: bool) -> Step:
        sight = _together(list(sights.values()), was_dropped=was_dropped)
        self._took_in(sight)
        asked = sights if self._docking_at is None else {self._docking_to: sights[self._docking_to]}
        found = None
        for target, of_target in asked.items():
            found = self._watches[target].ending.found(self._asked(of_target))
            if found is not None:
                self._docking_to = target
                break
        may_change = self._watches[self._docking_to].ending.may_change  # the endings are all of one kind
        return self._go_on(sight, found, may_change=may_change)


def _together(sights: list[Sight], *, was_dropped: bool) -> Sight:
    """What one look says about all of the targets; was_dropped: whether there was one more before."""
    return Sight(
        pose=sights[0].pose,
        probability=np.mean([sight.probability for sight in sights], axis=0),
        in_view=sights[0].in_view,
        rose=np.any([sight.rose for sight in sights], axis=0),
        is_new=was_dropped or any(sight.is_new for sight in sights),
    )

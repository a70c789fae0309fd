"""One search for one target, from the first look to the end."""

import time

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.course import Course, Step
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.watch import Watch
from robustnav_nodes.search_space.space import SearchSpace


class Search(Course):
    """Looks for one target until it is found or given up. Used from one thread at a time.

    Call `look` where the robot stands, with the belief that takes the view from there into account: at the
    start (C13: the start pose is observed too; the released code never looks from where it begins) and
    wherever it arrives. Go to the second pose of the answer's path, then call again.

    prior: R before the first look, float64 [k]; None: uniform.
    """

    def __init__(
        self,
        *,
        space: SearchSpace,
        parameters: PlannerParameters,
        rng: np.random.Generator,
        clock: Clock = time.monotonic,
        prior: Float64 | None = None,
    ) -> None:
        super().__init__(space=space, parameters=parameters, rng=rng, clock=clock)
        self._watch = Watch(space.candidates, parameters, prior)

    @property
    def threshold(self) -> float:
        """The probability in view that is enough."""
        return self._watch.ending.threshold

    def p_in_view(self, sight: Sight) -> float:
        """The probability that is held against the threshold: in view now, or when the docking began."""
        return self._watch.ending.p_in_view(self._asked(sight))

    def look(self, pose: int, in_view: Bool, probability: Float64) -> Step:
        """Take in what the robot knows at `pose` (in_view: bool [k]; probability: R, float64 [k])."""
        sight = self._watch.look(pose, in_view, probability)
        self._took_in(sight)
        ending = self._watch.ending
        return self._go_on(sight, ending.found(self._asked(sight)), may_change=ending.may_change)

    def move_to(self, space: SearchSpace) -> None:
        """See Course and Watch."""
        super().move_to(space)
        self._watch.move_to(space.candidates, self._parameters)

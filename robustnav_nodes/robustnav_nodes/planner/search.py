"""The course of one search on the pose graph, from the first look to the end."""

import time
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.docking import destination_pose
from robustnav_nodes.planner.ending import ending_of
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Choice, Sight, Situation, legal_actions
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.variants import policy_of
from robustnav_nodes.search_space.space import SearchSpace

# A probability that grew by less did not grow: a silent view lifts those at the belief's floor by up to that
# floor, relatively, when it makes the sum one again.
_ROSE = 1.001


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """What to do now. path: poses of the graph from here to the next goal or to the end of the docking, empty
    where the search has ended; location: the candidate that the target is found at or docked to, if any;
    choice: None where nothing was decided; begins_docking: whether this is the first step of a docking.
    """

    phase: SearchPhase
    sight: Sight
    path: tuple[int, ...] = ()
    location: int | None = None
    choice: Choice | None = None
    message: str = ""
    begins_docking: bool = False


class Search:
    """Looks for one target until it is found or given up. Used from one thread at a time.

    Call `look` where the robot stands, with the belief that takes the view from there into account: at the
    start (C13: the start pose is observed too; the released code never looks from where it begins) and
    wherever it arrives. Go to the second pose of the answer's path, then call again.
    """

    def __init__(
        self,
        *,
        space: SearchSpace,
        parameters: PlannerParameters,
        rng: np.random.Generator,
        clock: Clock = time.monotonic,
    ) -> None:
        self._space = space
        self._graph = space.graph
        self._parameters = parameters
        self._rng = rng
        self._policy = policy_of(space, parameters, clock)
        self.ending = ending_of(parameters, len(space.candidates))
        count = len(space.candidates)
        self._probability: Float64 = np.full(count, 1.0 / count)
        self._visited: Bool = np.zeros(len(space.graph), dtype=np.bool_)
        self._docking_at: int | None = None
        self._way: tuple[int, int] | None = None
        self.steps = 0

    def look(self, pose: int, in_view: Bool, probability: Float64) -> Step:
        """Take in what the robot knows at `pose` (in_view: bool [k]; probability: R, float64 [k])."""
        sight = Sight(
            pose=pose,
            probability=probability,
            in_view=in_view,
            rose=in_view & (probability > self._probability * _ROSE),
            is_new=not np.array_equal(probability, self._probability),
        )
        self._visited[pose] = True
        if sight.is_new or self.steps == 0:
            self._policy.looked(sight)
            self.ending.looked(sight)
        self._probability = probability

        docked = self._docking_at is not None and pose == self._destination(pose, self._docking_at)
        location = self._docking_at
        if location is None or (docked and self._parameters.confirm_at_dock):
            location = self.ending.found(sight)
        if location is None:
            return self._search(sight, "looked again, not there; " if docked else "")
        if not self._parameters.dock:
            return Step(phase=SearchPhase.FOUND, sight=sight, location=location)
        if docked and (location == self._docking_at or not self._parameters.confirm_at_dock):
            return Step(phase=SearchPhase.FOUND, sight=sight, location=location)
        return self._dock(sight, location)

    def close_way(self) -> None:
        """The pose that was to come next cannot be reached: never try that way again in this search."""
        if self._way is not None:
            self._graph = self._graph.without_way(*self._way)
            self._way = None

    def _destination(self, pose: int, location: int) -> int | None:
        return destination_pose(self._space, self._graph, pose, location, self._parameters.docking_distance_m)

    def _search(self, sight: Sight, message: str) -> Step:
        self._docking_at = None
        if self.steps >= self._parameters.max_steps:
            return self._give_up(sight, f"not found within {self._parameters.max_steps} steps")
        if len(legal_actions(self._graph, sight.pose)) == 0:
            return self._give_up(sight, "every way from here is closed")
        situation = Situation(graph=self._graph, sight=sight, visited=self._visited, step=self.steps)
        choice = self._policy.decide(situation, self._rng)
        if choice is None:
            return self._give_up(sight, "not found, though looked for from everywhere")
        path = (sight.pose, int(self._graph.successors[sight.pose, choice.action]))
        return self._go(SearchPhase.SEARCHING, sight, path, choice=choice, message=message)

    def _dock(self, sight: Sight, location: int) -> Step:
        destination = self._destination(sight.pose, location)
        path = None if destination is None else self._graph.shortest_path(sight.pose, destination)
        if path is None:
            return self._search(sight, "found it, but there is no way to it; ")
        if len(path) == 1:
            return Step(phase=SearchPhase.FOUND, sight=sight, location=location)
        if self.steps >= self._parameters.max_steps:
            return self._give_up(sight, f"not reached within {self._parameters.max_steps} steps")
        begins = self._docking_at != location
        self._docking_at = location
        return self._go(SearchPhase.DOCKING, sight, path, location=location, begins_docking=begins)

    def _go(
        self,
        phase: SearchPhase,
        sight: Sight,
        path: tuple[int, ...],
        *,
        choice: Choice | None = None,
        location: int | None = None,
        message: str = "",
        begins_docking: bool = False,
    ) -> Step:
        self._way = (path[0], path[1])
        self.steps += 1
        return Step(
            phase=phase,
            sight=sight,
            path=path,
            location=location,
            choice=choice,
            message=message,
            begins_docking=begins_docking,
        )

    def _give_up(self, sight: Sight, message: str) -> Step:
        self._docking_at = None
        return Step(phase=SearchPhase.NOT_FOUND, sight=sight, message=message)

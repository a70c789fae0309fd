"""The course of a search on the pose graph: where the robot has been, and where it goes next."""

import dataclasses
import time
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Bool, Pose2D
from robustnav_nodes.planner.docking import destination_pose
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Choice, Sight, Situation
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.variants import policy_of
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Step:
    """What to do now. path: poses of the graph from here to the next goal or to the end of the docking, empty
    where the search has ended; location: the candidate that the target is found at or docked to, if any;
    choice: None where nothing was decided; elapsed_ms: what deciding took; begins_docking: whether this is
    the first step of a docking.
    """

    phase: SearchPhase
    sight: Sight
    path: tuple[int, ...] = ()
    location: int | None = None
    choice: Choice | None = None
    elapsed_ms: float = 0.0
    message: str = ""
    begins_docking: bool = False


class Course:
    """What a search has whatever it looks for: its policy, the ways that are open, and the docking.

    Used from one thread at a time.
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
        self._clock = clock
        self._policy = policy_of(space, parameters, clock)
        self._visited: Bool = np.zeros(len(space.graph), dtype=np.bool_)
        self._start: int | None = None
        self._docking_at: int | None = None
        self._docking_view: Bool | None = None
        self._way: tuple[int, int] | None = None
        self._closed: list[tuple[Pose2D, Pose2D]] = []
        self.steps = 0

    @property
    def graph(self) -> PoseGraph:
        """The poses and the ways that are open."""
        return self._graph

    def move_to(self, space: SearchSpace) -> None:
        """Go on in `space`, the same place with a map that has grown or changed.

        Where the robot has been, the steps taken and the ways that proved closed are carried over. A docking
        is decided anew.
        """
        before, self._space, self._graph = self._graph, space, space.graph
        been = [before.pose(int(pose)) for pose in np.nonzero(self._visited)[0]]
        self._visited = np.zeros(len(space.graph), dtype=np.bool_)
        self._visited[[space.graph.nearest(pose) for pose in been]] = True
        if self._start is not None:
            self._start = space.graph.nearest(before.pose(self._start))
        for begins, ends in self._closed:
            self._graph = self._graph.without_way(space.graph.nearest(begins), space.graph.nearest(ends))
        self._policy = policy_of(space, self._parameters, self._clock)
        self._docking_at, self._docking_view, self._way = None, None, None

    def close_way(self) -> None:
        """The pose that was to come next cannot be reached: never try that way again in this search."""
        if self._way is not None:
            begins, ends = self._way
            self._closed.append((self._graph.pose(begins), self._graph.pose(ends)))
            self._graph = self._graph.without_way(begins, ends)
            self._way = None

    def _took_in(self, sight: Sight) -> None:
        """The robot has looked from the sight's pose."""
        if self._start is None:
            self._start = sight.pose
        self._visited[sight.pose] = True
        if sight.is_new:
            self._policy.looked(sight)

    def _asked(self, sight: Sight) -> Sight:
        """The look by which to judge whether the target is found.

        On the way to the dock and at it, that is whether what was in view when the docking began still holds
        the target: from near by, less of it may be in view.
        """
        view = self._docking_view
        return sight if view is None else dataclasses.replace(sight, in_view=view)

    def _go_on(self, sight: Sight, found: int | None, *, may_change: bool) -> Step:
        """Search on, dock or end, where the look says that the target is `found` at a candidate or not.

        may_change: whether another look, at the dock, can take a find back.
        """
        confirms = self._parameters.confirm_at_dock and may_change
        docked = self._docking_at is not None and sight.pose == self._destination(
            sight.pose, self._docking_at
        )
        location = self._docking_at
        if location is None or (docked and confirms):
            location = found
        if location is None:
            return self._search(sight, "looked again, not there; " if docked else "")
        if not self._parameters.dock:
            return Step(phase=SearchPhase.FOUND, sight=sight, location=location)
        if docked and (location == self._docking_at or not confirms):
            return Step(phase=SearchPhase.FOUND, sight=sight, location=location)
        return self._dock(sight, location)

    def _destination(self, pose: int, location: int) -> int | None:
        return destination_pose(self._space, self._graph, pose, location, self._parameters.docking_distance_m)

    def _search(self, sight: Sight, message: str) -> Step:
        self._docking_at, self._docking_view = None, None
        if self.steps >= self._parameters.max_steps:
            return self._give_up(sight, f"not found within {self._parameters.max_steps} steps")
        if not self._graph.legal_actions(sight.pose):
            return self._give_up(sight, "every way from here is closed")
        situation = Situation(
            graph=self._graph,
            sight=sight,
            visited=self._visited,
            step=self.steps,
            start=sight.pose if self._start is None else self._start,
        )
        began = self._clock()
        choice = self._policy.decide(situation, self._rng)
        elapsed_ms = 1000.0 * (self._clock() - began)
        if choice is None:
            return self._give_up(sight, "not found, though looked for from everywhere")
        path = (sight.pose, int(self._graph.successors[sight.pose, choice.action]))
        self._way = path
        self.steps += 1
        return Step(
            phase=SearchPhase.SEARCHING,
            sight=sight,
            path=path,
            choice=choice,
            elapsed_ms=elapsed_ms,
            message=message,
        )

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
        if self._docking_view is None:
            self._docking_view = sight.in_view
        self._docking_at = location
        self._way = (path[0], path[1])
        self.steps += 1
        return Step(
            phase=SearchPhase.DOCKING, sight=sight, path=path, location=location, begins_docking=begins
        )

    def _give_up(self, sight: Sight, message: str) -> Step:
        self._docking_at, self._docking_view = None, None
        return Step(phase=SearchPhase.NOT_FOUND, sight=sight, message=message)

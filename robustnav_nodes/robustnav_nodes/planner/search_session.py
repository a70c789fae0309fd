"""The course of one search, from the first look to the end, without ROS."""

import time
from dataclasses import dataclass, replace

import numpy as np

from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_msgs_py.values import BeliefCloud, Float64, Pose2D
from robustnav_nodes.planner.docking import destination_pose
from robustnav_nodes.planner.exit_condition import exit_threshold, most_likely_in_view
from robustnav_nodes.planner.look import Look, look_around
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.particles import CandidatesNotRuledOut, ParticleFilter, ParticleSource
from robustnav_nodes.planner.pomcp import Clock, Plan, plan
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.search_space.pose_graph import Action
from robustnav_nodes.search_space.space import SearchSpace

_ENDED = (SearchPhase.FOUND, SearchPhase.NOT_FOUND, SearchPhase.STOPPED)


@dataclass(frozen=True, slots=True, kw_only=True)
class NextStep:
    """What to do now. `goal` is where to drive, None where the search has ended (see `state.phase`).

    path: from the robot's pose on the graph to the goal, or to the end of the docking; decision: None where
    nothing was decided (on the way of a docking, or after the end).
    """

    state: SearchState
    goal: Pose2D | None = None
    path: tuple[Pose2D, ...] = ()
    decision: Decision | None = None


class SearchSession:
    """Looks for one target until it is found, given up or stopped.

    Call `observe` where the robot stands, with the belief that takes the view from there into account: at
    the start (C13: the start pose is observed too; the released code never looks from where it begins) and
    wherever it arrives. Drive to the goal of the answer, then call again; call `blocked` instead where the
    goal could not be reached. These two belong to one thread at a time and take as long as a decision;
    `stop`, `state` and `ended` may be called from any thread meanwhile.
    """

    def __init__(
        self,
        *,
        target: str,
        space: SearchSpace,
        parameters: PlannerParameters,
        rng: np.random.Generator,
        clock: Clock = time.monotonic,
        episode: int = 0,
    ) -> None:
        self._space = space
        self._graph = space.graph
        self._parameters = parameters
        self._rng = rng
        self._clock = clock
        count = len(space.candidates)
        self._tau = exit_threshold(count, parameters.confidence, parameters.tau_max)
        self._particles = _particle_source(space, parameters)
        self._visited = np.zeros(len(space.graph), dtype=np.bool_)
        self._probability: Float64 = np.full(count, 1.0 / count)
        self._robot: Pose2D | None = None
        self._way: tuple[int, int] | None = None
        self._docking_at: int | None = None
        self._stop_message: str | None = None
        self._state = SearchState(
            phase=SearchPhase.SEARCHING, target=target, episode=episode, max_steps=parameters.max_steps
        )

    @property
    def state(self) -> SearchState:
        """How the search stands."""
        state = self._state
        if self._stop_message is None or state.phase in _ENDED:
            return state
        return replace(state, phase=SearchPhase.STOPPED, message=self._stop_message)

    @property
    def ended(self) -> bool:
        """True once the target was found or given up, or the search was stopped."""
        return self.state.phase in _ENDED

    def observe(self, robot: Pose2D, cloud: BeliefCloud) -> NextStep:
        """Take in where the robot stands and what is believed there, and say what to do next.

        Raises BadMessageError where `cloud` is not about this search space's candidates.
        """
        if self.ended:
            return NextStep(state=self.state)
        step = self._next_step(robot, cloud)
        return step if self._stop_message is None else NextStep(state=self.state)

    def blocked(self, robot: Pose2D, cloud: BeliefCloud) -> NextStep:
        """The last goal cannot be reached: close the way to it for the rest of this search, and go on."""
        if self._way is not None and not self.ended:
            self._graph = self._graph.without_way(*self._way)
            self._way = None
        return self.observe(robot, cloud)

    def stop(self, message: str = "stopped") -> SearchState:
        """End the search as it stands, also while a decision is being made."""
        self._stop_message = message
        return self.state

    def _next_step(self, robot: Pose2D, cloud: BeliefCloud) -> NextStep:
        look = self._look(robot, cloud)
        docked = self._docking_at is not None and look.pose == self._destination(look.pose, self._docking_at)
        location = self._docking_at
        if location is None or (docked and self._confirms):
            location = self._exit_location(look)
        if location is None:
            return self._search(look, "looked again, not there" if docked else "")
        if docked and (location == self._docking_at or not self._confirms):
            return self._found(location, look)
        return self._dock(look, location)

    @property
    def _confirms(self) -> bool:
        return self._parameters.confirm_at_dock and self._ends_by_belief

    @property
    def _ends_by_belief(self) -> bool:
        return self._parameters.variant in ("pomp_pd", "pomp_be_pd")

    def _look(self, robot: Pose2D, cloud: BeliefCloud) -> Look:
        look = look_around(self._space, self._graph, robot, cloud, self._probability)
        if look.is_new:
            self._particles.looked(look.in_view, look.rose, look.probability)
        self._probability = look.probability
        self._visited[look.pose] = True
        moved_m = 0.0 if self._robot is None else robot.distance_m(self._robot)
        self._robot = robot
        self._state = replace(self._state, path_length_m=self._state.path_length_m + moved_m)
        self._show(look.best, look)
        return look

    def _show(self, location: int, look: Look) -> None:
        """Report `location` as the best in the state."""
        self._state = replace(
            self._state,
            p_best=float(look.probability[location]),
            best_x_m=float(self._space.candidates.x_m[location]),
            best_y_m=float(self._space.candidates.y_m[location]),
        )

    def _exit_location(self, look: Look) -> int | None:
        """The location at which the search may end now, if any."""
        if not self._ends_by_belief:  # POMP ends at the first detection
            risen = most_likely_in_view(look.probability, look.rose & look.is_new)
            return None if risen is None else risen[0]
        if look.best_in_view is None or look.best_in_view[1] < self._tau:
            return None
        return look.best_in_view[0]

    def _destination(self, pose: int, location: int) -> int | None:
        return destination_pose(self._space, self._graph, pose, location, self._parameters.docking_distance_m)

    def _search(self, look: Look, message: str) -> NextStep:
        self._docking_at = None
        if self._state.step >= self._parameters.max_steps:
            return self._end(SearchPhase.NOT_FOUND, f"not found within {self._parameters.max_steps} steps")
        if not self._graph.legal_actions(look.pose):
            return self._end(SearchPhase.NOT_FOUND, "every way from here is closed")
        model = search_model(
            self._graph, self._space.observability, look.pose, self._visited, self._parameters
        )
        particles = self._particles.draw(self._parameters.simulations, self._rng)
        chosen = plan(SEARCH, model, particles, self._parameters, self._rng, self._clock)
        self._particles.decided(chosen, particles)
        goal = int(self._graph.successors[look.pose, chosen.action])
        action = Action(chosen.action).text
        reason = (
            f"{message + '; ' if message else ''}{action} is worth {chosen.values[chosen.action]:.1f} "
            f"over {chosen.simulations} simulations"
        )
        return self._go(SearchPhase.SEARCHING, look, (look.pose, goal), action, reason, chosen)

    def _dock(self, look: Look, location: int) -> NextStep:
        destination = self._destination(look.pose, location)
        path = None if destination is None else self._graph.shortest_path(look.pose, destination)
        if path is None:
            return self._search(look, "found it, but there is no way to it")
        if len(path) == 1:
            return self._found(location, look)
        if self._state.step >= self._parameters.max_steps:
            return self._end(SearchPhase.NOT_FOUND, f"not reached within {self._parameters.max_steps} steps")
        begins = self._docking_at != location
        self._docking_at = location
        reason = f"{self._found_text(location, look)}, tau {self._tau:.3g}; {len(path) - 1} steps to go"
        step = self._go(SearchPhase.DOCKING, look, path, "dock", reason, None)
        return step if begins else replace(step, decision=None)

    def _go(
        self,
        phase: SearchPhase,
        look: Look,
        path: tuple[int, ...],
        action: str,
        reason: str,
        chosen: Plan | None,
    ) -> NextStep:
        """Take the first step of `path`."""
        self._way = (path[0], path[1])
        self._state = replace(self._state, phase=phase, step=self._state.step + 1, message=reason)
        poses = tuple(self._graph.pose(pose) for pose in path)
        here, goal = poses[0], poses[1]
        legal = self._graph.legal_actions(look.pose) if chosen is not None else ()
        decision = Decision(
            episode=self._state.episode,
            step=self._state.step,
            planner=self._parameters.variant,
            action=action,
            actions=tuple(option.text for option in legal),
            values=tuple(float(chosen.values[option]) for option in legal) if chosen is not None else (),
            visits=tuple(int(chosen.visits[option]) for option in legal) if chosen is not None else (),
            simulations=chosen.simulations if chosen is not None else 0,
            elapsed_ms=chosen.elapsed_ms if chosen is not None else 0.0,
            p_in_view=look.best_in_view[1] if look.best_in_view is not None else 0.0,
            tau=self._tau,
            entropy=look.normalised_entropy(),
            x_m=here.x_m,
            y_m=here.y_m,
            yaw_rad=here.yaw_rad,
            goal_x_m=goal.x_m,
            goal_y_m=goal.y_m,
            goal_yaw_rad=goal.yaw_rad,
            reason=reason,
        )
        return NextStep(state=self._state, goal=goal, path=poses, decision=decision)

    def _found(self, location: int, look: Look) -> NextStep:
        self._show(location, look)
        return self._end(SearchPhase.FOUND, self._found_text(location, look))

    def _end(self, phase: SearchPhase, message: str) -> NextStep:
        self._docking_at = None
        self._state = replace(self._state, phase=phase, message=message)
        return NextStep(state=self._state)

    def _found_text(self, location: int, look: Look) -> str:
        x_m, y_m = self._space.candidates.x_m[location], self._space.candidates.y_m[location]
        return f"{self._state.target} near ({x_m:.2f}, {y_m:.2f}) m with p {look.probability[location]:.3g}"


def _particle_source(space: SearchSpace, parameters: PlannerParameters) -> ParticleSource:
    if parameters.variant in ("pomp_be", "pomp_be_pd"):
        return CandidatesNotRuledOut(space.observability.seen_from_somewhere())
    return ParticleFilter(space.candidates, parameters.reinvigoration_radius_m)

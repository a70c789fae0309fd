"""One search as the robot and the person know it: metres, names and records around a `Search`."""

import contextlib
import time
from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_msgs_py.values import BeliefCloud, Pose2D
from robustnav_nodes.planner.cloud_check import check_cloud
from robustnav_nodes.planner.course import Step
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.search import Search
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
    the start and wherever it arrives. Drive to the goal of the answer, then call again; call `blocked`
    instead where the goal could not be reached. These two belong to one thread at a time and take as long as
    a decision; everything else may be called from any thread meanwhile.
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
        self._parameters = parameters
        self._search = Search(space=space, parameters=parameters, rng=rng, clock=clock)
        self._robot: Pose2D | None = None
        self._stop_message: str | None = None
        self._new_space: deque[SearchSpace] = deque(maxlen=1)  # filled by another thread than emptied
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
        self._take_new_space()
        check_cloud(self._space, cloud)
        pose = self._space.graph.nearest(robot)
        step = self._search.look(pose, self._space.visible(robot), cloud.probability)
        next_step = self._told(robot, step)
        return next_step if self._stop_message is None else NextStep(state=self.state)

    def blocked(self, robot: Pose2D, cloud: BeliefCloud) -> NextStep:
        """The last goal cannot be reached: close the way to it for the rest of this search, and go on."""
        if not self.ended:
            self._search.close_way()
            self._take_new_space()
        return self.observe(robot, cloud)

    def move_to(self, space: SearchSpace) -> None:
        """Go on in `space`, whose map has grown or changed, from the next observation on."""
        self._new_space.append(space)

    def stop(self, message: str = "stopped") -> SearchState:
        """End the search as it stands, also while a decision is being made."""
        self._stop_message = message
        return self.state

    def _take_new_space(self) -> None:
        with contextlib.suppress(IndexError):  # there is none
            self._space = self._new_space.pop()
            self._search.move_to(self._space)

    def _told(self, robot: Pose2D, step: Step) -> NextStep:
        """`step` in the words of the graph."""
        moved_m = 0.0 if self._robot is None else robot.distance_m(self._robot)
        self._robot = robot
        best = step.sight.best if step.location is None else step.location
        message = self._message(step)
        self._state = replace(
            self._state,
            phase=step.phase,
            step=self._search.steps,
            message=message,
            path_length_m=self._state.path_length_m + moved_m,
            p_best=float(step.sight.probability[best]),
            best_x_m=float(self._space.candidates.x_m[best]),
            best_y_m=float(self._space.candidates.y_m[best]),
        )
        if not step.path:
            return NextStep(state=self._state)
        poses = tuple(self._space.graph.pose(pose) for pose in step.path)
        decided = step.choice is not None or step.begins_docking
        decision = self._decision(step, poses, message) if decided else None
        return NextStep(state=self._state, goal=poses[1], path=poses, decision=decision)

    def _message(self, step: Step) -> str:
        if step.choice is not None:
            return f"{step.message}{Action(step.choice.action).text}: {step.choice.reason}"
        if step.location is None:
            return step.message
        x_m, y_m = self._space.candidates.x_m[step.location], self._space.candidates.y_m[step.location]
        p_here = step.sight.probability[step.location]
        found = f"{self._state.target} near ({x_m:.2f}, {y_m:.2f}) m with p {p_here:.3g}"
        if step.phase is SearchPhase.FOUND:
            return found
        p_in_view = self._search.p_in_view(step.sight)
        return f"{found}, {p_in_view:.3g} in view; {len(step.path) - 1} steps to go"

    def _decision(self, step: Step, poses: tuple[Pose2D, ...], reason: str) -> Decision:
        choice, here, goal = step.choice, poses[0], poses[1]
        legal = self._search.graph.legal_actions(step.path[0]) if choice is not None else ()
        return Decision(
            episode=self._state.episode,
            step=self._state.step,
            planner=self._parameters.variant,
            action="dock" if choice is None else Action(choice.action).text,
            actions=tuple(option.text for option in legal),
            values=tuple(float(choice.values[option]) for option in legal) if choice is not None else (),
            visits=tuple(int(choice.visits[option]) for option in legal) if choice is not None else (),
            simulations=choice.simulations if choice is not None else 0,
            elapsed_ms=step.elapsed_ms,
            p_in_view=self._search.p_in_view(step.sight),
            tau=self._search.threshold,
            entropy=step.sight.normalised_entropy(),
            x_m=here.x_m,
            y_m=here.y_m,
            yaw_rad=here.yaw_rad,
            goal_x_m=goal.x_m,
            goal_y_m=goal.y_m,
            goal_yaw_rad=goal.yaw_rad,
            reason=reason,
        )

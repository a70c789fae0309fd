"""The planner node: belief and pose in, the next place to look from out."""

import sys
from dataclasses import replace
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.detector_statistics import read_detector_statistics
from robustnav_msgs_py.pose_history import PoseHistory
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_msgs_py.values import BeliefCloud, OccupancyMap, Odometry, Pose2D, StampedPose
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes
from robustnav_nodes.planner.drive import allowed_time_s, has_arrived, stands
from robustnav_nodes.planner.parameters import PlannerParameters, with_recall
from robustnav_nodes.planner.search_session import NextStep, SearchSession
from robustnav_nodes.search_space.cache import cached_search_space, user_cache_folder
from robustnav_nodes.search_space.floor_inputs import FloorInputs
from robustnav_nodes.search_space.space import SearchSpace


class Doing(StrEnum):
    """What the node is doing for its session."""

    NOTHING = "nothing"
    LOOKING = "looking"  # stands, waits for a belief that has this view in it
    DECIDING = "deciding"
    DRIVING = "driving"


class Planner(GraphNode[PlannerParameters]):
    """Searches for the target: decides where to look next, drives there, looks, until found or given up.

    Hears `map`, `search/candidates`, `odom`, `belief/cloud`, `search/target` (a new one starts a search, an
    empty one stops it). Says `goal_pose`, `plan`, `search/state`, `planner/decision`. Serves `~/start`
    (search for the target again), `~/stop` and `plan/get_plan`.
    """

    executable = "planner"
    declaration = PlannerParameters

    def configure(self) -> None:
        """Open the topics."""
        path = self.parameters.detector_statistics_file
        self._statistics = read_detector_statistics(Path(path)) if path else None
        self._floor = FloorInputs(self.parameters.mask_wait_s)
        self._poses = PoseHistory()
        self._space: SearchSpace | None = None
        self._session: SearchSession | None = None
        self._target = ""  # the latest; `~/start` searches for it again
        self._is_wanted = False  # whether it is still to be found
        self._episode = 0
        self._doing = Doing.NOTHING
        self._since_s = 0.0
        self._look_after_ns = 0
        self._goal: Pose2D | None = None
        self._goal_said_s = 0.0
        self._allowed_s = 0.0
        self._is_blocked = False
        self._cloud: BeliefCloud | None = None
        self._builder = self.worker("search space")
        self._decider = self.worker("decision", failed=self._look_again)
        self._goal_pose = self.publisher("goal_pose")
        self._plan = self.publisher("plan")
        self._state = self.publisher("search/state")
        self._decision = self.publisher("planner/decision")
        self.subscribe("map", wire.map_from_message, self._on_map)
        self.subscribe("search/candidates", wire.map_from_message, self._floor.heard_mask)
        self.subscribe("odom", wire.odometry_from_message, self._on_odometry)
        self.subscribe("belief/cloud", wire.belief_from_message, self._on_cloud)
        self.subscribe("search/target", wire.text_from_message, self._on_target)
        self.serve("~/start", self._on_start)
        self.serve("~/stop", self._on_stop)
        self.serve("plan/get_plan", self._get_plan)
        self.every(self.parameters.floor_check_s, self._build, steady=True)
        self.every(self.parameters.check_period_s, self._check, steady=True)

    def activate(self) -> None:
        """Say that nothing is searched for."""
        self._say_state(SearchState())

    def deactivate(self) -> None:
        """Stop the robot."""
        self._stop("the planner is shut down")

    # The floor.

    def _on_map(self, floor_map: OccupancyMap) -> None:
        self._floor.heard_map(floor_map, self.steady_s())

    def _build(self) -> None:
        here = self._poses.latest
        inputs = None if self._builder.busy or here is None else self._floor.take(self.steady_s())
        if inputs is not None and here is not None:
            folder = user_cache_folder() if self.parameters.search_space_cache else None
            build = partial(cached_search_space, *inputs, self.parameters, here.pose, folder)
            self._builder.submit(build, self._on_space)

    def _on_space(self, space: SearchSpace) -> None:
        before, self._space = self._space, space
        self.health.figure("poses", len(space.graph))
        self.health.figure("candidate locations", len(space.candidates))
        if self._session is not None and before is not None and before.frame_id == space.frame_id:
            self._session.move_to(space)
        elif self._is_wanted:
            self._start()

    # The search.

    def _on_target(self, target: str) -> None:
        target = target.strip()
        if not target:
            self._stop("the person asked to stop")
        elif target != self._target or not self._is_wanted:  # else a dialogue that came back says it again
            self._target, self._is_wanted = target, True
            self._start()

    def _start(self) -> None:
        """Begin a new search as soon as there is a target, a floor and nothing of an old one under way."""
        self._session, self._cloud, self._goal = None, None, None
        if self._space is None or not self._target:
            return
        self._episode += 1
        self._session = SearchSession(
            target=self._target,
            space=self._space,
            parameters=self._parameters_for(self._target),
            rng=np.random.default_rng([self.parameters.seed, self._episode]),
            episode=self._episode,
            clock=self.steady_s,
        )
        self._say_state(self._session.state)
        # the belief about this target begins when the belief node hears of it: leave it the time
        self._look(self.now_ns() + int(self.parameters.settle_s * wire.NANOSECONDS))

    def _parameters_for(self, target: str) -> PlannerParameters:
        """With the recall that the detector has on the target's class, where a file tells it."""
        if self._statistics is None:
            return self.parameters
        return with_recall(self.parameters, self._statistics.of(target).recall)

    def _stop(self, message: str) -> None:
        was_searching = self._session is not None and not self._session.ended
        if self._session is not None and was_searching:
            # the session itself may be thinking in the worker's thread; it is left alone and dropped
            self._say_state(replace(self._session.state, phase=SearchPhase.STOPPED, message=message))
        self._session, self._doing, self._goal, self._is_wanted = None, Doing.NOTHING, None, False
        here = self._poses.latest
        if was_searching and here is not None:
            self._say_goal(here.pose)

    def _look(self, after_ns: int) -> None:
        self._doing, self._since_s, self._look_after_ns = Doing.LOOKING, self._now_s(), after_ns

    def _look_again(self) -> None:
        """A decision failed (its reason is in /diagnostics): try once more with a newer view."""
        if self._doing is Doing.DECIDING:
            self._look(self.now_ns())

    def _on_odometry(self, odometry: Odometry) -> None:
        if self._poses.add(odometry):
            self._cloud = None  # simulated time began anew: the robot is somewhere else
            if self._doing in (Doing.LOOKING, Doing.DRIVING):
                self._look(odometry.stamp_ns)
        driving_to = self._goal if self._doing is Doing.DRIVING else None
        if driving_to is not None and has_arrived(odometry, driving_to, self.parameters):
            self._look(odometry.stamp_ns)
        self._decide()

    def _on_cloud(self, cloud: BeliefCloud) -> None:
        self._cloud = cloud
        self._decide()

    def _decide(self) -> None:
        here, cloud = self._poses.latest, self._cloud
        if self._doing is not Doing.LOOKING or self._session is None or here is None or cloud is None:
            return
        if cloud.stamp_ns < self._look_after_ns or self._decider.busy or not stands(here, self.parameters):
            return
        self._doing = Doing.DECIDING
        session = self._session
        step = session.blocked if self._is_blocked else session.observe
        self._is_blocked = False
        self._decider.submit(partial(step, here.pose, cloud), partial(self._on_step, session))

    def _on_step(self, session: SearchSession, step: NextStep) -> None:
        if session is not self._session:
            return  # stopped or begun anew while it was thinking
        self._say_state(step.state)
        if step.decision is not None:
            self._decision.publish(wire.record_to_message(step.decision, summary=step.decision.reason))
            self.health.figure("last decision took ms", step.decision.elapsed_ms)
        self._plan.publish(wire.path_to_message(step.path, self.now_ns(), self._frame_id()))
        here = self._poses.latest
        if step.goal is None or here is None:
            self._doing, self._goal, self._is_wanted = Doing.NOTHING, None, False
            return
        self._doing, self._since_s, self._goal = Doing.DRIVING, self._now_s(), step.goal
        self._allowed_s = allowed_time_s(here.pose, step.goal, self.parameters)
        self._say_goal(step.goal)

    def _check(self) -> None:
        """What only time brings: a goal that was not heard, a blocked way, a belief that is silent."""
        self.health.figure("doing", self._doing)
        waited_s = self._now_s() - self._since_s
        if self._doing is Doing.DRIVING and self._goal is not None:
            if waited_s > self._allowed_s:
                self.health.problem(
                    "goal_pose", f"the robot did not arrive in {self._allowed_s:.1f} s; going round"
                )
                self._is_blocked = True
                here = self._poses.latest
                if here is not None:
                    self._say_goal(here.pose)
                    self._look(here.stamp_ns)
            elif self._now_s() - self._goal_said_s > self.parameters.goal_repeat_s:
                self._say_goal(self._goal)
        elif self._doing is Doing.LOOKING and waited_s > self.parameters.look_timeout_s:
            self.health.problem(
                "belief/cloud",
                f"no belief with the present view in {waited_s:.0f} s; do belief and detection run?",
            )

    def _now_s(self) -> float:
        """ROS time: while the simulation is paused, nothing is late."""
        return self.now_ns() / wire.NANOSECONDS

    def _frame_id(self) -> str:
        return "map" if self._space is None else self._space.frame_id

    # Words.

    def _say_goal(self, goal: Pose2D) -> None:
        self._goal_said_s = self._now_s()
        stamped = StampedPose(pose=goal, stamp_ns=self.now_ns(), frame_id=self._frame_id())
        self._goal_pose.publish(wire.pose_to_message(stamped))

    def _say_state(self, state: SearchState) -> None:
        self._state.publish(wire.record_to_message(state, summary=state.message))
        self.health.figure("search", state.phase)

    def _on_start(self, _request: Any, response: Any) -> Any:
        self._is_wanted = bool(self._target)
        self._start()
        response.success = self._session is not None
        response.message = "" if response.success else "there is no target or no map yet"
        return response

    def _on_stop(self, _request: Any, response: Any) -> Any:
        self._stop("stopped by a service call")
        response.success = True
        return response

    def _get_plan(self, request: Any, response: Any) -> Any:
        if self._space is None:
            self.health.problem("plan/get_plan", "there is no map yet; the plan is empty")
            return response
        graph = self._space.graph
        begins, ends = (wire.pose_from_message(pose).pose for pose in (request.start, request.goal))
        path = graph.shortest_path(graph.nearest(begins), graph.nearest(ends)) or ()
        poses = [graph.pose(pose) for pose in path]
        response.plan = wire.path_to_message(poses, self.now_ns(), self._frame_id())
        return response


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Planner])


if __name__ == "__main__":
    sys.exit(main())

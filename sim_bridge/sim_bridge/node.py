"""The simulator as a node: to the rest of the graph it is a robot in a home.

| hears | |
|---|---|
| `cmd_vel` | drives; the robot brakes when it stops coming; ends a goal |
| `goal_pose` | drives there around furniture, or refuses with a sentence in /diagnostics |
| `action` | `forward`, `left 30`, ...: one exact step after the other |
| `initialpose` | puts the robot there |
| `sim/fault` | lets something go wrong: `silent camera 5`, `block kitchen / hallway`, `clear` |

| says | |
|---|---|
| `/clock` | every step; the node itself runs on wall time |
| `odom`, `scan` | at their rates |
| `/tf`, `/tf_static` | with odometry, where tf2_msgs is installed |
| `bumper` | when it is pressed or released, latched |
| `camera/image_raw`, `camera/depth/image_raw` | at the camera's rate while somebody listens |
| `camera/camera_info` | at the camera's rate, with the images' stamps |
| `truth/visible` | at the camera's rate, with the images' stamps, while somebody listens |
| `map`, `search/candidates` | once, latched |
| `truth/objects`, `truth/labels`, `truth/episode` | once, latched; the first again when one is moved |

Services: `~/reset` (robot and objects where they began, nothing goes wrong any more; time goes on),
`~/pause`, `~/step` (`lockstep_periods` steps while paused).
"""

import dataclasses
from typing import TYPE_CHECKING, Any

from robustnav_msgs_py.conversions import (
    camera_to_message,
    camera_transform,
    clock_to_message,
    color_to_message,
    depth_to_message,
    flag_to_message,
    labels_to_message,
    map_to_message,
    objects_to_message,
    odometry_to_message,
    planar_transform,
    pose_from_message,
    record_to_message,
    scan_to_message,
    text_from_message,
    tf_available,
    tf_message,
    velocity_from_message,
    visible_to_message,
)
from robustnav_msgs_py.conversions.transforms import BASE_FRAME
from robustnav_msgs_py.errors import BadMessageError, BadSceneError
from robustnav_msgs_py.values import Pose2D, StampedPose, Velocity
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes
from sim_bridge.homes.floor_plan import candidate_mask, floor_plan
from sim_bridge.pace import MOST_BEHIND_S, SHORTEST_TIMER_S, TURN_S, Pace
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.planar import ORIGIN, composed
from sim_bridge.sensors.camera_driver import Wanted
from sim_bridge.sensors.scan import LASER_FRAME, LASER_HEIGHT_M

if TYPE_CHECKING:
    from sim_bridge.sensors.camera_driver import Shot
    from sim_bridge.simulation import Due, Simulation

MAP_FRAME, ODOM_FRAME = "map", "odom"


class SimBridge(GraphNode[SimParameters]):
    """The simulator's node. The executor's thread owns the simulation."""

    executable = "sim_bridge"
    declaration = SimParameters

    _simulation: "Simulation | None" = None

    def configure(self) -> None:
        """Build the home and everything that publishes it."""
        try:
            from sim_bridge.simulation import Simulation
        except ImportError as error:
            raise BadSceneError(
                f"the simulator needs PyBullet ({error}): pip install 'robustnav[sim]'"
            ) from error
        parameters = self.parameters
        self._simulation = simulation = Simulation(parameters)
        self._paused = False
        self._told_problem = ""
        self._pace = Pace(simulation.period_s, MOST_BEHIND_S)

        self._clock_out = self.publisher("/clock")
        self._odom_out = self.publisher("odom")
        self._scan_out = self.publisher("scan")
        self._color_out = self.publisher("camera/image_raw")
        self._depth_out = self.publisher("camera/depth/image_raw")
        self._camera_out = self.publisher("camera/camera_info")
        self._visible_out = self.publisher("truth/visible")
        self._bumper_out = self.publisher("bumper")
        self._tf_out = self.publisher("/tf") if tf_available() else None
        self._tf_static_out = self.publisher("/tf_static") if tf_available() else None
        self._map_out = self.publisher("map")
        self._candidates_out = self.publisher("search/candidates")
        self._objects_out = self.publisher("truth/objects")
        self._labels_out = self.publisher("truth/labels")
        self._episode_out = self.publisher("truth/episode")

        self.subscribe("cmd_vel", velocity_from_message, self._command)
        self.subscribe("goal_pose", pose_from_message, self._go_to)
        self.subscribe("action", text_from_message, simulation.act)
        self.subscribe("initialpose", pose_from_message, self._place)
        self.subscribe("sim/fault", text_from_message, self._fail)
        self.serve("~/reset", self._reset)
        self.serve("~/pause", self._pause)
        self.serve("~/step", self._step_once)
        period_s = simulation.period_s / parameters.real_time_factor
        self.every(max(period_s, SHORTEST_TIMER_S), self._run, steady=True)

    def activate(self) -> None:
        """Publish what does not change, and let time begin."""
        home, now_ns = self._running.home, self._running.now_ns
        self._clock_out.publish(clock_to_message(now_ns))
        self._map_out.publish(map_to_message(floor_plan(home, now_ns)))
        self._candidates_out.publish(map_to_message(candidate_mask(home, now_ns)))
        self._say_objects()
        self._bumper_out.publish(flag_to_message(self._running.bumper.pressed))
        if self._tf_static_out is not None:
            laser = planar_transform(BASE_FRAME, LASER_FRAME, ORIGIN, now_ns, z_m=LASER_HEIGHT_M)
            self._tf_static_out.publish(tf_message([camera_transform(self._running.mount, now_ns), laser]))
        self._labels_out.publish(labels_to_message(home.labels))
        self._episode_out.publish(record_to_message(self._running.episode(), summary=home.name))
        self._pace.restart()

    def deactivate(self) -> None:
        """Forget command and goal; time stands while the node is inactive."""
        self._running.stop()

    def cleanup(self) -> None:
        """Close the world."""
        if self._simulation is not None:
            self._simulation.close()
            self._simulation = None

    def parameters_changed(self) -> None:
        """The pace changes at once, everything else with the next configure."""
        if self._simulation is None:
            return
        used = dataclasses.replace(
            self._simulation.parameters, real_time_factor=self.parameters.real_time_factor
        )
        if used != self.parameters:
            self.health.problem(
                "parameters", "all but real_time_factor take effect when the node is configured again"
            )

    @property
    def _running(self) -> "Simulation":
        if self._simulation is None:
            raise BadSceneError("there is no home yet: configure the node first")
        return self._simulation

    def _command(self, velocity: Velocity) -> None:
        self._running.command(velocity)

    def _go_to(self, goal: StampedPose) -> None:
        self._running.go_to(self._in_map(goal))

    def _place(self, pose: StampedPose) -> None:
        self._running.place(self._in_map(pose))

    def _fail(self, line: str) -> None:
        if self._running.fail(line):
            self._say_objects()

    def _say_objects(self) -> None:
        home = self._running.home
        objects = [item.as_truth() for item in home.objects]
        self._objects_out.publish(objects_to_message(objects, self._running.now_ns))

    def _reset(self, _request: Any, response: Any) -> Any:
        if self._running.reset():
            self._say_objects()
        response.success, response.message = True, "the robot stands at its start"
        return response

    def _pause(self, request: Any, response: Any) -> Any:
        self._paused = bool(request.data)
        self._pace.restart()
        response.success, response.message = True, "time stands" if self._paused else "time goes on"
        return response

    def _step_once(self, _request: Any, response: Any) -> Any:
        if not self._paused:
            response.success, response.message = (
                False,
                "time is not paused: call ~/pause with data: true first",
            )
            return response
        for _ in range(self.parameters.lockstep_periods):
            self._step()
        response.success, response.message = True, f"it is {self._running.now_ns} ns"
        return response

    def _run(self) -> None:
        """Make the steps that wall time asks for, as many as fit into one turn."""
        if self._paused:
            return
        began_s = self.steady_s()
        for _ in range(self._pace.due(began_s, self.parameters.real_time_factor)):
            self._step()
            self._pace.done()
            if self.steady_s() - began_s > TURN_S:
                break

    def _step(self) -> None:
        due = self._running.step()
        self._clock_out.publish(clock_to_message(self._running.now_ns))
        self._publish(due)
        problem = self._running.problem
        if problem and problem != self._told_problem:
            self.health.problem("motion", problem)
        self._told_problem = problem

    def _publish(self, due: "Due") -> None:
        simulation = self._running
        if due.odom:
            self._odom_out.publish(odometry_to_message(simulation.odometry()))
            if self._tf_out is not None:
                self._tf_out.publish(self._frames())
        if due.bumper:
            self._bumper_out.publish(flag_to_message(simulation.bumper.pressed))
        if due.scan and self._scan_out.get_subscription_count():
            self._scan_out.publish(scan_to_message(simulation.laser_scan()))
        if due.camera:
            simulation.shoot(
                Wanted(
                    color=self._color_out.get_subscription_count() > 0,
                    depth=self._depth_out.get_subscription_count() > 0,
                    visible=self._visible_out.get_subscription_count() > 0,
                )
            )
        for shot in simulation.shots():
            self._publish_shot(shot)

    def _publish_shot(self, shot: "Shot") -> None:
        self._camera_out.publish(camera_to_message(shot.model))
        if shot.visible is not None:
            self._visible_out.publish(visible_to_message(shot.visible))
        if shot.color is not None:
            self._color_out.publish(color_to_message(shot.color))
            self.health.count("images rendered")
        if shot.depth is not None:
            self._depth_out.publish(depth_to_message(shot.depth))

    def _frames(self) -> Any:
        simulation, now_ns = self._running, self._running.now_ns
        return tf_message(
            [
                planar_transform("map", "odom", simulation.map_from_odom(), now_ns),
                planar_transform("odom", BASE_FRAME, simulation.odom_from_base(), now_ns),
            ]
        )

    def _in_map(self, stamped: StampedPose) -> Pose2D:
        """The pose in `map`; refused in frames that the simulator does not know."""
        if stamped.frame_id == MAP_FRAME:
            return stamped.pose
        if stamped.frame_id == ODOM_FRAME:
            return composed(self._running.map_from_odom(), stamped.pose)
        raise BadMessageError(
            f"a pose is in frame {stamped.frame_id!r}; the simulator knows {MAP_FRAME} and {ODOM_FRAME}"
        )


def main() -> int:
    """Run the simulator until it is told to stop."""
    return run_nodes([SimBridge])

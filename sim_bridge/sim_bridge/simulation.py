"""The whole simulator without ROS: a home, a robot in it, its sensors, and time that goes in steps."""

from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

import numpy as np

from robustnav_msgs_py.conversions.transforms import BASE_FRAME
from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.records import Episode
from robustnav_msgs_py.values import LaserScan, Odometry, Pose2D, Velocity
from sim_bridge.faults import Clear, Faults, HomeNames, Move, Sensor, parse_fault
from sim_bridge.homes.build import build_home
from sim_bridge.homes.furniture.catalogue import default_style
from sim_bridge.homes.generator import generate_home
from sim_bridge.homes.home import Home
from sim_bridge.homes.objects.catalogue import default_look
from sim_bridge.homes.occluders.placing import place_occluders
from sim_bridge.homes.rooms.room_programmes import Difficulty
from sim_bridge.homes.scene_files.scene_file import read_scene
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.actions import ActionRunner, parse_action
from sim_bridge.robot.bumper import Bumper
from sim_bridge.robot.drive import STANDSTILL, Drive, DriveLimits
from sim_bridge.robot.goal_follower import GoalFollower
from sim_bridge.robot.odometry import OdometryDrift, WheelOdometry
from sim_bridge.robot.planar import ORIGIN, composed, inverse
from sim_bridge.robot.route import RoutePlanner
from sim_bridge.sensors.camera import Camera, camera_model
from sim_bridge.sensors.camera_driver import CameraDriver, Shot, Wanted
from sim_bridge.sensors.degraded_camera import DegradedCamera
from sim_bridge.sensors.frame_delay import FrameDelay, FrameDropper
from sim_bridge.sensors.scan import Laser
from sim_bridge.sensors.visibility import Observer
from sim_bridge.stage import Stage

NS_PER_S = 1_000_000_000
# ROS takes time 0 for "no time yet".
START_NS = NS_PER_S
MAP_FRAME, ODOM_FRAME = "map", "odom"
# What chance decides apart from the home, each from a stream of its own.
OCCLUDER_STREAM, DRIFT_STREAM, MOVE_STREAM = 101, 102, 103


@dataclass(frozen=True, slots=True, kw_only=True)
class Due:
    """Which sensors are to be read after a step, and whether the bumper was pressed or released."""

    odom: bool
    scan: bool
    camera: bool
    bumper: bool


class Simulation:
    """One home and one robot, deterministic: the same seed, commands and steps give the same run.

    One thread steps it and reads the sensors. Close it when done.
    """

    def __init__(self, parameters: SimParameters) -> None:
        """Read or generate the home, and build it (some 0.3 s).

        Raises BadSceneError where the seed gives none, and what `read_scene` raises.
        """
        self.parameters = parameters
        self.mount = CameraMount()
        home = _home(parameters)
        moved_in = place_occluders(_stream(parameters, OCCLUDER_STREAM), home, parameters.occluders)
        self.stage = Stage(home, moved_in)
        self._start = home.start
        limits = DriveLimits(
            speed_m_s=parameters.max_speed_m_s,
            turn_rad_s=parameters.max_turn_rad_s,
            acceleration_m_s2=parameters.acceleration_m_s2,
            turn_acceleration_rad_s2=parameters.turn_acceleration_rad_s2,
            braking=parameters.braking,
        )
        self.drive = Drive(
            self.stage.obstacles, limits, parameters.robot_radius_m, parameters.stop_distance_m
        )
        self.drive.place(home.start)
        self.follower = GoalFollower(self.drive, self._planner())
        self.actions = ActionRunner(self.drive)
        self.faults = Faults()
        self.bumper = Bumper()
        drift = OdometryDrift(
            share_per_m=parameters.drift_share_per_m,
            rad_per_m=parameters.drift_rad_per_m,
            rad_per_rad=parameters.drift_rad_per_rad,
        )
        self._drifts = drift != OdometryDrift()
        self._wheels = WheelOdometry(drift, _stream(parameters, DRIFT_STREAM), home.start)
        model = camera_model(parameters.camera_width, parameters.camera_height, parameters.camera_view_rad)
        range_m = parameters.camera_range_m
        self._camera = Camera(self.stage.scenery, model, self.mount, range_m)
        self._observer = Observer(self.stage.world, home, model, self.mount, range_m)
        self._driver = CameraDriver(
            DegradedCamera(self._camera, parameters, parameters.seed),
            self._observer,
            FrameDropper(parameters.frame_drop, parameters.seed),
            FrameDelay[Shot](parameters.frame_delay_s, parameters.frame_jitter_s, parameters.seed),
        )
        self._laser = Laser(self.stage.scenery, parameters.scan_rays, parameters.scan_range_m)
        self._move_rng = _stream(parameters, MOVE_STREAM)
        self._steps = 0
        self._command = STANDSTILL
        self._command_step = 0

    def close(self) -> None:
        """Give PyBullet's world back; a second call does nothing."""
        self.stage.close()

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def home(self) -> Home:
        """The home as the map knows it, its objects where they are now."""
        return self.stage.home

    @property
    def now_ns(self) -> int:
        """Simulated time; it starts at 1 s and only ever grows."""
        return START_NS + round(self._steps * NS_PER_S / self.parameters.control_hz)

    @property
    def period_s(self) -> float:
        """Simulated time of one step."""
        return 1.0 / self.parameters.control_hz

    @property
    def problem(self) -> str:
        """Why the last goal or action was given up, "" where none was."""
        return self.follower.problem or self.actions.problem

    # What the robot is told.

    def command(self, velocity: Velocity) -> None:
        """Drive with `velocity`, clamped to the limits, until the watchdog ends it; ends goal and actions."""
        self.stop()
        self._command = velocity
        self._command_step = self._steps

    def go_to(self, goal: Pose2D) -> None:
        """Drive to a pose in `map`. Raises GoalRefusedError, and changes nothing, where that cannot be."""
        self.follower.accept(goal)
        self.actions.cancel()
        self._command = STANDSTILL

    def act(self, line: str) -> None:
        """Carry out one discrete action, after those that wait.

        Raises BadMessageError or ActionRefusedError, and changes nothing, where it cannot be.
        """
        action = parse_action(line, self.parameters.action_step_m, self.parameters.action_turn_rad)
        self.actions.accept(action)
        self.follower.cancel()
        self._command = STANDSTILL

    def stop(self) -> None:
        """Forget command, goal and actions, and brake."""
        self.follower.cancel()
        self.actions.cancel()
        self._command = STANDSTILL

    def place(self, pose: Pose2D) -> None:
        """Put the robot somewhere else, standing. Raises BadMessageError where it does not fit."""
        self.drive.place(pose)
        self.stop()

    def reset(self) -> bool:
        """Put the robot back to its start, standing, with nothing going wrong; time goes on.

        Whether objects are elsewhere now: those that were moved are put back.
        """
        self.faults.clear()
        self._close_doors()
        self._driver.reset()
        self.place(self._start)
        put_back = self.stage.put_back()
        if put_back:
            self._observer.look_at(self.home)
        return put_back

    def fail(self, line: str) -> bool:
        """Let something go wrong (`faults`); whether objects are elsewhere now.

        Raises BadMessageError, and changes nothing, where the line asks for nothing that can be.
        """
        home = self.home
        names = HomeNames(
            doors=tuple(door.rooms for door in home.doors),
            objects=tuple(thing.instance for thing in home.objects),
            furniture=tuple(piece.name for piece in home.furniture if piece.carries),
        )
        fault = parse_fault(line, names)
        if isinstance(fault, Move):
            self.stage.move(self._move_rng, fault.instance, fault.furniture)
            self._observer.look_at(self.home)
            return True
        if isinstance(fault, Clear):
            self.faults.clear()
        else:
            self.faults.start(fault, self.now_ns)
        self._close_doors()
        return False

    # Time.

    def step(self) -> Due:
        """Let one period pass, and tell which sensors are due."""
        self._close_doors()
        before = self.drive.pose
        if self.follower.busy:
            wanted = self.follower.wanted(self.period_s)
        elif self.actions.busy:
            wanted = self.actions.wanted(self.period_s)
        else:
            age_s = (self._steps - self._command_step) * self.period_s
            wanted = self._command if age_s < self.parameters.watchdog_s else STANDSTILL
        self.drive.step(wanted, self.period_s, self.faults.slip(self.now_ns))
        self._wheels.update(before, self.drive.pose, self.drive.velocity, self.period_s)
        pressed = self.bumper.update(self.drive.blocked, self.period_s)
        self._steps += 1
        return Due(
            odom=self._is_due(self.parameters.odom_hz) and not self._is_silent(Sensor.ODOM),
            scan=self._is_due(self.parameters.scan_hz) and not self._is_silent(Sensor.SCAN),
            camera=self._is_due(self.parameters.camera_hz),
            bumper=pressed,
        )

    # What the robot senses.

    def odometry(self) -> Odometry:
        """Pose in `odom`; without drift that is the pose in `map`, and said to be."""
        twist = self._wheels.twist if self._drifts else self.drive.velocity
        return Odometry(
            pose=self._pose_in_odom() if self._drifts else self.drive.pose,
            linear_m_s=twist.linear_m_s,
            angular_rad_s=twist.angular_rad_s,
            stamp_ns=self.now_ns,
            frame_id=ODOM_FRAME if self._drifts else MAP_FRAME,
            child_frame_id=BASE_FRAME,
        )

    def odom_from_base(self) -> Pose2D:
        """Where the wheels take the robot to be; frame `odom` lies on `map` as the run begins."""
        return self._pose_in_odom() if self._drifts else self.drive.pose

    def map_from_odom(self) -> Pose2D:
        """The correction that a localiser would publish; none without drift."""
        if not self._drifts:
            return ORIGIN
        return composed(self.drive.pose, inverse(self.odom_from_base()))

    def laser_scan(self) -> LaserScan:
        """The laser scan now."""
        return self._laser.take(self.drive.pose, self.now_ns)

    def shoot(self, wanted: Wanted) -> None:
        """Open the shutter; the picture comes with `shots`, at once unless pictures are late."""
        number = int(self._steps * self.parameters.camera_hz / self.parameters.control_hz + 1e-9)
        self._driver.shoot(
            number,
            self.drive.pose,
            self.drive.velocity,
            self.now_ns,
            wanted,
            frozen=self.faults.is_frozen(Sensor.CAMERA, self.now_ns),
        )

    def shots(self) -> list[Shot]:
        """The pictures that have arrived since the last call; a silent sensor's part is missing."""
        arrived = self._driver.arrived(self.now_ns)
        silent = {sensor for sensor in (Sensor.CAMERA, Sensor.DEPTH) if self._is_silent(sensor)}
        return [shot.without(color=Sensor.CAMERA in silent, depth=Sensor.DEPTH in silent) for shot in arrived]

    def episode(self) -> Episode:
        """What decided this run."""
        return Episode(
            seed=self.parameters.seed,
            home=self.home.name,
            rooms=tuple(room.name for room in self.home.rooms),
            start_x_m=self._start.x_m,
            start_y_m=self._start.y_m,
            start_yaw_rad=self._start.yaw_rad,
        )

    def _pose_in_odom(self) -> Pose2D:
        return composed(self._start, self._wheels.pose)

    def _planner(self) -> RoutePlanner:
        return RoutePlanner(self.stage.obstacles, self.stage.grid, self.drive.keep_m)

    def _close_doors(self) -> None:
        """Let the doors be as the faults want them; one where the robot stands waits for it to leave."""
        pairs = self.faults.blocked_doors(self.now_ns)
        closed = self.stage.closed
        doors = tuple(
            door
            for door in self.home.doors
            if door.rooms in pairs and (door in closed or not self.drive.is_in_the_way_of(door.opening))
        )
        if doors == closed:
            return
        self.stage.close_doors(doors)
        self.drive.replace_obstacles(self.stage.obstacles)
        self.follower.replan(self._planner())
        self._camera.scenery = self.stage.scenery
        self._laser.scenery = self.stage.scenery

    def _is_silent(self, sensor: Sensor) -> bool:
        return self.faults.is_silent(sensor, self.now_ns)

    def _is_due(self, rate_hz: float) -> bool:
        """Whether the last step crossed a multiple of the sensor's period."""
        ratio = min(1.0, rate_hz / self.parameters.control_hz)
        return int(self._steps * ratio + 1e-9) > int((self._steps - 1) * ratio + 1e-9)


def _home(parameters: SimParameters) -> Home:
    if parameters.scene:
        scene = read_scene(
            Path(parameters.scene).expanduser(), default_style=default_style, default_look=default_look
        )
        return build_home(scene)
    return generate_home(
        parameters.seed,
        difficulty=Difficulty(parameters.difficulty),
        rooms=parameters.rooms or None,
        objects=parameters.objects or None,
        look_alikes=parameters.look_alikes,
    )


def _stream(parameters: SimParameters, number: int) -> np.random.Generator:
    return np.random.default_rng([parameters.seed, number])

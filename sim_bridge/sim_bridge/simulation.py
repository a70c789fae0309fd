"""The whole simulator without ROS: a home, a robot in it, its sensors, and time that goes in steps."""

from dataclasses import dataclass, replace
from types import TracebackType

from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.records import Episode
from robustnav_msgs_py.values import CameraModel, LaserScan, Odometry, Pose2D, Velocity, VisibleObjects
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.generator import generate_home
from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.drive import STANDSTILL, Drive, DriveLimits
from sim_bridge.robot.goal_follower import GoalFollower
from sim_bridge.robot.route import RoutePlanner
from sim_bridge.sensors.camera import Camera, CameraFrame, camera_model
from sim_bridge.sensors.scan import Laser
from sim_bridge.sensors.visibility import Observer
from sim_bridge.sensors.world import World

NS_PER_S = 1_000_000_000
# ROS takes time 0 for "no time yet".
START_NS = NS_PER_S
ODOM_FRAME = "map"  # nothing drifts here, so odometry is the pose in the map
BASE_FRAME = "base_link"


@dataclass(frozen=True, slots=True, kw_only=True)
class Due:
    """Which sensors are to be read after a step."""

    odom: bool
    scan: bool
    camera: bool


class Simulation:
    """One home and one robot, deterministic: the same seed, commands and steps give the same run.

    One thread steps it and reads the sensors. Close it when done.
    """

    def __init__(self, parameters: SimParameters) -> None:
        """Generate and build the home (some 0.3 s). Raises BadSceneError where the seed gives none."""
        self.parameters = parameters
        self.mount = CameraMount()
        self.home: Home = generate_home(
            parameters.seed, rooms=parameters.rooms or None, objects=parameters.objects or None
        )
        rects = self.home.obstacles()
        obstacles = Obstacles(rects, self.home.bounds)
        limits = DriveLimits(
            speed_m_s=parameters.max_speed_m_s,
            turn_rad_s=parameters.max_turn_rad_s,
            acceleration_m_s2=parameters.acceleration_m_s2,
            turn_acceleration_rad_s2=parameters.turn_acceleration_rad_s2,
            braking=parameters.braking,
        )
        self.drive = Drive(obstacles, limits, parameters.robot_radius_m, parameters.stop_distance_m)
        grid = ClearanceGrid(self.home.bounds, RESOLUTION_M).with_rects(rects)
        self.follower = GoalFollower(self.drive, RoutePlanner(obstacles, grid, self.drive.keep_m))
        model = camera_model(parameters.camera_width, parameters.camera_height, parameters.camera_view_rad)
        self._world = World(self.home)
        self._camera = Camera(self._world, model, self.mount, parameters.camera_range_m)
        self._observer = Observer(self._world, self.home, model, self.mount, parameters.camera_range_m)
        self._laser = Laser(self._world, parameters.scan_rays, parameters.scan_range_m)
        self._steps = 0
        self._command = STANDSTILL
        self._command_step = 0
        self.drive.place(self.home.start)

    def close(self) -> None:
        """Give PyBullet's world back; a second call does nothing."""
        self._world.close()

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def now_ns(self) -> int:
        """Simulated time; it starts at 1 s and only ever grows."""
        return START_NS + round(self._steps * NS_PER_S / self.parameters.control_hz)

    @property
    def period_s(self) -> float:
        """Simulated time of one step."""
        return 1.0 / self.parameters.control_hz

    def command(self, velocity: Velocity) -> None:
        """Drive with `velocity`, clamped to the limits, until the watchdog ends it; ends a goal."""
        self.follower.cancel()
        self._command = velocity
        self._command_step = self._steps

    def go_to(self, goal: Pose2D) -> None:
        """Drive to a pose in `map`. Raises GoalRefusedError, and changes nothing, where that cannot be."""
        self.follower.accept(goal)
        self._command = STANDSTILL

    def stop(self) -> None:
        """Forget command and goal, and brake."""
        self.follower.cancel()
        self._command = STANDSTILL

    def place(self, pose: Pose2D) -> None:
        """Put the robot somewhere else, standing. Raises BadMessageError where it does not fit."""
        self.drive.place(pose)
        self.stop()

    def reset(self) -> None:
        """Put the robot back to its start, standing; time goes on."""
        self.place(self.home.start)

    def step(self) -> Due:
        """Let one period pass, and tell which sensors are due."""
        if self.follower.goal is not None:
            wanted = self.follower.wanted(self.period_s)
        else:
            age_s = (self._steps - self._command_step) * self.period_s
            wanted = self._command if age_s < self.parameters.watchdog_s else STANDSTILL
        self.drive.step(wanted, self.period_s)
        self._steps += 1
        return Due(
            odom=self._is_due(self.parameters.odom_hz),
            scan=self._is_due(self.parameters.scan_hz),
            camera=self._is_due(self.parameters.camera_hz),
        )

    def odometry(self) -> Odometry:
        """Pose in `odom`, which is `map`: this odometry does not drift."""
        return Odometry(
            pose=self.drive.pose,
            linear_m_s=self.drive.velocity.linear_m_s,
            angular_rad_s=self.drive.velocity.angular_rad_s,
            stamp_ns=self.now_ns,
            frame_id=ODOM_FRAME,
            child_frame_id=BASE_FRAME,
        )

    def laser_scan(self) -> LaserScan:
        """The laser scan now."""
        return self._laser.take(self.drive.pose, self.now_ns)

    def camera_model(self) -> CameraModel:
        """The camera's model, stamped now."""
        return replace(self._camera.model, stamp_ns=self.now_ns)

    def camera_frame(self) -> CameraFrame:
        """The camera's picture now: the costly one of the sensors."""
        return self._camera.take(self.drive.pose, self.now_ns)

    def visible_objects(self) -> VisibleObjects:
        """What the camera's picture shows now, without rendering it."""
        return self._observer.look(self.drive.pose, self.now_ns)

    def episode(self) -> Episode:
        """What decided this run."""
        start = self.home.start
        return Episode(
            seed=self.home.seed,
            home=self.home.name,
            rooms=tuple(room.name for room in self.home.rooms),
            start_x_m=start.x_m,
            start_y_m=start.y_m,
            start_yaw_rad=start.yaw_rad,
        )

    def _is_due(self, rate_hz: float) -> bool:
        """Whether the last step crossed a multiple of the sensor's period."""
        ratio = min(1.0, rate_hz / self.parameters.control_hz)
        return int(self._steps * ratio + 1e-9) > int((self._steps - 1) * ratio + 1e-9)

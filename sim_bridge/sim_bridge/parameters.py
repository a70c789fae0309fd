"""The simulator's parameters."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter
from sim_bridge.sensors.degradations import ImageDegradation


@dataclass(frozen=True, slots=True, kw_only=True)
class SimParameters(ImageDegradation):
    """Home, robot and sensors of the simulator; the defaults are a small indoor robot in real time.

    What is wrong with the camera comes from ImageDegradation: by default nothing.
    """

    scene: str = parameter("", "scene file (YAML) of the home; empty: the seed decides")
    seed: int = parameter(1, "decides the home and where the robot starts", low=0, high=2**31 - 1)
    difficulty: str = parameter(
        "medium", "rooms of the home: 1, 3 to 4, 6 to 10", choices=("easy", "medium", "hard")
    )
    rooms: int = parameter(0, "rooms of the home, 1 to 10; 0: as difficult", low=0, high=10)
    objects: int = parameter(0, "objects in the home, 4 to 80; 0: the seed decides", low=0, high=80)
    look_alikes: str = parameter("", "a class of which there are several, hard to tell apart")
    occluders: int = parameter(0, "things moved in that no map knows", low=0, high=20)

    real_time_factor: float = parameter(
        1.0, "simulated seconds per second, as far as the machine keeps up", low=0.05, high=100.0
    )
    control_hz: float = parameter(50.0, "steps and /clock", unit="Hz", low=50.0, high=500.0)
    lockstep_periods: int = parameter(1, "steps that one call of ~/step makes", low=1, high=10_000)
    odom_hz: float = parameter(20.0, "odometry", unit="Hz", low=1.0, high=500.0)
    scan_hz: float = parameter(10.0, "laser scans", unit="Hz", low=0.1, high=100.0)
    camera_hz: float = parameter(5.0, "images, and truth/visible", unit="Hz", low=0.1, high=60.0)

    max_speed_m_s: float = parameter(0.5, "highest speed", unit="m/s", low=0.05, high=2.0)
    max_turn_rad_s: float = parameter(1.2, "highest turning speed", unit="rad/s", low=0.1, high=6.0)
    acceleration_m_s2: float = parameter(1.0, "acceleration", unit="m/s2", low=0.1, high=10.0)
    turn_acceleration_rad_s2: float = parameter(
        4.0, "turning acceleration", unit="rad/s2", low=0.2, high=40.0
    )
    braking: float = parameter(2.5, "braking over acceleration, driving and turning", low=1.0, high=10.0)
    watchdog_s: float = parameter(
        0.5, "the robot brakes when cmd_vel is older than this", unit="s", low=0.05, high=10.0
    )
    stop_distance_m: float = parameter(
        0.01, "the robot does not get nearer to anything than this", unit="m", low=0.0, high=0.2
    )
    # With the stop distance less than what planners keep (0.18 m, on a map of 0.05 m cells): none of
    # their goals is refused for the sake of a centimetre.
    robot_radius_m: float = parameter(0.15, "radius of the round footprint", unit="m", low=0.1, high=0.3)
    action_step_m: float = parameter(
        0.25, "what `forward` alone means on the topic action", unit="m", low=0.01, high=5.0
    )
    action_turn_rad: float = parameter(
        math.radians(15.0), "what `left` alone means there", unit="rad", low=0.01, high=math.pi
    )
    drift_share_per_m: float = parameter(
        0.0, "std of odometry's distance after 1 m, as a share of it", low=0.0, high=0.5
    )
    drift_rad_per_m: float = parameter(
        0.0, "std of odometry's heading after 1 m", unit="rad", low=0.0, high=0.5
    )
    drift_rad_per_rad: float = parameter(
        0.0, "std of odometry's heading after 1 rad turned", unit="rad", low=0.0, high=0.5
    )

    camera_width: int = parameter(320, "image width", unit="px", low=32, high=1920)
    camera_height: int = parameter(240, "image height", unit="px", low=24, high=1080)
    camera_view_rad: float = parameter(
        math.pi / 3.0, "horizontal angle of view", unit="rad", low=0.2, high=2.6
    )
    camera_range_m: float = parameter(10.0, "depth and ground truth end here", unit="m", low=0.5, high=25.0)
    frame_drop: float = parameter(0.0, "share of the images that get lost", low=0.0, high=1.0)
    frame_delay_s: float = parameter(0.0, "images come this late", unit="s", low=0.0, high=2.0)
    frame_jitter_s: float = parameter(
        0.0, "and up to this much later, some more, some less", unit="s", low=0.0, high=2.0
    )
    scan_rays: int = parameter(360, "rays of a laser scan, all around", low=8, high=4096)
    scan_range_m: float = parameter(8.0, "the laser's range", unit="m", low=0.5, high=30.0)

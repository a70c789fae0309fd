"""Whether the robot has arrived, and whether it stands."""

import math

from robustnav_msgs_py.values import Odometry, Pose2D
from robustnav_nodes.planner.parameters import PlannerParameters


def has_arrived(odometry: Odometry, goal: Pose2D, parameters: PlannerParameters) -> bool:
    """Near enough to the goal, and standing."""
    near = odometry.pose.distance_m(goal) <= parameters.arrival_distance_m
    turned = abs(odometry.pose.turn_rad(goal)) <= parameters.arrival_turn_rad
    return near and turned and stands(odometry, parameters)


def stands(odometry: Odometry, parameters: PlannerParameters) -> bool:
    """Slow enough for a view to count."""
    slow = abs(odometry.linear_m_s) <= parameters.standing_m_s
    return slow and abs(odometry.angular_rad_s) <= parameters.standing_rad_s


def allowed_time_s(here: Pose2D, goal: Pose2D, parameters: PlannerParameters) -> float:
    """How long the robot may take to the goal before the way counts as blocked."""
    turn = abs(here.turn_rad(goal)) / math.pi
    return parameters.drive_timeout_s * (1.0 + here.distance_m(goal) + turn)

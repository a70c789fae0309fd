"""The node says what the contract lists, does what it is told, and answers nonsense with a sentence."""

import os
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import rclpy
from geometry_msgs.msg import Twist
from lifecycle_msgs.msg import State
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from robustnav_msgs_py import contract
from robustnav_msgs_py.conversions import (
    labels_from_message,
    map_from_message,
    objects_from_message,
    odometry_from_message,
    pose_to_message,
    record_from_message,
    stamp_from_message,
    velocity_to_message,
    visible_from_message,
)
from robustnav_msgs_py.records import Episode
from robustnav_msgs_py.values import Odometry, Pose2D, StampedPose, Velocity
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.message_class import message_class
from sim_bridge.node import SimBridge

PATIENCE_S = 20.0


class Robot:
    """The node under test, a listener to everything it says, and the executor that runs both."""

    def __init__(self) -> None:
        self.executor = EventsExecutor()
        self.sim = SimBridge(
            parameter_overrides=[
                Parameter("seed", value=3),
                Parameter("real_time_factor", value=5.0),
                Parameter("camera_width", value=80),
                Parameter("camera_height", value=60),
            ]
        )
        self.ear = Node("ear")
        self.heard: dict[str, list[Any]] = {row.name: [] for row in contract.spoken_by("sim_bridge")}
        for row in contract.spoken_by("sim_bridge"):
            self.ear.create_subscription(
                message_class(row.type), row.name, self.heard[row.name].append, qos.heard(row.qos)
            )
        self.mouth = {
            row.name: self.ear.create_publisher(message_class(row.type), row.name, qos.offered(row.qos))
            for row in contract.heard_by("sim_bridge")
        }
        self.executor.add_node(self.sim)
        self.executor.add_node(self.ear)
        self.sim.trigger_configure()
        self.sim.trigger_activate()

    def until(self, condition: Callable[[], bool]) -> None:
        """Let everything run until the condition holds."""
        deadline_s = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < deadline_s
            self.executor.spin_once(timeout_sec=1.0)

    def next(self, name: str) -> Any:
        """The first message on a topic that comes from now on."""
        count = len(self.heard[name])
        self.until(lambda: len(self.heard[name]) > count)
        return self.heard[name][-1]

    def odometry(self) -> Odometry:
        return odometry_from_message(self.next("odom"))

    def ask(self, service: str, kind: type, request: Any) -> Any:
        client = self.ear.create_client(kind, f"sim_bridge/{service}")
        self.until(client.service_is_ready)
        future = client.call_async(request)
        self.until(future.done)
        self.ear.destroy_client(client)
        return future.result()

    def close(self) -> None:
        self.sim.trigger_shutdown()
        self.sim.destroy_node()
        self.ear.destroy_node()


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    # A domain of its own keeps the nodes of other tests, and of other people, out.
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    prepare_environment(local=True)
    rclpy.init()
    made = Robot()
    try:
        made.until(lambda: all(pub.get_subscription_count() for pub in made.mouth.values()))
        yield made
    finally:
        made.close()
        rclpy.try_shutdown()
        monkeypatch.undo()


def test_it_says_everything_that_the_contract_lists(robot: Robot) -> None:
    robot.until(lambda: all(robot.heard.values()))
    plan = map_from_message(robot.heard["map"][-1])
    mask = map_from_message(robot.heard["search/candidates"][-1])
    assert plan.cells.shape == mask.cells.shape
    assert plan.frame_id == mask.frame_id == "map"
    labels = labels_from_message(robot.heard["truth/labels"][-1])
    objects = objects_from_message(robot.heard["truth/objects"][-1])
    assert {item.label for item in objects} <= set(labels)
    episode = record_from_message(robot.heard["truth/episode"][-1], Episode)
    assert episode.seed == 3
    assert robot.heard["scan"][-1].header.frame_id == "laser"


def test_images_info_and_truth_share_their_stamps(robot: Robot) -> None:
    names = ("camera/image_raw", "camera/depth/image_raw", "camera/camera_info", "truth/visible")

    def stamps(name: str) -> set[int]:
        return {stamp_from_message(message.header.stamp) for message in robot.heard[name]}

    robot.until(lambda: len(set.intersection(*(stamps(name) for name in names))) >= 3)
    image = robot.heard["camera/image_raw"][-1]
    assert (image.width, image.height, image.encoding) == (80, 60, "rgb8")
    assert robot.heard["camera/depth/image_raw"][-1].encoding == "32FC1"
    labels = labels_from_message(robot.heard["truth/labels"][-1])
    for message in robot.heard["truth/visible"]:
        assert (visible_from_message(message).label < len(labels)).all()


def test_it_drives_to_a_goal(robot: Robot) -> None:
    pose = robot.odometry().pose
    goal = Pose2D(x_m=pose.x_m, y_m=pose.y_m, yaw_rad=pose.yaw_rad + 1.0)
    robot.mouth["goal_pose"].publish(pose_to_message(StampedPose(pose=goal, stamp_ns=0)))
    robot.until(lambda: abs(robot.odometry().pose.turn_rad(goal)) < 0.02)


def test_it_drives_as_told_and_stops_when_told_no_more(robot: Robot) -> None:
    robot.mouth["cmd_vel"].publish(velocity_to_message(Velocity(linear_m_s=0.0, angular_rad_s=1.0)))
    robot.until(lambda: robot.odometry().angular_rad_s > 0.5)
    robot.until(lambda: robot.odometry().angular_rad_s == 0.0)


def test_nonsense_is_refused_with_a_sentence_and_moves_nothing(robot: Robot) -> None:
    before = robot.odometry().pose
    nan = Twist()
    nan.linear.x = float("nan")
    robot.mouth["cmd_vel"].publish(nan)
    wall = pose_to_message(StampedPose(pose=Pose2D(x_m=0.0, y_m=0.0), stamp_ns=0))
    robot.mouth["goal_pose"].publish(wall)
    elsewhere = pose_to_message(StampedPose(pose=before, stamp_ns=0, frame_id="moon"))
    robot.until(
        lambda: _said(robot, "must be finite, not (nan") and _said(robot, "cannot stand at (0.00, 0.00)")
    )
    robot.mouth["goal_pose"].publish(elsewhere)
    robot.until(lambda: _said(robot, "is in frame 'moon'"))
    turned = pose_to_message(StampedPose(pose=before, stamp_ns=0))
    turned.pose.orientation.w = turned.pose.orientation.z = 0.0
    robot.mouth["goal_pose"].publish(turned)
    robot.until(lambda: _said(robot, "an orientation must have length 1"))
    assert robot.odometry().pose == before


def _said(robot: Robot, sentence: str) -> bool:
    return any(
        sentence in pair.value
        for message in robot.heard["/diagnostics"]
        for status in message.status
        for pair in status.values
    )


def test_pause_holds_time_step_advances_it_reset_brings_the_robot_home(robot: Robot) -> None:
    refused = robot.ask("step", Trigger, Trigger.Request())
    assert not refused.success
    assert "not paused" in refused.message
    assert robot.ask("pause", SetBool, SetBool.Request(data=True)).success
    now_ns = robot.sim._running.now_ns
    for _ in range(3):
        assert robot.ask("step", Trigger, Trigger.Request()).success
    assert robot.sim._running.now_ns == now_ns + 3 * 20_000_000
    assert robot.ask("pause", SetBool, SetBool.Request(data=False)).success
    assert robot.ask("reset", Trigger, Trigger.Request()).success
    assert robot.odometry().pose == robot.sim._running.home.start


def test_a_home_that_cannot_be_built_leaves_a_sentence(robot: Robot) -> None:
    wrong = SimBridge(parameter_overrides=[Parameter("rooms", value=2)], namespace="wrong")
    try:
        wrong.trigger_configure()
        assert wrong.state_id == State.PRIMARY_STATE_UNCONFIGURED
        values = wrong.health.status("wrong", []).values
        assert any("3..6 rooms, not 2" in value for value in values.values())
    finally:
        wrong.destroy_node()

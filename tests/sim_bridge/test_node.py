"""The node says what the contract lists, does what it is told, and answers nonsense with a sentence."""

import dataclasses
import math
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
    text_to_message,
    velocity_to_message,
    visible_from_message,
)
from robustnav_msgs_py.records import Episode
from robustnav_msgs_py.values import Odometry, Pose2D, StampedPose, Velocity
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.message_class import message_class
from sim_bridge.node import SimBridge
from sim_bridge.robot.planar import composed
from sim_bridge.sensors.camera import Camera
from sim_bridge.sensors.scan import Laser
from sim_bridge.sensors.visibility import Observer

PATIENCE_S = 20.0


class Robot:
    """The node under test, a listener to everything it says, and the executor that runs both."""

    def __init__(self) -> None:
        self.executor = EventsExecutor()
        self.sim = SimBridge(
            parameter_overrides=[
                Parameter("seed", value=3),
                Parameter("real_time_factor", value=5.0),
                Parameter("lockstep_periods", value=4),
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
    assert robot.heard["bumper"][-1].data is False
    for item in objects:
        assert dict(item.attributes)["class"] == item.label
        assert dict(item.attributes)["room"] in episode.rooms


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


def test_an_action_ends_on_the_very_pose(robot: Robot) -> None:
    for line, expected in (
        ("left 90", Pose2D(x_m=0.0, y_m=0.0, yaw_rad=math.pi / 2.0)),
        ("Right", Pose2D(x_m=0.0, y_m=0.0, yaw_rad=-math.radians(15.0))),
    ):
        goal = composed(robot.odometry().pose, expected)
        robot.mouth["action"].publish(text_to_message(line))
        robot.until(lambda goal=goal: is_at(robot.odometry(), goal))


def is_at(odometry: Odometry, goal: Pose2D) -> bool:
    """Whether the robot stands there, to the last bits."""
    near = odometry.pose.distance_m(goal) < 1e-9 and abs(odometry.pose.turn_rad(goal)) < 1e-9
    return near and odometry.linear_m_s == odometry.angular_rad_s == 0.0


def test_driving_against_something_presses_the_bumper_and_is_told(robot: Robot) -> None:
    robot.mouth["action"].publish(text_to_message("forward 9"))
    robot.until(lambda: [message.data for message in robot.heard["bumper"]][-2:] == [True, False])
    robot.until(lambda: _said(robot, "'forward 9' ended after") and _said(robot, "something is in the way"))
    assert robot.ask("reset", Trigger, Trigger.Request()).success


@pytest.mark.parametrize(
    ("topic", "line", "sentence"),
    [
        ("action", "jump", "there is no action 'jump'; type 'forward [METRES]'"),
        ("action", "forward nan", "forward takes metres, more than 0"),
        ("sim/fault", "explode", "the fault 'explode' cannot be: there is no such fault"),
        ("sim/fault", "move object 999 to chair 1", "there is no object '999'"),
        ("sim/fault", "block moon / mars", "no door joins two rooms so named"),
    ],
)
def test_a_line_that_nobody_understands_gives_a_sentence_and_nothing_else(
    robot: Robot, topic: str, line: str, sentence: str
) -> None:
    before = robot.odometry().pose
    robot.mouth[topic].publish(text_to_message(line))
    robot.until(lambda: _said(robot, sentence))
    assert robot.odometry().pose == before
    assert robot.sim.is_active


def test_a_silent_sensor_is_silent_until_it_is_cleared(robot: Robot) -> None:
    robot.mouth["sim/fault"].publish(text_to_message("silent scan"))
    robot.until(lambda: robot.sim._running.faults.is_silent("scan", robot.sim._running.now_ns))
    for _ in range(5):
        robot.odometry()
    scans = len(robot.heard["scan"])
    for _ in range(20):
        robot.odometry()
    assert len(robot.heard["scan"]) == scans
    robot.mouth["sim/fault"].publish(text_to_message("clear"))
    robot.next("scan")


def test_a_moved_object_is_told_again_with_where_it_is(robot: Robot) -> None:
    home = robot.sim._running.home
    thing = next(thing for thing in home.objects if thing.label != "picture")
    for piece in home.furniture:
        if not piece.carries or piece.name == thing.furniture:
            continue
        count = len(robot.heard["truth/objects"])
        robot.mouth["sim/fault"].publish(text_to_message(f"move object {thing.instance} to {piece.name}"))
        refused = f"the {piece.name} has no room"
        robot.until(lambda c=count, r=refused: len(robot.heard["truth/objects"]) > c or _said(robot, r))
        if len(robot.heard["truth/objects"]) > count:
            break
    told = objects_from_message(robot.heard["truth/objects"][-1])[thing.instance]
    truth = robot.sim._running.home.objects[thing.instance].as_truth()
    assert told == dataclasses.replace(truth, yaw_rad=told.yaw_rad)
    assert told.yaw_rad == pytest.approx(truth.yaw_rad)
    assert (told.x_m, told.y_m) != (thing.as_truth().x_m, thing.as_truth().y_m)
    assert dict(told.attributes)["on"] == piece.kind
    assert dict(told.attributes)["room"] == piece.room
    assert dict(told.attributes)["colour"] == thing.look.colour


def test_nonsense_is_refused_with_a_sentence_and_moves_nothing(robot: Robot) -> None:
    before = robot.odometry().pose
    for wrong in (math.nan, math.inf):
        twist = Twist()
        twist.linear.x = wrong
        robot.mouth["cmd_vel"].publish(twist)
        robot.until(lambda wrong=wrong: _said(robot, f"must be finite, not ({wrong}"))
    for x_m, y_m in ((0.0, 0.0), (-40.0, 2.0)):
        wall = pose_to_message(StampedPose(pose=Pose2D(x_m=x_m, y_m=y_m), stamp_ns=0))
        robot.mouth["goal_pose"].publish(wall)
        place = f"({x_m:.2f}, {y_m:.2f})"
        robot.until(lambda place=place: _said(robot, f"cannot stand at {place}"))
    elsewhere = pose_to_message(StampedPose(pose=before, stamp_ns=0, frame_id="moon"))
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
    assert robot.sim._running.now_ns == now_ns + 3 * 4 * 20_000_000
    assert robot.ask("pause", SetBool, SetBool.Request(data=False)).success
    assert robot.ask("reset", Trigger, Trigger.Request()).success
    assert robot.odometry().pose == robot.sim._running.home.start


def test_a_goal_in_odom_is_meant_where_odometry_has_it(robot: Robot) -> None:
    """With drift, `odom` is not `map`: the robot's pose in one is the same place in the other."""
    drifting = SimBridge(
        parameter_overrides=[Parameter("drift_rad_per_rad", value=0.2), Parameter("camera_width", value=80)],
        namespace="drifting",
    )
    try:
        drifting.trigger_configure()
        simulation = drifting._running
        simulation.act("left 90")
        for _ in range(200):
            simulation.step()
        told = simulation.odometry()
        here = drifting._in_map(StampedPose(pose=told.pose, stamp_ns=0, frame_id=told.frame_id))
        assert abs(told.pose.turn_rad(simulation.drive.pose)) > 1e-3
        assert here.distance_m(simulation.drive.pose) < 1e-9
        assert abs(here.turn_rad(simulation.drive.pose)) < 1e-9
    finally:
        drifting.trigger_shutdown()
        drifting.destroy_node()


def test_only_what_somebody_listens_to_is_rendered(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is computed in two seconds, first without listeners, then with one more each time."""
    work: list[str] = []

    def counted(owner: type, name: str, word: Callable[..., str]) -> None:
        real = getattr(owner, name)

        def call(self: Any, *args: Any, **options: Any) -> Any:
            work.append(word(**options))
            return real(self, *args, **options)

        monkeypatch.setattr(owner, name, call)

    counted(Camera, "take", lambda color=True: "colour" if color else "depth")
    counted(Observer, "look", lambda **_: "truth")
    counted(Laser, "take", lambda **_: "scan")
    alone = SimBridge(parameter_overrides=[Parameter("camera_width", value=80)], namespace="alone")
    try:
        alone.trigger_configure()
        alone.trigger_activate()
        expected: set[str] = set()
        for name, outlet, adds in (
            ("", None, set()),
            ("scan", alone._scan_out, {"scan"}),
            ("truth/visible", alone._visible_out, {"truth"}),
            ("camera/depth/image_raw", alone._depth_out, {"depth"}),
            ("camera/image_raw", alone._color_out, {"colour"}),
        ):
            if outlet is not None:
                row = contract.topic(name)
                robot.ear.create_subscription(
                    message_class(row.type), f"alone/{name}", lambda _: None, qos.heard(row.qos)
                )
                robot.until(lambda outlet=outlet: outlet.get_subscription_count() > 0)
            # Who wants colour gets depth from the same picture.
            expected = (expected | adds) - ({"depth"} if adds == {"colour"} else set())
            work.clear()
            for _ in range(100):
                alone._step()
            assert set(work) == expected, name
    finally:
        alone.trigger_shutdown()
        alone.destroy_node()


def test_a_home_that_cannot_be_built_leaves_a_sentence(robot: Robot) -> None:
    wrong = SimBridge(parameter_overrides=[Parameter("scene", value="/nowhere/home.yaml")], namespace="wrong")
    try:
        wrong.trigger_configure()
        assert wrong.state_id == State.PRIMARY_STATE_UNCONFIGURED
        values = wrong.health.status("wrong", []).values
        assert any("/nowhere/home.yaml" in value for value in values.values())
    finally:
        wrong.destroy_node()

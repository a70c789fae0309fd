"""Time, rates, the watchdog, and that the same seed gives the same run."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError, BadSceneError
from robustnav_msgs_py.parameters import build, specs
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.parameters import SimParameters
from sim_bridge.simulation import START_NS, Simulation

FreePoses = Callable[..., list[Pose2D]]

FORWARD = Velocity(linear_m_s=0.1, angular_rad_s=0.0)


def test_time_goes_in_equal_steps(fresh: Simulation) -> None:
    assert fresh.now_ns == START_NS
    for step in range(1, 101):
        fresh.step()
        assert fresh.now_ns == START_NS + step * 20_000_000


def test_sensors_come_at_their_rates(fresh: Simulation) -> None:
    due = [fresh.step() for _ in range(500)]
    assert sum(item.odom for item in due) == 200
    assert sum(item.scan for item in due) == 100
    assert sum(item.camera for item in due) == 50


def test_the_watchdog_stops_the_robot(fresh: Simulation) -> None:
    fresh.command(FORWARD)
    for _ in range(24):
        fresh.step()
    assert fresh.drive.velocity.linear_m_s == pytest.approx(0.1)
    for _ in range(5):
        fresh.step()
    assert fresh.drive.velocity.linear_m_s == 0.0
    pose = fresh.drive.pose
    for _ in range(50):
        fresh.step()
    assert fresh.drive.pose == pose


def test_commands_that_keep_coming_keep_it_moving(fresh: Simulation) -> None:
    for step in range(100):
        if step % 20 == 0:
            fresh.command(FORWARD)
        fresh.step()
    assert fresh.drive.velocity.linear_m_s == pytest.approx(0.1)


def run(seed: int, free_poses: FreePoses) -> list[object]:
    """What a run of commands, goals and sensors gives, in full."""
    said: list[object] = []
    with Simulation(SimParameters(seed=seed)) as simulation:
        goals = iter(free_poses(simulation.home, 10, seed=0))
        for step in range(300):
            if step % 150 == 0:
                simulation.go_to(next(goals))
            if step % 150 == 100:
                simulation.command(Velocity(linear_m_s=0.3, angular_rad_s=0.5))
            due = simulation.step()
            if due.odom:
                said.append(simulation.odometry())
            if due.scan:
                said.append(simulation.laser_scan().ranges_m.tobytes())
            if due.camera:
                truth = simulation.visible_objects()
                said.append(
                    (truth.instance.tobytes(), truth.box_px.tobytes(), truth.visible_fraction.tobytes())
                )
            if step % 100 == 99:
                frame = simulation.camera_frame()
                said.append((frame.color.pixels.tobytes(), frame.depth.depth_m.tobytes()))
    return said


def test_same_seed_same_run(free_poses: FreePoses) -> None:
    first = run(4, free_poses)
    assert first == run(4, free_poses)
    assert first[0] != run(5, free_poses)[0]


def test_two_simulations_do_not_disturb_each_other(fresh: Simulation) -> None:
    before = fresh.camera_frame()
    with Simulation(SimParameters(seed=2)) as other:
        other.camera_frame()
        np.testing.assert_array_equal(fresh.camera_frame().color.pixels, before.color.pixels)
    np.testing.assert_array_equal(fresh.camera_frame().color.pixels, before.color.pixels)


def test_reset_brings_the_robot_back_and_time_goes_on(fresh: Simulation, free_poses: FreePoses) -> None:
    fresh.go_to(free_poses(fresh.home, 1, seed=0)[0])
    for _ in range(100):
        fresh.step()
    now_ns = fresh.now_ns
    fresh.reset()
    fresh.step()
    assert fresh.drive.pose == fresh.home.start
    assert fresh.now_ns > now_ns
    assert fresh.follower.goal is None


def test_the_robot_can_be_placed_but_not_in_a_wall(fresh: Simulation, free_poses: FreePoses) -> None:
    pose = free_poses(fresh.home, 1, seed=3)[0]
    fresh.place(pose)
    assert fresh.odometry().pose == pose
    with pytest.raises(BadMessageError, match="does not fit"):
        fresh.place(Pose2D(x_m=0.0, y_m=0.0))
    assert fresh.odometry().pose == pose


def test_stamps_and_frames(fresh: Simulation) -> None:
    fresh.step()
    frame, truth = fresh.camera_frame(), fresh.visible_objects()
    stamps = {frame.color.stamp_ns, frame.depth.stamp_ns, frame.model.stamp_ns, truth.stamp_ns}
    assert stamps == {fresh.camera_model().stamp_ns} == {fresh.now_ns}
    frames = {frame.color.frame_id, frame.depth.frame_id, frame.model.frame_id, truth.frame_id}
    assert frames == {"camera_optical_frame"}
    assert fresh.laser_scan().frame_id == "laser"
    assert (fresh.odometry().frame_id, fresh.odometry().child_frame_id) == ("map", "base_link")
    assert frame.color.pixels.shape == (240, 320, 3)
    assert frame.depth.depth_m.shape == (240, 320)


def test_the_episode_tells_what_decided_the_run(fresh: Simulation) -> None:
    episode = fresh.episode()
    assert episode.seed == 1
    assert set(episode.rooms) == {room.name for room in fresh.home.rooms}
    assert (
        math.hypot(episode.start_x_m - fresh.home.start.x_m, episode.start_y_m - fresh.home.start.y_m) == 0.0
    )


def test_parameters_build_and_a_home_of_one_room_is_refused() -> None:
    assert build(SimParameters, {}) == SimParameters()
    assert all(spec.description for spec in specs(SimParameters))
    with pytest.raises(BadSceneError, match=r"3\.\.6 rooms, not 1"):
        Simulation(SimParameters(rooms=1))


def test_closing_twice_is_harmless() -> None:
    simulation = Simulation(SimParameters(seed=0))
    simulation.close()
    simulation.close()

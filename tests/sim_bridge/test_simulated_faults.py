"""What goes wrong in the whole simulation: faults on request, late pictures, things that no map knows."""

import math

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.floor_plan import FREE, floor_plan
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.shapes import Vector3
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.goal_follower import GoalRefusedError
from sim_bridge.sensors.camera_driver import Wanted
from sim_bridge.simulation import Simulation
from tests.sim_bridge.simulated_runs import ALL, SMALL, FreePoses, finish, shoot, told


def due_sensors(simulation: Simulation, steps: int = 50) -> tuple[int, int, int, int]:
    """How often odometry, scan, colour and depth come within so many steps."""
    odom = scan = color = depth = 0
    for _ in range(steps):
        due = simulation.step()
        odom, scan = odom + due.odom, scan + due.scan
        if due.camera:
            simulation.shoot(ALL)
        for shot in simulation.shots():
            color, depth = color + (shot.color is not None), depth + (shot.depth is not None)
            assert shot.visible is not None
    return odom, scan, color, depth


def test_sensors_fall_silent_one_by_one_and_speak_again() -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        assert due_sensors(simulation) == (20, 10, 5, 5)
        for line, expected in (
            ("silent camera 1", (20, 10, 0, 5)),
            ("silent depth 1", (20, 10, 5, 0)),
            ("silent scan 1", (20, 0, 5, 5)),
            ("silent odom 1", (0, 10, 5, 5)),
        ):
            simulation.fail(line)
            heard = due_sensors(simulation)
            # The fault ends at the step that ends the second, whose sensors speak again.
            assert all(abs(count - wanted) <= 1 for count, wanted in zip(heard, expected, strict=True)), line
            assert due_sensors(simulation) == (20, 10, 5, 5), line


def test_a_frozen_camera_repeats_its_picture_under_new_stamps() -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        first = shoot(simulation)
        simulation.fail("frozen camera")
        simulation.act("left 90")
        finish(simulation)
        frozen = shoot(simulation)
        assert told(frozen)[1:] == told(first)[1:]
        assert frozen.model.stamp_ns == simulation.now_ns > first.model.stamp_ns
        simulation.fail("clear")
        assert told(shoot(simulation))[1:] != told(first)[1:]


def test_who_begins_to_listen_to_a_frozen_camera_hears_the_same_picture_again_and_again() -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        nobody = shoot(simulation, Wanted(color=False, depth=False, visible=False))
        assert nobody.color is None
        simulation.fail("frozen camera")
        first = shoot(simulation)
        simulation.act("left 90")
        finish(simulation)
        assert told(shoot(simulation))[1:] == told(first)[1:]


def test_wheels_that_slip_claim_more_than_there_is() -> None:
    settings = SimParameters(seed=1, drift_share_per_m=1e-9, **SMALL)
    with Simulation(settings) as simulation:
        simulation.drive.replace_obstacles(Obstacles((), simulation.home.bounds.grown(5.0)))
        start = simulation.drive.pose
        simulation.fail("slip 0.5")
        for _ in range(200):
            simulation.command(Velocity(linear_m_s=0.2, angular_rad_s=0.0))
            simulation.step()
        claimed_m = simulation.odometry().pose.distance_m(start)
        assert simulation.drive.pose.distance_m(start) == pytest.approx(claimed_m / 2.0, rel=1e-6)


def far_goal(simulation: Simulation, free_poses: FreePoses) -> tuple[str, Pose2D]:
    """A door, as 'one / other', with a goal behind it that no other way leads to."""
    for door in simulation.home.doors:
        line = " / ".join(door.rooms)
        simulation.fail(f"block {line}")
        simulation.step()
        for goal in free_poses(simulation.home, 60, seed=1, clearance_m=0.3):
            try:
                simulation.go_to(goal)
            except GoalRefusedError:
                simulation.reset()
                return line, goal
        simulation.reset()
    raise AssertionError("every goal has a way around every door")


def test_a_blocked_door_is_met_with_a_sentence_and_opens_again(free_poses: FreePoses) -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        line, goal = far_goal(simulation, free_poses)
        before = told(shoot(simulation))
        simulation.fail(f"block {line}")
        with pytest.raises(GoalRefusedError, match="no way"):
            simulation.go_to(goal)
        simulation.fail("clear")
        assert told(shoot(simulation))[1:] == before[1:]
        # Now it shuts while the robot is on its way.
        simulation.go_to(goal)
        for _ in range(20):
            simulation.step()
        simulation.fail(f"block {line}")
        finish(simulation)
        assert "no way" in simulation.problem
        assert simulation.drive.pose.distance_m(goal) > 0.1
        simulation.fail("clear")
        simulation.go_to(goal)
        finish(simulation)
        assert simulation.problem == ""
        assert simulation.drive.pose.distance_m(goal) < 1e-9


def test_a_closed_door_is_seen_by_laser_and_camera_but_not_on_the_map() -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        door = simulation.home.doors[0]
        x_m, y_m = door.opening.centre_m
        yaw_rad = math.pi / 2.0 if door.along_x else 0.0
        ahead = (0.0, 0.5) if door.along_x else (0.5, 0.0)
        simulation.place(Pose2D(x_m=x_m - ahead[0], y_m=y_m - ahead[1], yaw_rad=yaw_rad))
        plan = floor_plan(simulation.home)
        open_m = float(simulation.laser_scan().ranges_m[180])
        far_m = np.nanmax(np.asarray(shoot(simulation).depth.depth_m[20, 30:50]))  # type: ignore[union-attr]
        simulation.fail(f"block {' / '.join(door.rooms)}")
        simulation.step()
        assert float(simulation.laser_scan().ranges_m[180]) == pytest.approx(0.45, abs=0.01) != open_m
        near_m = np.nanmax(np.asarray(shoot(simulation).depth.depth_m[20, 30:50]))  # type: ignore[union-attr]
        assert near_m < 0.5 < far_m
        assert (floor_plan(simulation.home).cells == plan.cells).all()
        simulation.fail("clear")
        assert float(simulation.laser_scan().ranges_m[180]) == open_m
        assert (floor_plan(simulation.home).cells == plan.cells).all()


def test_a_door_in_which_the_robot_stands_waits() -> None:
    with Simulation(SimParameters(seed=1, **SMALL)) as simulation:
        door = simulation.home.doors[0]
        x_m, y_m = door.opening.centre_m
        simulation.place(Pose2D(x_m=x_m, y_m=y_m, yaw_rad=math.pi / 2.0 if door.along_x else 0.0))
        simulation.fail(f"block {' / '.join(door.rooms)}")
        for _ in range(10):
            simulation.step()
        assert simulation.stage.closed == ()
        # Meanwhile nothing is built anew step by step, and other doors shut and open.
        scenery, other = simulation.stage.scenery, simulation.home.doors[-1]
        simulation.step()
        assert simulation.stage.scenery is scenery
        simulation.fail(f"block {' / '.join(other.rooms)} 1")
        simulation.step()
        assert simulation.stage.closed == (other,)
        for _ in range(50):
            simulation.step()
        assert simulation.stage.closed == ()
        simulation.act("forward 0.6")
        finish(simulation)
        assert simulation.problem == ""
        simulation.step()
        assert simulation.stage.closed == (door,)


def move_somewhere(simulation: Simulation, instance: int) -> None:
    """Move an object to the first other piece of furniture that has room for it."""
    thing = simulation.home.objects[instance]
    for piece in simulation.home.furniture:
        if not piece.carries or piece.name == thing.furniture:
            continue
        try:
            assert simulation.fail(f"move object {instance} to {piece.name}")
        except BadMessageError:
            continue
        now = simulation.home.objects[instance]
        assert (now.furniture, now.room) == (piece.name, piece.room)
        assert now.as_truth().attributes != thing.as_truth().attributes
        return
    raise AssertionError(f"no furniture has room for the {thing.label}")


def met_from_above(simulation: Simulation, instance: int, centre_m: Vector3) -> bool:
    """Whether a ray straight down onto a place meets the object."""
    top = np.array([[centre_m[0], centre_m[1], centre_m[2] + 0.4]])
    _, bodies = simulation.stage.world.cast(top, np.array([centre_m]))
    return simulation.stage.world.instance_of.get(int(bodies[0])) == instance


def is_where_it_is_said_to_be(simulation: Simulation, instance: int, free_poses: FreePoses) -> bool:
    """Whether truth and picture show the object in the same place of some views, and rays meet it."""
    now = simulation.home.objects[instance]
    near = sorted(
        free_poses(simulation.home, 60, seed=1),
        key=lambda pose: math.hypot(pose.x_m - now.x_m, pose.y_m - now.y_m),
    )
    seen = 0
    for place in near[:8]:
        bearing = math.atan2(now.y_m - place.y_m, now.x_m - place.x_m)
        pose = Pose2D(x_m=place.x_m, y_m=place.y_m, yaw_rad=bearing)
        truth = simulation._observer.look(pose, 0)
        rows, columns = np.nonzero(simulation._camera.take(pose, 0, color=False).numbers == instance)
        listed = truth.instance == instance
        if listed.any() and truth.visible_fraction[listed][0] > 0.5:
            x_min, y_min, x_max, y_max = truth.box_px[listed][0]
            if not len(rows) or not (x_min <= columns.mean() <= x_max and y_min <= rows.mean() <= y_max):
                return False
            seen += 1
        elif not listed.any() and len(rows) >= 10:
            return False
    return seen > 0 and met_from_above(simulation, instance, now.centre_m)


def test_a_moved_object_is_elsewhere_for_everybody(free_poses: FreePoses) -> None:
    """Truth, picture and rays agree on its place, also where doors close and open afterwards."""
    with Simulation(SimParameters(seed=2)) as simulation:
        first = simulation.home
        instance = next(thing.instance for thing in first.objects if thing.label == "mug")
        line = f"block {' / '.join(simulation.home.doors[0].rooms)}"
        for fault in (None, line, "clear"):
            before = simulation.home.objects[instance]
            assert is_where_it_is_said_to_be(simulation, instance, free_poses)
            move_somewhere(simulation, instance)
            assert is_where_it_is_said_to_be(simulation, instance, free_poses)
            assert not met_from_above(simulation, instance, before.centre_m)
            if fault is not None:
                simulation.fail(fault)
                assert is_where_it_is_said_to_be(simulation, instance, free_poses)
        away = simulation.home.objects[instance]
        assert simulation.reset()
        assert simulation.home == first
        assert is_where_it_is_said_to_be(simulation, instance, free_poses)
        assert not met_from_above(simulation, instance, away.centre_m)
        assert not simulation.reset()


def late(settings: dict[str, object]) -> list[tuple[int, int]]:
    """When shots come, and the stamps that they have, in seconds of a run of 20 s."""
    arrived = []
    with Simulation(SimParameters(seed=1, **SMALL, **settings)) as simulation:  # type: ignore[arg-type]
        for _ in range(1000):
            if simulation.step().camera:
                simulation.shoot(Wanted(color=False, depth=False, visible=False))
            arrived += [(simulation.now_ns, shot.model.stamp_ns) for shot in simulation.shots()]
    return arrived


def test_pictures_get_lost() -> None:
    arrived = late({"frame_drop": 0.3})
    assert 50 <= len(arrived) <= 90
    assert all(now_ns == stamp_ns for now_ns, stamp_ns in arrived)
    assert late({"frame_drop": 1.0}) == []


def test_late_pictures_have_old_stamps_and_keep_their_order() -> None:
    arrived = late({"frame_delay_s": 0.3, "frame_jitter_s": 0.4})
    ages_s = np.array([(now_ns - stamp_ns) / 1e9 for now_ns, stamp_ns in arrived])
    stamps = [stamp_ns for _, stamp_ns in arrived]
    assert len(arrived) >= 96
    assert ages_s.min() >= 0.3
    assert 0.55 < ages_s.max() <= 0.72
    assert stamps == sorted(set(stamps))


def test_what_is_on_its_way_at_a_reset_never_comes() -> None:
    with Simulation(SimParameters(seed=1, frame_delay_s=1.0, **SMALL)) as simulation:
        simulation.shoot(ALL)
        simulation.fail("frozen camera")
        simulation.reset()
        reset_ns = simulation.now_ns
        stamps = []
        for _ in range(150):
            if simulation.step().camera:
                simulation.shoot(ALL)
            stamps += [shot.model.stamp_ns for shot in simulation.shots()]
        assert stamps
        assert min(stamps) > reset_ns


def test_things_moved_in_are_met_and_seen_but_on_no_map() -> None:
    with (
        Simulation(SimParameters(seed=4, occluders=3, **SMALL)) as simulation,
        Simulation(SimParameters(seed=4, **SMALL)) as without,
    ):
        assert simulation.home == without.home
        assert (floor_plan(simulation.home).cells == floor_plan(without.home).cells).all()
        extra = [
            sides
            for sides in simulation.stage.obstacles._sides
            if sides not in without.stage.obstacles._sides
        ]
        assert len(extra) == 3
        met = shown = 0
        for x_min_m, x_max_m, y_min_m, y_max_m in extra:
            middle = ((x_min_m + x_max_m) / 2.0, (y_min_m + y_max_m) / 2.0)
            plan = floor_plan(simulation.home)
            row = int((middle[1] - plan.origin.y_m) / plan.resolution_m)
            column = int((middle[0] - plan.origin.x_m) / plan.resolution_m)
            assert plan.cells[row, column] == FREE
            for bearing in np.linspace(-math.pi, math.pi, 24):
                x_m, y_m = middle[0] - 1.2 * math.cos(bearing), middle[1] - 1.2 * math.sin(bearing)
                if simulation.stage.obstacles.clearance_m(x_m, y_m) < 0.2:
                    continue
                pose = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=float(bearing))
                simulation.place(pose)
                without.place(pose)
                met += not np.array_equal(simulation.laser_scan().ranges_m, without.laser_scan().ranges_m)
                shown += told(shoot(simulation))[1:] != told(shoot(without))[1:]
        assert met >= 3
        assert shown >= 3

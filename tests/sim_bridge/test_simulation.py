"""Time, rates, the watchdog, actions, odometry, and that the same seed and commands give the same run."""

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError, BadMessageError, BadSceneError, RobustnavError
from robustnav_msgs_py.parameters import build, specs
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.floor_plan import FREE, floor_plan
from sim_bridge.homes.generator import generate_scene
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.scene_files.scene_file import write_scene
from sim_bridge.homes.shapes import Vector3
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.goal_follower import GoalRefusedError
from sim_bridge.robot.odometry import SYSTEMATIC
from sim_bridge.sensors.camera_driver import Shot, Wanted
from sim_bridge.simulation import START_NS, Simulation

FreePoses = Callable[..., list[Pose2D]]

FORWARD = Velocity(linear_m_s=0.1, angular_rad_s=0.0)
ALL = Wanted(color=True, depth=True, visible=True)
LONGEST_S = 120.0
SMALL = {"camera_width": 80, "camera_height": 60}
# Everything that can be wrong with the sensors at once.
WORN = {
    "exposure_s": 0.03,
    "darkness": 0.3,
    "image_noise": 4.0,
    "image_downscale": 2,
    "depth_noise": 0.002,
    "depth_step": 0.003,
    "depth_holes": 0.1,
    "drift_share_per_m": 0.03,
    "drift_rad_per_m": 0.02,
    "drift_rad_per_rad": 0.02,
    "frame_drop": 0.1,
    "frame_delay_s": 0.1,
    "frame_jitter_s": 0.2,
    "occluders": 3,
}


def shoot(simulation: Simulation, wanted: Wanted = ALL) -> Shot:
    """The picture of a camera that is neither late nor silent."""
    simulation.shoot(wanted)
    (shot,) = simulation.shots()
    return shot


def finish(simulation: Simulation) -> None:
    """Step until there is nothing more to do."""
    for _ in range(round(LONGEST_S / simulation.period_s)):
        if not (simulation.follower.busy or simulation.actions.busy) and simulation.drive.stands:
            return
        simulation.step()
    raise AssertionError("the robot never came to an end")


# Time.


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


def told(shot: Shot) -> list[object]:
    """All bytes of a shot."""
    assert shot.color is not None
    assert shot.depth is not None
    assert shot.visible is not None
    truth = shot.visible
    arrays = (
        shot.color.pixels,
        shot.depth.depth_m,
        truth.instance,
        truth.box_px,
        truth.visible_fraction,
        truth.position_m,
    )
    return [shot.model.stamp_ns, *(array.tobytes() for array in arrays)]


def run(steps: int, free_poses: FreePoses, **settings: object) -> list[object]:
    """What a run of commands, goals, actions and faults gives, in full."""
    said: list[object] = []
    with Simulation(SimParameters(**SMALL, **settings)) as simulation:  # type: ignore[arg-type]
        goals = iter(free_poses(simulation.home, 10, seed=0))
        door = " / ".join(simulation.home.doors[0].rooms) if simulation.home.doors else None
        carrier = next(
            piece.name for piece in simulation.home.furniture if piece.kind != "mat" and piece.carries
        )
        lines = {
            10: "slip 0.3 1",
            60: f"block {door} 2" if door else "clear",
            90: "silent camera 0.4",
            130: "silent depth 0.4",
            170: "silent scan 0.5",
            200: "silent odom 0.5",
            230: "frozen camera 0.5",
            250: f"move object 0 to {carrier}",
        }
        for step in range(steps):
            try:
                if step % 150 == 0:
                    simulation.go_to(next(goals))
                if step % 150 == 80:
                    simulation.command(Velocity(linear_m_s=0.3, angular_rad_s=0.5))
                if step % 150 == 110:
                    simulation.act("left 30")
                if step in lines:
                    said.append(simulation.fail(lines[step]))
            except RobustnavError as problem:
                said.append(str(problem))
            due = simulation.step()
            said += [due, simulation.now_ns, simulation.drive.pose, simulation.problem]
            if due.odom:
                said += [simulation.odometry(), simulation.map_from_odom()]
            if due.scan:
                said.append(simulation.laser_scan().ranges_m.tobytes())
            if due.camera:
                simulation.shoot(ALL)
            for shot in simulation.shots():
                said += told(shot) if shot.color and shot.depth else [shot.model.stamp_ns]
        said += [thing.as_truth() for thing in simulation.home.objects]
    return said


@pytest.mark.parametrize("settings", [{}, WORN], ids=["as good as new", "worn"])
def test_the_same_seed_and_commands_give_the_same_run(
    settings: dict[str, object], free_poses: FreePoses
) -> None:
    first = run(300, free_poses, seed=4, **settings)
    assert first == run(300, free_poses, seed=4, **settings)
    assert first != run(30, free_poses, seed=5, **settings)[: len(first)]
    assert sum(isinstance(item, bytes) for item in first) > 100


def test_two_simulations_do_not_disturb_each_other(fresh: Simulation) -> None:
    before = told(shoot(fresh))
    with Simulation(SimParameters(seed=2)) as other:
        other.fail(f"block {' / '.join(other.home.doors[0].rooms)}")
        other.step()
        shoot(other)
        assert told(shoot(fresh)) == before
    assert told(shoot(fresh)) == before


# Commands.


def test_the_watchdog_stops_the_robot_after_half_a_second(fresh: Simulation) -> None:
    fresh.command(FORWARD)
    for _ in range(25):
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


@pytest.mark.parametrize("stop_m", [0.0, 0.01, 0.15])
def test_the_robot_comes_as_near_to_a_wall_as_it_may_and_no_nearer(stop_m: float) -> None:
    with Simulation(SimParameters(seed=3, difficulty="easy", stop_distance_m=stop_m, **SMALL)) as simulation:
        pressed = []
        for _ in range(1500):
            simulation.command(Velocity(linear_m_s=0.5, angular_rad_s=0.0))
            due = simulation.step()
            pressed += [simulation.bumper.pressed] if due.bumper else []
        pose = simulation.drive.pose
        spare_m = simulation.stage.obstacles.clearance_m(pose.x_m, pose.y_m) - 0.15 - stop_m
        assert 0.0 <= spare_m < 0.001
        assert pressed == [True]
        for _ in range(40):
            simulation.command(Velocity(linear_m_s=-0.3, angular_rad_s=0.0))
            simulation.step()
        assert not simulation.bumper.pressed


def roomy(simulation: Simulation, free_poses: FreePoses) -> Pose2D:
    """A pose with a square of 0.3 m of free floor to its left."""
    poses = free_poses(simulation.home, 200, seed=1, clearance_m=0.65)
    assert poses, "the home has no floor that is free enough"
    return poses[0]


def test_turns_come_back_to_the_very_heading(fresh: Simulation) -> None:
    start = fresh.drive.pose
    for turn in range(24):
        fresh.act("left 15")
        if turn % 12 == 11:
            finish(fresh)
    assert fresh.problem == ""
    assert fresh.drive.pose.distance_m(start) < 1e-9
    assert abs(fresh.drive.pose.turn_rad(start)) < 1e-9


def test_four_sides_of_a_square_come_back_to_the_very_corner(
    fresh: Simulation, free_poses: FreePoses
) -> None:
    start = roomy(fresh, free_poses)
    fresh.place(start)
    for _ in range(4):
        fresh.act("forward 0.3")
        fresh.act("left 90")
    finish(fresh)
    assert fresh.problem == ""
    assert fresh.drive.pose.distance_m(start) < 1e-9
    assert abs(fresh.drive.pose.turn_rad(start)) < 1e-9


def test_words_alone_mean_the_parameters_steps(free_poses: FreePoses) -> None:
    settings = SimParameters(seed=1, action_step_m=0.4, action_turn_rad=math.radians(30.0))
    with Simulation(settings) as simulation:
        start = roomy(simulation, free_poses)
        simulation.place(start)
        simulation.act("right")
        finish(simulation)
        assert start.turn_rad(simulation.drive.pose) == pytest.approx(math.radians(-30.0), abs=1e-9)
        simulation.act("forward")
        finish(simulation)
        assert simulation.drive.pose.distance_m(start) == pytest.approx(0.4, abs=1e-9)


def test_goal_action_and_velocity_take_over_from_each_other(fresh: Simulation, free_poses: FreePoses) -> None:
    goal = max(free_poses(fresh.home, 20, seed=1), key=fresh.drive.pose.distance_m)
    fresh.go_to(goal)
    fresh.act("left 90")
    assert fresh.follower.goal is None
    assert fresh.actions.busy
    fresh.go_to(goal)
    assert not fresh.actions.busy
    fresh.command(FORWARD)
    assert fresh.follower.goal is None
    with pytest.raises(BadMessageError):
        fresh.act("jump")
    fresh.step()
    assert fresh.drive.velocity.linear_m_s > 0.0


def test_a_problem_is_told_until_the_robot_is_told_something_else(fresh: Simulation) -> None:
    fresh.act("forward 9")
    finish(fresh)
    assert fresh.problem.startswith("'forward 9' ended after ")
    assert fresh.problem.endswith(": something is in the way")
    fresh.go_to(fresh.home.start)
    assert fresh.problem == ""
    fresh.fail("slip 1")
    finish(fresh)
    assert fresh.problem.endswith("its wheels slip")
    fresh.fail("clear")
    fresh.act("left 15")
    assert fresh.problem == ""
    fresh.act("forward 9")
    finish(fresh)
    assert fresh.problem.startswith("'forward 9' ended after ")
    fresh.reset()
    assert fresh.problem == ""


@pytest.mark.parametrize(
    "longest_s", [0.5, pytest.param(12.0, marks=pytest.mark.slow)], ids=["hasty", "patient"]
)
def test_random_commands_never_take_the_robot_anywhere_it_cannot_be(longest_s: float) -> None:
    """A thousand commands, goals and actions at random, in homes of all difficulties, with things moved in.

    Each has up to `longest_s` before the next one comes, velocities as if somebody kept publishing them.
    """
    went_m = 0.0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        difficulty = ("easy", "medium", "hard")[seed % 3]
        with Simulation(SimParameters(seed=seed, difficulty=difficulty, occluders=seed % 4)) as simulation:
            rects = (*simulation.stage.obstacles._sides,)
            low, high = np.array(rects)[:, [0, 2]], np.array(rects)[:, [1, 3]]
            bounds = simulation.home.bounds
            for _ in range(50):
                x_m, y_m = (
                    float(rng.uniform(bounds.x_min_m - 0.3, bounds.x_max_m + 0.3)),
                    float(rng.uniform(bounds.y_min_m - 0.3, bounds.y_max_m + 0.3)),
                )
                velocity = None
                try:
                    match int(rng.integers(4)):
                        case 0:
                            simulation.go_to(Pose2D(x_m=x_m, y_m=y_m, yaw_rad=float(rng.uniform(-3.0, 3.0))))
                        case 1:
                            simulation.act(
                                str(rng.choice(["forward 3", "back 2", "left 200", "right", "stop"]))
                            )
                        case _:
                            linear, angular = rng.normal(0.0, 1.0, 2).tolist()
                            velocity = Velocity(linear_m_s=linear, angular_rad_s=angular)
                except RobustnavError:
                    pass
                for step in range(round(rng.uniform(0.0, longest_s) / simulation.period_s)):
                    if velocity is not None and step % 20 == 0:
                        simulation.command(velocity)
                    before = simulation.drive.pose
                    simulation.step()
                    pose = simulation.drive.pose
                    went_m += pose.distance_m(before)
                    assert before.distance_m(pose) <= 0.5 * simulation.period_s + 1e-9
                    beyond = np.maximum(low - (pose.x_m, pose.y_m), (pose.x_m, pose.y_m) - high)
                    away_m = np.hypot(*np.maximum(beyond, 0.0).T).min()
                    assert away_m >= 0.15, (seed, pose)
                    assert simulation.home.bounds.holds(pose.x_m, pose.y_m)
    assert went_m > 25.0 * longest_s


def test_reset_brings_the_robot_back_and_time_goes_on(fresh: Simulation, free_poses: FreePoses) -> None:
    door = fresh.home.doors[0]
    fresh.fail(f"block {' / '.join(door.rooms)}")
    fresh.fail("silent odom")
    fresh.go_to(fresh.home.start)
    fresh.step()
    assert fresh.stage.closed == (door,)
    now_ns = fresh.now_ns
    fresh.reset()
    due = [fresh.step() for _ in range(5)]
    assert fresh.drive.pose == fresh.home.start
    assert fresh.now_ns > now_ns
    assert fresh.follower.goal is None
    assert fresh.stage.closed == ()
    assert any(item.odom for item in due)


def test_the_robot_can_be_placed_but_not_in_a_wall(fresh: Simulation, free_poses: FreePoses) -> None:
    pose = free_poses(fresh.home, 1, seed=3)[0]
    fresh.place(pose)
    assert fresh.odometry().pose == pose
    x_m, y_m = fresh.home.walls[0].base.centre_m
    with pytest.raises(BadMessageError, match="does not fit"):
        fresh.place(Pose2D(x_m=x_m, y_m=y_m))
    assert fresh.odometry().pose == pose


# Odometry.


def square(simulation: Simulation) -> None:
    for _ in range(4):
        simulation.act("forward 0.5")
        simulation.act("left 90")
    finish(simulation)
    assert simulation.problem == ""


def test_without_drift_odometry_closes_a_square_exactly(fresh: Simulation, free_poses: FreePoses) -> None:
    start = roomy(fresh, free_poses)
    fresh.place(start)
    square(fresh)
    told = fresh.odometry()
    assert told.frame_id == "map"
    assert told.pose == fresh.drive.pose
    assert told.pose.distance_m(start) < 1e-9
    assert fresh.map_from_odom() == Pose2D(x_m=0.0, y_m=0.0)


def test_with_drift_odometry_closes_a_square_but_for_what_is_documented() -> None:
    """A way of 2 m and a turn of a full circle; each error's variance as `odometry` has it."""
    share, per_m, per_rad = 0.02, 0.02, 0.01
    ends_m, headings_rad = [], []
    for seed in range(24):
        settings = SimParameters(
            seed=seed,
            difficulty="easy",
            drift_share_per_m=share,
            drift_rad_per_m=per_m,
            drift_rad_per_rad=per_rad,
        )
        with Simulation(settings) as simulation:
            simulation.drive.replace_obstacles(Obstacles((), simulation.home.bounds.grown(5.0)))
            start = simulation.drive.pose
            square(simulation)
            told = simulation.odometry()
            assert told.frame_id == "odom"
            assert simulation.drive.pose.distance_m(start) < 1e-9
            ends_m.append(told.pose.distance_m(start))
            headings_rad.append(start.turn_rad(told.pose))
            corrected = simulation.map_from_odom()
            assert corrected != Pose2D(x_m=0.0, y_m=0.0)
    assert min(ends_m) > 1e-6
    way_m, turn_rad = 2.0, 2.0 * math.pi
    variance = per_m**2 * (way_m + (SYSTEMATIC * way_m) ** 2)
    variance += per_rad**2 * (turn_rad + (SYSTEMATIC * turn_rad) ** 2)
    assert 0.6 < np.sqrt(np.mean(np.square(headings_rad)) / variance) < 1.5
    # A heading that is off by so much takes the far corner with it.
    assert max(ends_m) < 4.0 * (share * math.sqrt(way_m) + way_m * math.sqrt(variance))


# What does not go as it should.


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


# Homes.


def test_a_scene_file_is_the_home(tmp_path: Path) -> None:
    scene = dataclasses.replace(generate_scene(7), name="mine", seed=None)
    write_scene(scene, tmp_path / "mine.yaml")
    with Simulation(SimParameters(scene=str(tmp_path / "mine.yaml"), seed=3)) as simulation:
        assert simulation.home.name == "mine"
        assert simulation.episode().home == "mine"
        assert simulation.drive.pose == scene.start
    with pytest.raises(BadFileError, match="nowhere.yaml"):
        Simulation(SimParameters(scene=str(tmp_path / "nowhere.yaml")))
    (tmp_path / "bad.yaml").write_text("format: robustnav scene\nversion: 1\nrooms: 7\n")
    with pytest.raises(BadSceneError, match=r"bad.yaml', line 3: 'rooms' must be a list"):
        Simulation(SimParameters(scene=str(tmp_path / "bad.yaml")))


def test_parameters_decide_the_home() -> None:
    for difficulty, numbers in (("easy", {1}), ("medium", {3, 4}), ("hard", set(range(6, 11)))):
        with Simulation(SimParameters(seed=2, difficulty=difficulty)) as simulation:
            assert len(simulation.home.rooms) in numbers
    with Simulation(SimParameters(seed=2, rooms=2, objects=9, look_alikes="book")) as simulation:
        assert len(simulation.home.rooms) == 2
        assert len(simulation.home.objects) == 9
        assert sum(thing.label == "book" for thing in simulation.home.objects) >= 3
    with pytest.raises(BadSceneError, match=r"holds 4\.\.80 objects, not 3"):
        Simulation(SimParameters(objects=3))
    with pytest.raises(BadSceneError, match="^no class of objects is called 'dragon'"):
        Simulation(SimParameters(look_alikes="dragon"))


def test_every_parameter_is_described() -> None:
    assert build(SimParameters, {}) == SimParameters()
    assert all(spec.description for spec in specs(SimParameters))


def test_stamps_and_frames(fresh: Simulation) -> None:
    fresh.step()
    shot = shoot(fresh)
    assert shot.color is not None
    assert shot.depth is not None
    assert shot.visible is not None
    parts = (shot.color, shot.depth, shot.visible, shot.model)
    assert {part.stamp_ns for part in parts} == {fresh.now_ns}
    assert {part.frame_id for part in parts} == {"camera_optical_frame"}
    assert fresh.laser_scan().frame_id == "laser"
    assert (fresh.odometry().frame_id, fresh.odometry().child_frame_id) == ("map", "base_link")
    assert shot.color.pixels.shape == (240, 320, 3)
    assert shot.depth.depth_m.shape == (240, 320)


def test_the_episode_tells_what_decided_the_run(fresh: Simulation) -> None:
    episode = fresh.episode()
    assert episode.seed == 1
    assert set(episode.rooms) == {room.name for room in fresh.home.rooms}
    assert (episode.start_x_m, episode.start_y_m) == (fresh.home.start.x_m, fresh.home.start.y_m)


def test_closing_twice_is_harmless() -> None:
    simulation = Simulation(SimParameters(seed=0))
    simulation.close()
    simulation.close()

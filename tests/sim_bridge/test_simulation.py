"""Time, rates, homes, and that the same seed and commands give the same run."""

import dataclasses
from pathlib import Path

import pytest

from robustnav_msgs_py.errors import BadFileError, BadSceneError, RobustnavError
from robustnav_msgs_py.parameters import build, specs
from robustnav_msgs_py.values import Velocity
from sim_bridge.homes.generator import generate_scene
from sim_bridge.homes.scene_files.scene_file import write_scene
from sim_bridge.parameters import SimParameters
from sim_bridge.simulation import START_NS, Simulation
from tests.sim_bridge.simulated_runs import ALL, SMALL, FreePoses, shoot, told

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

"""Metrics of searches that are small enough to work out by hand."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader

from bags.definitions import message_definition
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.metrics import SearchMetrics, measure, path_length_m, search_metrics, spl
from bags.metrics_settings import MetricsSettings, settings_of
from bags.reader import open_bag
from bags.search_run import read_search
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Pose2D


def measured(path: Path, settings: MetricsSettings | None = None) -> SearchMetrics:
    with open_bag(path) as bag:
        return search_metrics(bag, settings=settings)


def test_a_straight_drive_along_a_corridor(search_bag: Callable[..., Path], corridor: Any) -> None:
    """The target lies 5.1 m ahead; the robot drives 4.2 m; after 3.3 m it was within 2 m, the first time."""
    metrics = measured(search_bag(corridor.flat, corridor.told))
    assert (metrics.found, metrics.success, metrics.phase) == (True, True, "found")
    assert metrics.steps == 14
    assert metrics.path_length_m == pytest.approx(4.2)
    assert metrics.shortest_path_m == pytest.approx(3.3)
    assert metrics.spl == pytest.approx(3.3 / 4.2)
    assert metrics.false_alarms == 0
    assert metrics.sim_duration_s == pytest.approx(7.0)
    assert metrics.wall_duration_s == pytest.approx(7.6, abs=0.1)


def test_a_run_in_lockstep_tells_nothing_of_the_walls_clock(search_bag: Callable[..., Path]) -> None:
    with open_bag(search_bag()) as bag:
        run, settings = read_search(bag), settings_of(bag.manifest)
    assert measure(run, settings).wall_duration_s is not None
    in_lockstep = measure(replace(run, lockstep=True), settings)
    assert in_lockstep.wall_duration_s is None
    assert in_lockstep.sim_duration_s == measure(run, settings).sim_duration_s


def test_the_distance_that_counts_as_success_can_be_chosen(
    search_bag: Callable[..., Path], corridor: Any
) -> None:
    bag = search_bag(corridor.flat, corridor.told)
    strict = measured(bag, MetricsSettings(success_distance_m=0.89))
    assert (strict.found, strict.success, strict.spl) == (True, False, 0.0)
    assert measured(bag, MetricsSettings(success_distance_m=0.91)).success


def test_saying_found_where_nothing_is_in_view_is_no_success(
    search_bag: Callable[..., Path], corridor: Any
) -> None:
    start, end = corridor.told.waypoints
    away = Pose2D(x_m=end.x_m, y_m=end.y_m, yaw_rad=math.pi)
    metrics = measured(search_bag(corridor.flat, replace(corridor.told, waypoints=(start, end, away))))
    assert (metrics.found, metrics.success, metrics.spl) == (True, False, 0.0)


def test_giving_up_is_no_success(search_bag: Callable[..., Path], corridor: Any) -> None:
    metrics = measured(search_bag(corridor.flat, replace(corridor.told, phase=SearchPhase.NOT_FOUND)))
    assert (metrics.found, metrics.success, metrics.spl, metrics.phase) == (False, False, 0.0, "not_found")


def test_false_alarms_count_once_for_each_pose(search_bag: Callable[..., Path], corridor: Any) -> None:
    target = next(item for item in corridor.flat.objects if item.label == "mug")
    alarms = (
        (2, target.x_m - 2.0, 0.45),
        (2, target.x_m - 2.2, 0.45),  # the same pose
        (3, target.x_m - 2.0, 0.45),
        (4, target.x_m - 0.7, 0.45),  # within 0.75 m of the truth
    )
    metrics = measured(search_bag(corridor.flat, replace(corridor.told, false_alarms=alarms)))
    assert metrics.false_alarms == 2
    nearer = MetricsSettings(false_alarm_distance_m=0.5)
    assert (
        measured(search_bag(corridor.flat, replace(corridor.told, false_alarms=alarms)), nearer).false_alarms
        == 3
    )


def test_a_search_that_ended_at_a_false_alarm_did_not_survive_it(
    search_bag: Callable[..., Path], corridor: Any
) -> None:
    objects = [replace(item, x_m=1.0, y_m=0.45) for item in corridor.flat.objects]
    told = replace(corridor.told, false_alarms=((2, 2.0, 0.45), (3, 5.9, 0.45)), ended_at=(5.9, 0.45))
    metrics = measured(search_bag(replace(corridor.flat, objects=objects), told))
    assert (metrics.found, metrics.success, metrics.false_alarms) == (True, False, 1)


def test_a_bag_without_ground_truth_tells_what_it_can(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "little", manifest=manifest) as writer:
        channel = writer.add_topic("/search/target", message_definition("std_msgs/msg/String", ()))
        writer.write(channel, log_time_ns=10, publish_time_ns=10, data=b"\0\1\0\0\4\0\0\0mug\0")
    metrics = measured(tmp_path / "little")
    assert metrics.target == "mug"
    unknown = (
        metrics.phase,
        metrics.found,
        metrics.success,
        metrics.steps,
        metrics.path_length_m,
        metrics.spl,
    )
    assert unknown == (None,) * 6
    assert (metrics.shortest_path_m, metrics.false_alarms, metrics.sim_duration_s) == (None, None, None)


def test_a_bag_without_a_search_is_refused(tmp_path: Path, manifest: Manifest) -> None:
    BagWriter(tmp_path / "none", manifest=manifest).close()
    with pytest.raises(BadFileError, match="holds no search"):
        measured(tmp_path / "none")


def test_a_search_that_is_not_there_is_refused(search_bag: Callable[..., Path], corridor: Any) -> None:
    with (
        open_bag(search_bag(corridor.flat, corridor.told)) as bag,
        pytest.raises(BadFileError, match=r"no search number 5; it holds \[1\]"),
    ):
        search_metrics(bag, episode=5)


def test_a_killed_run_is_measured_up_to_where_it_was_cut(
    search_bag: Callable[..., Path], corridor: Any
) -> None:
    folder = search_bag(corridor.flat, corridor.told, chunk_bytes=4000)
    (file,) = folder.glob("*.mcap")
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    chunks = summary.chunk_indexes
    file.write_bytes(file.read_bytes()[: chunks[len(chunks) // 2].chunk_start_offset])
    metrics = measured(folder)
    assert (metrics.phase, metrics.found, metrics.success) == ("searching", False, False)
    assert 0.0 < (metrics.path_length_m or 0.0) < 4.2


# Places on a grid: what is moved is nothing or well above the noise, so that jitter decides nothing.
ON_GRID_M = st.integers(-100, 100).map(lambda number: 0.05 * number)


@given(st.lists(st.tuples(ON_GRID_M, ON_GRID_M), min_size=1, max_size=30))
def test_a_path_is_no_shorter_than_the_straight_line_and_jitter_adds_nothing(
    places: list[tuple[float, float]],
) -> None:
    poses = [Pose2D(x_m=x_m, y_m=y_m) for x_m, y_m in places]
    length_m = path_length_m(poses, noise_m=0.02)
    assert length_m is not None
    assert length_m >= poses[0].distance_m(poses[-1]) - 0.02
    jittered = [Pose2D(x_m=p.x_m + d, y_m=p.y_m) for p in poses for d in (0.0, 0.001, -0.001)]
    assert path_length_m([poses[0], *jittered], noise_m=0.02) == pytest.approx(
        length_m, abs=0.003 * len(poses)
    )


@given(st.none() | st.booleans(), st.none() | st.floats(0, 1e3), st.none() | st.floats(0, 1e3))
def test_spl_lies_in_0_to_1_and_is_0_without_success(
    success: bool | None, walked_m: float | None, shortest_m: float | None
) -> None:
    value = spl(success, walked_m, shortest_m)
    if success is None:
        assert value is None
    elif not success:
        assert value == 0.0
    elif walked_m is None or shortest_m is None:
        assert value is None
    else:
        assert value is not None
        assert 0.0 <= value <= 1.0


def test_a_bag_tells_the_camera_and_the_search_space_of_its_run(manifest: Manifest) -> None:
    def node(name: str, **parameters: float | str) -> NodeParameters:
        told = tuple(NamedParameter(name=key, value=value) for key, value in parameters.items())
        return NodeParameters(node=name, parameters=told)

    grown = manifest.with_node(node("/robot1/planner", spacing_m=0.5, headings=8, variant="pomp"))
    grown = grown.with_node(node("/robot1/belief", camera_height_m=0.4, spacing_m=0.1))
    settings = settings_of(grown, "/robot1")
    assert (settings.space.spacing_m, settings.space.headings) == (0.5, 8)
    assert (settings.mount.z_m, settings.mount.x_m) == (0.4, 0.1)
    assert settings_of(grown) == settings_of(None) == MetricsSettings()

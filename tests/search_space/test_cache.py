import os
from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.search_space import cache as cache_module
from robustnav_nodes.search_space.cache import ObservabilityCache, cached_search_space, user_cache_folder
from robustnav_nodes.search_space.observability import build_observability
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.space import SearchSpace

START = Pose2D(x_m=1.0, y_m=1.0)


@pytest.fixture
def cache(tmp_path) -> ObservabilityCache:
    """One that keeps also the tables of the small maps drawn here."""
    return ObservabilityCache(folder=tmp_path / "cache", min_sights=0)


@pytest.fixture
def builds(monkeypatch) -> list[int]:
    """Grows by the number of poses with each table that is built, not read."""
    poses: list[int] = []

    def counted(view, graph, parameters):
        poses.append(len(graph))
        return build_observability(view, graph, parameters)

    monkeypatch.setattr(cache_module, "build_observability", counted)
    return poses


def built_by(cache, drawn, parameters, start=START) -> SearchSpace:
    return SearchSpace.build(*drawn, parameters, start, cache.observability)


def the_file(cache: ObservabilityCache) -> Path:
    (path,) = cache.folder.iterdir()
    return path


def assert_same(one: SearchSpace, other: SearchSpace) -> None:
    for name in ("seen_start", "seen", "seers_start", "seers"):
        ours, theirs = getattr(one.observability, name), getattr(other.observability, name)
        np.testing.assert_array_equal(ours, theirs)
        assert ours.dtype == theirs.dtype


def test_a_table_is_built_once_and_read_the_same(cache, builds, two_rooms, parameters):
    first = built_by(cache, two_rooms, parameters)
    second = built_by(cache, two_rooms, parameters)
    assert len(builds) == 1
    assert_same(first, second)
    assert_same(second, SearchSpace.build(*two_rooms, parameters, START))


def test_another_start_in_the_same_part_of_the_floor_is_the_same_table(cache, builds, two_rooms, parameters):
    built_by(cache, two_rooms, parameters)
    built_by(cache, two_rooms, parameters, Pose2D(x_m=1.5, y_m=1.6))
    assert len(builds) == 1


@pytest.mark.parametrize(
    "change",
    [
        {"range_max_m": 3.9},
        {"range_min_m": 0.4},
        {"camera_forward_m": 0.1},
        {"horizontal_view_rad": 1.0},
        {"spacing_m": 0.25},
        {"headings": 8},
        {"robot_radius_m": 0.25},
        {"candidate_size_m": 0.3},
        {"max_observability_mb": 100},
    ],
)
def test_what_decides_the_table_makes_another_one(cache, builds, two_rooms, parameters, change):
    built_by(cache, two_rooms, parameters)
    values = {name: getattr(parameters, name) for name in parameters.__slots__}
    changed = SearchSpaceParameters(**(values | change))
    assert_same(built_by(cache, two_rooms, changed), SearchSpace.build(*two_rooms, changed, START))
    assert len(builds) == 2


def test_what_does_not_decide_the_table_makes_no_other(cache, builds, two_rooms, parameters):
    built_by(cache, two_rooms, parameters)
    values = {name: getattr(parameters, name) for name in parameters.__slots__}
    built_by(cache, two_rooms, SearchSpaceParameters(**(values | {"mask_wait_s": 9.0, "max_poses": 10_000})))
    assert len(builds) == 1


def test_one_more_wall_is_another_map(cache, builds, drawn, parameters):
    built_by(cache, drawn("........", ".......o", "........"), parameters, None)
    built_by(cache, drawn("...#....", ".......o", "........"), parameters, None)
    assert len(builds) == 2


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def flip_a_bit(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def pickled(path: Path) -> None:
    np.savez(path, seen_start=np.array([{}], dtype=object), seen=np.zeros(0, dtype=np.int32))


def of_another_graph(path: Path) -> None:
    np.savez(path, seen_start=np.array([0, 1]), seen=np.zeros(1, dtype=np.int32))


def of_candidates_that_are_not_there(path: Path) -> None:
    with np.load(path) as file:
        seen_start, seen = file["seen_start"], file["seen"]
    np.savez(path, seen_start=seen_start, seen=seen + np.int32(100_000))


def of_one_array(path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, np.zeros(3))


@pytest.mark.parametrize(
    "spoil",
    [
        cut,
        flip_a_bit,
        pickled,
        of_another_graph,
        of_candidates_that_are_not_there,
        of_one_array,
        lambda path: path.write_bytes(b""),
        lambda path: path.write_text("not a table"),
    ],
)
def test_a_file_that_is_no_such_table_is_written_anew(cache, builds, two_rooms, parameters, spoil):
    good = built_by(cache, two_rooms, parameters)
    path = the_file(cache)
    spoil(path)
    assert_same(built_by(cache, two_rooms, parameters), good)
    assert len(builds) == 2
    built_by(cache, two_rooms, parameters)
    assert len(builds) == 2
    assert the_file(cache) == path


def test_tables_used_longest_ago_make_room(cache, two_rooms, parameters):
    spaces = [SearchSpaceParameters(range_max_m=range_m) for range_m in (3.0, 3.1, 3.2)]
    files: list[Path] = []
    for age_s, space in zip((300, 200), spaces, strict=False):
        built_by(cache, two_rooms, space)
        files += [path for path in cache.folder.iterdir() if path not in files]
        os.utime(files[-1], (1e9 - age_s, 1e9 - age_s))
    built_by(cache, two_rooms, spaces[0])  # read, so used most lately
    room_for_two = 1.1 * sum(path.stat().st_size for path in files)
    small = ObservabilityCache(folder=cache.folder, limit_bytes=int(room_for_two), min_sights=0)
    built_by(small, two_rooms, spaces[2])
    left = set(cache.folder.iterdir())
    assert len(left) == 2
    assert files[0] in left
    assert files[1] not in left


def test_only_tables_are_removed_to_make_room(cache, two_rooms, parameters):
    cache.folder.mkdir()
    (cache.folder / "notes.txt").write_text("mine")
    none = ObservabilityCache(folder=cache.folder, limit_bytes=1, min_sights=0)
    built_by(none, two_rooms, parameters)
    assert the_file(cache).name == "notes.txt"


def test_small_tables_are_not_kept(tmp_path, two_rooms, parameters):
    cached_search_space(*two_rooms, parameters, START, tmp_path / "cache")
    assert not (tmp_path / "cache").exists()


def test_a_folder_that_cannot_be_written_stops_nothing(tmp_path, two_rooms, parameters):
    (tmp_path / "file").write_text("")
    cache = ObservabilityCache(folder=tmp_path / "file", min_sights=0)
    assert_same(built_by(cache, two_rooms, parameters), SearchSpace.build(*two_rooms, parameters, START))


def test_without_a_folder_nothing_is_kept(two_rooms, parameters):
    space = cached_search_space(*two_rooms, parameters, START, None)
    assert_same(space, SearchSpace.build(*two_rooms, parameters, START))


@pytest.mark.parametrize(
    ("environ", "folder"),
    [
        ({"XDG_CACHE_HOME": "/var/cache"}, Path("/var/cache/robustnav")),
        ({"XDG_CACHE_HOME": "here"}, Path("/home/me/.cache/robustnav")),
        ({}, Path("/home/me/.cache/robustnav")),
    ],
)
def test_the_folder_is_where_the_user_keeps_caches(monkeypatch, environ, folder):
    monkeypatch.setenv("HOME", "/home/me")
    assert user_cache_folder(environ) == folder

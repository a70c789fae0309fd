"""Generated homes hold together, whatever the seed and the difficulty."""

from collections import Counter
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import OccupancyMap
from sim_bridge.homes.build import build_home
from sim_bridge.homes.floor_plan import FREE, OCCUPIED, RESOLUTION_M, UNKNOWN, candidate_mask, floor_plan
from sim_bridge.homes.generator import generate_home, generate_scene
from sim_bridge.homes.home import Home
from sim_bridge.homes.objects.catalogue import LABELS
from sim_bridge.homes.objects.look_alikes import MIN_ALIKE
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.rooms.room_programmes import Difficulty
from sim_bridge.homes.scene import Scene
from sim_bridge.homes.scene_files.scene_file import parse_scene, scene_text
from sim_bridge.homes.shapes import extent

# 48 homes, the hard ones of every number of rooms; and where there is time, 200 of each difficulty.
SEEDS = {
    Difficulty.EASY: range(20),
    Difficulty.MEDIUM: range(20),
    Difficulty.HARD: (0, 1, 4, 11, 14, 16, 21, 23),
}
MORE_SEEDS = dict.fromkeys(Difficulty, range(200))
ROOMS = {Difficulty.EASY: {1}, Difficulty.MEDIUM: {3, 4}, Difficulty.HARD: set(range(6, 11))}
PLANNERS_RADIUS_M = 0.18
# Rings on a hob and cushions may end this far below the height where objects stand.
SUNK_M = 0.013
NARROWEST_DOOR_M = 0.9
# So much of an object's footprint has something below it; between two cushions is a seam.
HELD_SHARE = 0.75

Sample = tuple[Difficulty, Scene, Home]


@pytest.fixture(
    scope="module", params=[SEEDS, pytest.param(MORE_SEEDS, marks=pytest.mark.slow)], ids=["48", "600"]
)
def samples(request: pytest.FixtureRequest) -> list[Sample]:
    found = []
    for difficulty, seeds in request.param.items():
        for seed in seeds:
            scene = generate_scene(seed, difficulty=difficulty)
            found.append((difficulty, scene, build_home(scene)))
    return found


def cell_at(grid: OccupancyMap, x_m: float, y_m: float) -> tuple[int, int]:
    """The row and column of the cell that holds a point."""
    return int((y_m - grid.origin.y_m) / RESOLUTION_M), int((x_m - grid.origin.x_m) / RESOLUTION_M)


def window(grid: OccupancyMap, area: Rect) -> tuple[slice, slice]:
    """The cells whose middles lie in an area."""
    low = np.array((area.y_min_m - grid.origin.y_m, area.x_min_m - grid.origin.x_m)) / RESOLUTION_M
    high = np.array((area.y_max_m - grid.origin.y_m, area.x_max_m - grid.origin.x_m)) / RESOLUTION_M
    (row, column), (rows, columns) = np.ceil(low - 0.5).astype(int), np.ceil(high - 0.5).astype(int)
    return slice(row, rows), slice(column, columns)


def covered_by(grid: OccupancyMap, areas: list[Rect]) -> NDArray[np.bool_]:
    """The cells whose middles lie in one of the areas."""
    covered = np.zeros(grid.cells.shape, dtype=bool)
    for area in areas:
        covered[window(grid, area)] = True
    return covered


def shared_m2(one: Rect, other: Rect) -> float:
    """The area that two rectangles have in common."""
    width_m = min(one.x_max_m, other.x_max_m) - max(one.x_min_m, other.x_min_m)
    depth_m = min(one.y_max_m, other.y_max_m) - max(one.y_min_m, other.y_min_m)
    return max(0.0, width_m) * max(0.0, depth_m)


def test_each_difficulty_has_its_numbers_of_rooms(samples: list[Sample]) -> None:
    for difficulty, numbers in ROOMS.items():
        assert {len(home.rooms) for other, _, home in samples if other is difficulty} == numbers
    for _, _, home in samples:
        names = [room.name for room in home.rooms]
        assert len(set(names)) == len(names)


def test_the_whole_free_floor_is_reached_from_the_start(samples: list[Sample]) -> None:
    for _, _, home in samples:
        plan = floor_plan(home)
        # From the middle of a cell to the edge of the nearest one that is not free, at most a little less.
        clearance = ndimage.distance_transform_edt(plan.cells == FREE) * RESOLUTION_M - RESOLUTION_M / 2
        parts, _ = ndimage.label(clearance >= PLANNERS_RADIUS_M)
        start = parts[cell_at(plan, home.start.x_m, home.start.y_m)]
        assert start > 0
        reached = parts == start
        assert reached.sum() >= 0.995 * (parts > 0).sum(), home.name
        for room in home.rooms:
            assert reached[window(plan, room.inside)].sum() > 50, (home.name, room.name)
        for piece in home.furniture:
            near = reached[window(plan, piece.footprint.grown(0.5))]
            assert not piece.carries or near.any(), (home.name, piece.name)


def test_nothing_overlaps(samples: list[Sample]) -> None:
    for _, _, home in samples:
        low_walls = [wall.base for wall in home.walls if wall.z_min_m == 0.0]
        for one, other in combinations(low_walls, 2):
            assert not one.overlaps(other), home.name
        for piece in home.furniture:
            assert not any(piece.footprint.overlaps(wall) for wall in low_walls), (home.name, piece.name)
        for one, other in combinations(home.furniture, 2):
            assert not one.footprint.overlaps(other.footprint), (home.name, one.name, other.name)


def test_doors_stay_open(samples: list[Sample]) -> None:
    for _, _, home in samples:
        low_walls = [wall.base for wall in home.walls if wall.z_min_m == 0.0]
        for door in home.doors:
            assert door.width_m >= NARROWEST_DOOR_M - 1e-9
            assert not any(door.opening.overlaps(wall) for wall in low_walls), home.name
            assert not any(door.opening.overlaps(piece.footprint) for piece in home.furniture), home.name


def test_no_object_is_inside_another_or_in_a_wall(samples: list[Sample]) -> None:
    for _, _, home in samples:
        low_walls = [wall for wall in home.walls if wall.z_min_m == 0.0]
        spans = [(thing, thing.footprint, thing.z_m, thing.z_m + thing.size_m[2]) for thing in home.objects]
        for (one, floor, low_m, high_m), (other, other_floor, other_low_m, other_high_m) in combinations(
            spans, 2
        ):
            meet = low_m < other_high_m - 1e-6 and other_low_m < high_m - 1e-6 and floor.overlaps(other_floor)
            assert not meet, (home.name, one.label, one.furniture, other.label, other.furniture)
        for thing, floor, _, _ in spans:
            assert not any(floor.overlaps(wall.base) for wall in low_walls), (home.name, thing.label)


def test_no_object_reaches_into_the_furniture_that_carries_it(samples: list[Sample]) -> None:
    for _, _, home in samples:
        pieces = {piece.name: piece for piece in home.furniture}
        for thing in home.objects:
            piece = pieces[thing.furniture]
            for part in piece.parts:
                low, high = extent((part,))
                area = piece.in_map(Rect(x_min_m=low[0], y_min_m=low[1], x_max_m=high[0], y_max_m=high[1]))
                above = thing.z_m < high[2] - SUNK_M and low[2] < thing.z_m + thing.size_m[2]
                assert not (above and area.overlaps(thing.footprint)), (home.name, thing.label, piece.name)


def test_nothing_floats(samples: list[Sample]) -> None:
    for _, _, home in samples:
        pieces = {piece.name: piece for piece in home.furniture}
        rooms = {room.name: room for room in home.rooms}
        for thing in home.objects:
            piece = pieces[thing.furniture]
            assert piece.room == thing.room
            if piece.surfaces[thing.surface].hangs:
                inside = rooms[thing.room].inside.grown(-0.03)
                assert not inside.contains(thing.footprint), (home.name, thing.label)
                continue
            # What the object stands on is there: parts of the furniture end at that height below it.
            held_m2 = 0.0
            for part in piece.parts:
                low, high = extent((part,))
                if -SUNK_M <= high[2] - thing.z_m <= 0.002:
                    area = Rect(x_min_m=low[0], y_min_m=low[1], x_max_m=high[0], y_max_m=high[1])
                    held_m2 += shared_m2(piece.in_map(area), thing.footprint)
            share = held_m2 / thing.footprint.area_m2
            assert share >= HELD_SHARE, (home.name, thing.label, piece.name, share)


def test_every_object_is_in_a_candidate_cell(samples: list[Sample]) -> None:
    for _, _, home in samples:
        mask = candidate_mask(home)
        for thing in home.objects:
            x_m, y_m, _ = thing.centre_m
            assert mask.cells[cell_at(mask, x_m, y_m)] == OCCUPIED, (home.name, thing.label, thing.furniture)


def test_the_mask_is_what_carries_and_nothing_else(samples: list[Sample]) -> None:
    for _, _, home in samples:
        mask, plan = candidate_mask(home), floor_plan(home)
        assert mask.cells.shape == plan.cells.shape
        assert mask.origin == plan.origin
        carriers = [piece for piece in home.furniture if piece.carries]
        strips = [p.in_map(place.area) for p in carriers for place in p.surfaces if place.hangs]
        carried = covered_by(mask, [piece.footprint for piece in carriers])
        assert (mask.cells[carried] == OCCUPIED).all()
        assert (plan.cells[carried] == OCCUPIED).all()
        # All else that is candidate touches a strip of wall where things hang.
        rest = (mask.cells == OCCUPIED) & ~carried
        hung = covered_by(mask, [strip.grown(RESOLUTION_M / 2 + 1e-6) for strip in strips])
        assert not (rest & ~hung).any(), home.name
        tall = covered_by(mask, [piece.footprint for piece in home.furniture if piece.tall])
        assert not (tall & carried).any()


def test_the_plan_is_the_home(samples: list[Sample]) -> None:
    for _, _, home in samples:
        plan = floor_plan(home)
        occupied = covered_by(plan, list(home.solid()))
        floor = covered_by(plan, [room.inside for room in home.rooms] + [door.opening for door in home.doors])
        assert (plan.cells[occupied] == OCCUPIED).all(), home.name
        assert (plan.cells[floor & ~occupied] == FREE).mean() > 0.999, home.name
        assert (plan.cells[~floor & ~occupied] == UNKNOWN).all(), home.name


def test_homes_show_most_kinds_of_furniture_and_of_objects(samples: list[Sample]) -> None:
    kinds = Counter(piece.kind for _, _, home in samples for piece in home.furniture)
    labels = Counter(thing.label for _, _, home in samples for thing in home.objects)
    assert len(kinds) >= 25
    assert len(labels) >= 30
    for difficulty in Difficulty:
        of_it = [home for other, _, home in samples if other is difficulty]
        assert len({thing.label for home in of_it for thing in home.objects}) >= 30
        assert all(home.labels == LABELS for home in of_it)


def test_each_object_can_be_told_from_the_others(samples: list[Sample]) -> None:
    for _, _, home in samples:
        assert [thing.instance for thing in home.objects] == list(range(len(home.objects)))
        said = Counter(thing.attributes for thing in home.objects)
        assert max(said.values()) == 1, (home.name, said.most_common(1))


def test_the_same_seed_gives_the_same_home(samples: list[Sample]) -> None:
    for difficulty, _, home in samples[::15]:
        assert home.seed is not None
        assert generate_home(home.seed, difficulty=difficulty) == home
    assert generate_home(11) != generate_home(12)


def test_a_scene_file_gives_the_same_home(samples: list[Sample]) -> None:
    for _, scene, home in samples[::4]:
        assert build_home(parse_scene(scene_text(scene), home.name)) == home, home.name


def test_numbers_are_kept_and_bad_ones_refused() -> None:
    home = generate_home(5, rooms=4, objects=24)
    assert (len(home.rooms), len(home.objects)) == (4, 24)
    assert len(generate_home(1, rooms=1, objects=4).objects) == 4
    assert len(generate_home(0, rooms=10, objects=80).rooms) == 10
    for wrong in ({"rooms": 0}, {"rooms": 11}, {"objects": 3}, {"objects": 81}):
        with pytest.raises(BadSceneError, match=r"a home h.* not \d+"):
            generate_home(5, **wrong)
    with pytest.raises(BadSceneError, match="must not be negative, not -1"):
        generate_home(-1)
    with pytest.raises(BadSceneError, match="^no class of objects is called 'mugg'; do you mean 'mug'"):
        generate_home(1, look_alikes="mugg")


@pytest.mark.parametrize("label", ["mug", "book", "picture", "shoe"])
def test_look_alikes_are_several_and_still_distinguishable(label: str) -> None:
    for seed in range(6):
        for difficulty in (Difficulty.EASY, Difficulty.MEDIUM):
            home = generate_home(seed, difficulty=difficulty, look_alikes=label)
            alike = [thing for thing in home.objects if thing.label == label]
            assert len(alike) >= MIN_ALIKE, (seed, difficulty)
            assert len({thing.attributes for thing in alike}) == len(alike)

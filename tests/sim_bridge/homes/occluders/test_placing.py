"""Things moved in hide something and shut nobody out, whatever the seed."""

from itertools import product

import numpy as np
import pytest

from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furniture.furnishing import PASSAGE_RADII_M
from sim_bridge.homes.home import Furniture, Home
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.occluders.designs import DESIGNS
from sim_bridge.homes.occluders.placing import START_FREE_M, place_occluders
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene_check import REACH_M
from sim_bridge.homes.shapes import extent

COUNT = 5


@pytest.fixture(scope="module")
def moved_in(homes: list[Home]) -> list[tuple[Home, tuple[Furniture, ...]]]:
    return [(home, place_occluders(np.random.default_rng(home.seed), home, COUNT)) for home in homes]


Moved = list[tuple[Home, tuple[Furniture, ...]]]


def test_as_many_as_asked_for_find_a_place(moved_in: Moved, homes: list[Home]) -> None:
    counts = [len(things) for _, things in moved_in]
    # A small room may be full before.
    in_several_rooms = [len(things) for home, things in moved_in if len(home.rooms) > 2]
    assert np.mean(in_several_rooms) > 0.9 * COUNT
    assert np.mean(counts) > 0.7 * COUNT
    assert place_occluders(np.random.default_rng(0), homes[0], 0) == ()


def test_the_floor_stays_in_one_piece(moved_in: Moved) -> None:
    for home, things in moved_in:
        grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
        grid = grid.with_rects([thing.footprint for thing in things])
        for radius_m in PASSAGE_RADII_M:
            assert grid.regions(radius_m) == 1, home.name


def test_the_robot_still_gets_to_every_carrier_of_a_crowded_home(homes: list[Home]) -> None:
    for at, home in enumerate(homes[::2]):
        things = place_occluders(np.random.default_rng(at), home, 8)
        grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
        grid = grid.with_rects([thing.footprint for thing in things])
        rows, columns = np.nonzero(grid.cells_m >= max(PASSAGE_RADII_M))
        points = list(zip(grid.x_m[columns].tolist(), grid.y_m[rows].tolist(), strict=True))
        for piece in home.furniture:
            near = piece.footprint.grown(REACH_M)
            assert not piece.carries or any(near.holds(*point) for point in points), piece.name


def test_the_start_is_free(moved_in: Moved) -> None:
    for home, things in moved_in:
        footprints = [thing.footprint for thing in things]
        obstacles = Obstacles(footprints, home.bounds.grown(START_FREE_M))
        assert obstacles.clearance_m(home.start.x_m, home.start.y_m) >= START_FREE_M


def test_they_stand_in_rooms_and_overlap_nothing(moved_in: Moved) -> None:
    for home, things in moved_in:
        others: list[Rect] = [piece.footprint for piece in home.furniture]
        others += [door.opening for door in home.doors]
        for thing in things:
            assert any(room.inside.contains(thing.footprint) for room in home.rooms), thing.name
            assert not any(thing.footprint.overlaps(other) for other in others), thing.name
            others.append(thing.footprint)
        assert len({thing.name for thing in things}) == len(things)


def crosses(rect: Rect, start_m: tuple[float, float], end_m: tuple[float, float]) -> bool:
    shares = np.linspace(0.0, 1.0, 60)
    points = [
        (start_m[0] + s * (end_m[0] - start_m[0]), start_m[1] + s * (end_m[1] - start_m[1])) for s in shares
    ]
    return any(rect.holds(*point) for point in points)


def test_most_stand_between_a_rooms_middle_and_what_carries_objects(moved_in: Moved) -> None:
    hides = []
    for home, things in moved_in:
        rooms = {room.name: room.inside.centre_m for room in home.rooms}
        carriers = [piece for piece in home.furniture if piece.carries]
        hides += [
            any(crosses(thing.footprint, rooms[piece.room], (piece.x_m, piece.y_m)) for piece in carriers)
            for thing in things
        ]
    assert np.mean(hides) > 0.5


def test_the_same_chance_gives_the_same_things(homes: list[Home]) -> None:
    once, again, other = (place_occluders(np.random.default_rng(seed), homes[1], 3) for seed in (1, 1, 2))
    assert once == again
    assert once != other


def test_designs_lie_within_their_size() -> None:
    for seed, design in product(range(100), DESIGNS):
        made = design(np.random.default_rng(seed))
        low, high = extent(made.parts)
        half_x, half_y = made.size_m[0] / 2.0, made.size_m[1] / 2.0
        assert low[0] >= -half_x - 1e-9
        assert low[1] >= -half_y - 1e-9
        assert high[0] <= half_x + 1e-9
        assert high[1] <= half_y + 1e-9
        assert low[2] == pytest.approx(0.0, abs=0.005)
        assert high[2] == pytest.approx(made.size_m[2], abs=1e-9)
        for length_m in made.size_m[:2]:
            assert length_m / RESOLUTION_M == pytest.approx(round(length_m / RESOLUTION_M))


def test_all_kinds_come(moved_in: Moved) -> None:
    kinds = {thing.kind for _, things in moved_in for thing in things}
    assert kinds == {"cardboard boxes", "suitcase", "clothes rack", "folding screen"}

"""Drawn homes: rooms that fit their kind, doors that lead where they should, windows that see out."""

from functools import cache
from itertools import combinations

import numpy as np
import pytest

from sim_bridge.homes.rect import Rect, snapped
from sim_bridge.homes.rooms.floor_layout import FloorLayout, lay_out
from sim_bridge.homes.rooms.ground_plan import MAY_LIE_INSIDE, meets
from sim_bridge.homes.rooms.room_programmes import draw_programme
from sim_bridge.homes.rooms.wall_lines import outer_stretches, shared_stretch
from sim_bridge.homes.rooms.walls import build_shell
from sim_bridge.homes.scene import SceneRoom

COUNTS = range(1, 11)
SEEDS = range(12)
WALL_M = 0.10
CLOSED = ("bathroom", "bedroom", "children's room", "laundry room", "storage room")


@cache
def _layout(seed: int, room_count: int) -> FloorLayout:
    rng = np.random.default_rng(seed)
    return lay_out(rng, draw_programme(rng, room_count))


@pytest.fixture(params=COUNTS)
def layouts(request: pytest.FixtureRequest) -> list[FloorLayout]:
    return [_layout(seed, request.param) for seed in SEEDS]


def _kinds(layout: FloorLayout) -> dict[str, str]:
    return {room.name: room.kind for room in layout.rooms}


def _beside(layout: FloorLayout, name: str) -> set[str]:
    """The kinds of the rooms onto which a room opens."""
    kinds = _kinds(layout)
    return {kinds[a if b == name else b] for a, b in (door.rooms for door in layout.doors) if name in (a, b)}


def _areas_beside(layout: FloorLayout, room: SceneRoom) -> list[Rect]:
    return [other.area for other in layout.rooms if other is not room]


def test_rooms_fill_a_rectangle_and_lie_on_the_grid(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        areas = [room.area for room in layout.rooms]
        width_m, depth_m = max(a.x_max_m for a in areas), max(a.y_max_m for a in areas)
        assert sum(area.area_m2 for area in areas) == pytest.approx(width_m * depth_m)
        assert min(a.x_min_m for a in areas) == min(a.y_min_m for a in areas) == 0.0
        assert not any(a.overlaps(b) for a, b in combinations(areas, 2))
        for area in areas:
            lines = (area.x_min_m, area.y_min_m, area.x_max_m, area.y_max_m)
            assert all(line == snapped(line) for line in lines)


@pytest.mark.parametrize("room_count", COUNTS)
def test_every_room_is_as_its_kind_needs_it(room_count: int) -> None:
    for seed in SEEDS:
        programme = draw_programme(np.random.default_rng(seed), room_count)
        for wanted, room in zip(programme, _layout(seed, room_count).rooms, strict=True):
            assert (wanted.name, wanted.kind) == (room.name, room.kind)
            assert meets(room.area, wanted.needs), room


def test_rooms_are_reached_without_passing_through_closed_ones(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        kinds = _kinds(layout)
        start = next((room.name for room in layout.rooms if room.kind not in CLOSED), layout.rooms[0].name)
        reached = [start]
        for name in reached:
            if kinds[name] in CLOSED and name != start:
                continue
            doors = [door.rooms for door in layout.doors if name in door.rooms]
            reached += [other for pair in doors for other in pair if other not in reached]
        for room in layout.rooms:
            en_suite = room.name == "bathroom 2" and "bedroom" in _beside(layout, room.name)
            assert room.name in reached or en_suite


def test_the_hallway_serves_most_rooms(layouts: list[FloorLayout]) -> None:
    for layout in (layout for layout in layouts if len(layout.rooms) >= 5):
        served = {name for door in layout.doors if "hallway" in door.rooms for name in door.rooms}
        assert 2 * (len(served) - 1) > len(layout.rooms) - 1
        assert "hallway" in _beside(layout, "bathroom")


def test_kitchen_dining_room_and_bathroom_open_where_they_should(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        kinds = set(_kinds(layout).values())
        for room in layout.rooms:
            if room.kind == "bathroom":
                assert "kitchen" not in _beside(layout, room.name)
            if room.kind == "dining room":
                assert _beside(layout, room.name) & {"kitchen", "living room"}
            if room.kind == "kitchen" and kinds & {"living room", "dining room"}:
                assert _beside(layout, room.name) & {"living room", "dining room"}


def test_doors_keep_their_distance_from_corners(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        areas = {room.name: room.area for room in layout.rooms}
        for door in layout.doors:
            stretch = shared_stretch(areas[door.rooms[0]], areas[door.rooms[1]])
            assert stretch
            assert door.width_m in (0.90, 0.95, 1.00)
            middle_m, line_m = (door.x_m, door.y_m) if stretch.along_x else (door.y_m, door.x_m)
            assert line_m == stretch.line_m
            assert middle_m - door.width_m / 2.0 >= stretch.low_m + WALL_M / 2.0 + 0.35 - 1e-6
            assert middle_m + door.width_m / 2.0 <= stretch.high_m - WALL_M / 2.0 - 0.35 + 1e-6
            assert middle_m - door.width_m / 2.0 == pytest.approx(snapped(middle_m - door.width_m / 2.0))


def test_windows_are_in_outer_walls_away_from_corners(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        rooms = {room.name: room for room in layout.rooms}
        for window in layout.windows:
            room = rooms[window.room]
            assert room.kind not in ("hallway", "storage room")
            bathroom = room.kind == "bathroom"
            narrowest_m, widest_m = (0.6, 0.9) if bathroom else (1.0, 1.8)
            assert narrowest_m - 1e-6 <= window.to_m - window.from_m <= widest_m + 1e-6
            assert window.sill_m == (1.4 if bathroom else 0.9)
            assert any(
                stretch.low_m + 0.45 - 1e-6 <= window.from_m and window.to_m <= stretch.high_m - 0.45 + 1e-6
                for stretch in outer_stretches(room.area, window.side, _areas_beside(layout, room))
            )


def test_rooms_to_live_in_have_one_or_two_windows(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        for room in layout.rooms:
            count = sum(window.room == room.name for window in layout.windows)
            assert count <= 2
            assert count >= 1 or room.kind in MAY_LIE_INSIDE


def test_walls_can_be_built_around_every_layout(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        shell = build_shell(layout.rooms, layout.doors, layout.windows)
        assert len(shell.doors) == len(layout.doors)


def test_floors_are_tiled_where_it_gets_wet(layouts: list[FloorLayout]) -> None:
    for layout in layouts:
        for room in layout.rooms:
            wet = room.kind in ("kitchen", "bathroom", "laundry room")
            assert (room.floor.substance == "tiles") == wet
            assert room.walls.substance == "paint"


def test_some_homes_have_more_doors_than_they_need() -> None:
    extra = [len(_layout(seed, 6).doors) - 5 for seed in SEEDS]
    assert min(extra) == 0 < max(extra)


def test_the_same_seed_gives_the_same_home() -> None:
    def drawn() -> FloorLayout:
        rng = np.random.default_rng(5)
        return lay_out(rng, draw_programme(rng, 6))

    assert drawn() == drawn()
    assert _layout(5, 6) == drawn() != _layout(6, 6)

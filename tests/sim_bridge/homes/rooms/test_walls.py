"""Walls around rooms: they cover what they should, once; what cannot be built is refused in a sentence."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Wall
from sim_bridge.homes.materials import material
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.rooms.floor_layout import lay_out
from sim_bridge.homes.rooms.room_programmes import draw_programme
from sim_bridge.homes.rooms.walls import Shell, build_shell
from sim_bridge.homes.scene import SceneDoor, SceneRoom, SceneWindow


def _room(name: str, x: float, y: float, x_max: float, y_max: float) -> SceneRoom:
    area = Rect(x_min_m=x, y_min_m=y, x_max_m=x_max, y_max_m=y_max)
    floor, walls = material("oak boards"), material("white paint")
    return SceneRoom(name=name, kind="bedroom", area=area, floor=floor, walls=walls)


def _door(first: str, second: str, x: float, y: float, width: float = 0.9) -> SceneDoor:
    return SceneDoor(rooms=(first, second), x_m=x, y_m=y, width_m=width)


# An L: a long room in the south, one on its west end, and outside where the fourth quarter would be.
SOUTH, NORTH = _room("south", 0.0, 0.0, 7.0, 4.0), _room("north", 0.0, 4.0, 3.0, 7.0)
ROOMS = (SOUTH, NORTH)
DOORS = (_door("south", "north", 1.5, 4.0),)
WINDOW = SceneWindow(room="south", side=Side.NORTH, from_m=4.0, to_m=5.5)


def _area_m2(walls: tuple[Wall, ...]) -> float:
    return sum(wall.base.area_m2 for wall in walls)


def _assert_sound(shell: Shell) -> None:
    """No two walls share a place; every hidden side leans on walls all along."""
    for a, b in combinations(shell.walls, 2):
        assert not a.base.overlaps(b.base)
    for wall in shell.walls:
        base = wall.base
        behind = {
            Side.SOUTH: (base.x_min_m, base.y_min_m - 0.01, base.x_max_m, base.y_min_m),
            Side.NORTH: (base.x_min_m, base.y_max_m, base.x_max_m, base.y_max_m + 0.01),
            Side.WEST: (base.x_min_m - 0.01, base.y_min_m, base.x_min_m, base.y_max_m),
            Side.EAST: (base.x_max_m, base.y_min_m, base.x_max_m + 0.01, base.y_max_m),
        }[wall.hidden]
        strip = Rect(x_min_m=behind[0], y_min_m=behind[1], x_max_m=behind[2], y_max_m=behind[3])
        leaning_m2 = sum(
            (min(strip.x_max_m, other.base.x_max_m) - max(strip.x_min_m, other.base.x_min_m))
            * (min(strip.y_max_m, other.base.y_max_m) - max(strip.y_min_m, other.base.y_min_m))
            for other in shell.walls
            if other.base.overlaps(strip, 1e-9)
        )
        assert leaning_m2 == pytest.approx(strip.area_m2)


@pytest.mark.parametrize("room_count", [1, 3, 5, 8, 10])
def test_walls_and_floors_cover_the_bounds_of_a_rectangular_home_once(room_count: int) -> None:
    for seed in range(4):
        rng = np.random.default_rng(seed)
        layout = lay_out(rng, draw_programme(rng, room_count))
        shell = build_shell(layout.rooms, layout.doors, layout.windows)
        floors_m2 = sum(room.inside.area_m2 for room in shell.rooms)
        assert _area_m2(shell.walls) + floors_m2 == pytest.approx(shell.bounds.area_m2)
        _assert_sound(shell)


def test_an_l_shaped_home_worked_by_hand() -> None:
    shell = build_shell(ROOMS, DOORS, (WINDOW,))
    assert shell.bounds == Rect(x_min_m=-0.05, y_min_m=-0.05, x_max_m=7.05, y_max_m=7.05)
    # The L grown by half a wall: 7.1 x 4.1 below, 3.1 x 3.0 above.
    floors_m2 = 6.9 * 3.9 + 2.9 * 2.9
    assert _area_m2(shell.walls) + floors_m2 == pytest.approx(7.1 * 4.1 + 3.1 * 3.0)
    _assert_sound(shell)
    opening = shell.doors[0].opening
    assert (opening.x_min_m, opening.x_max_m) == pytest.approx((1.05, 1.95))
    assert (opening.y_min_m, opening.y_max_m) == pytest.approx((3.95, 4.05))
    pane = shell.windows[0].pane
    assert (pane.y_min_m, pane.y_max_m) == pytest.approx((3.93, 3.95))
    lintels = [wall for wall in shell.walls if wall.z_min_m == 2.05]
    assert len(lintels) == 2
    assert all(wall.base.overlaps(opening) == (wall in lintels) for wall in shell.walls)


def test_rooms_apart_by_a_narrow_gap_get_walls_that_do_not_overlap() -> None:
    rooms = (*ROOMS, _room("east", 3.08, 4.0, 7.0, 7.0))
    _assert_sound(build_shell(rooms, (*DOORS, _door("south", "east", 5.0, 4.0)), ()))


@pytest.mark.parametrize(
    ("rooms", "sentence"),
    [
        ((), "needs a room"),
        ((SOUTH, _room("north", 0.0, 3.5, 3.0, 7.0)), r"'south' and 'north' overlap by 3.00 m x 0.50 m"),
        ((SOUTH, _room("south", 0.0, 4.0, 3.0, 7.0)), "two rooms are called 'south'"),
        ((SOUTH, _room("north", 0.0, 4.0, 0.9, 7.0)), r"'north' is 0.90 m x 3.00 m"),
        ((*ROOMS, _room("attic", 0.0, 7.0, 3.0, 9.0)), "'attic' has no door"),
    ],
)
def test_rooms_that_cannot_be_are_refused(rooms: tuple[SceneRoom, ...], sentence: str) -> None:
    with pytest.raises(BadSceneError, match=sentence):
        build_shell(rooms, DOORS, ())


@pytest.mark.parametrize(
    ("doors", "sentence"),
    [
        ([_door("south", "nort", 1.5, 4.0)], "names a room 'nort' that is not there"),
        ([_door("south", "south", 1.5, 4.0)], "share no edge"),
        ([_door("south", "north", 1.5, 3.7)], r"y = 3.70 m, and the wall .* y = 4.00 m"),
        ([_door("south", "north", 2.7, 4.0)], r"from x = 2.25 to 3.15 m, .* from 0.05 to 2.95 m"),
        ([_door("south", "north", float("nan"), 4.0)], "opens from"),
        ([_door("south", "north", 1.5, 4.0, 0.5)], "0.50 m wide"),
        ([*DOORS, _door("south", "north", 2.0, 4.0)], r"overlaps that between 'south' and 'north'"),
    ],
)
def test_doors_that_fit_no_wall_are_refused(doors: list[SceneDoor], sentence: str) -> None:
    with pytest.raises(BadSceneError, match=sentence):
        build_shell(ROOMS, doors, ())


def test_doors_between_rooms_apart_and_rooms_out_of_reach_are_refused() -> None:
    far = (_room("shed", 10.0, 0.0, 12.0, 2.0), _room("barn", 12.0, 0.0, 15.0, 2.0))
    with pytest.raises(BadSceneError, match="'south' and 'shed' has no wall"):
        build_shell((*ROOMS, *far), (*DOORS, _door("south", "shed", 8.0, 1.0)), ())
    with pytest.raises(BadSceneError, match="'shed', 'barn' cannot be reached from 'south'"):
        build_shell((*ROOMS, *far), (*DOORS, _door("shed", "barn", 12.0, 1.0)), ())


@pytest.mark.parametrize(
    ("window", "sentence"),
    [
        (replace(WINDOW, room="attic"), "names a room 'attic'"),
        (replace(WINDOW, from_m=2.0, to_m=2.9), r"inner wall; .* outer walls along 3.00..7.00 m"),
        (replace(WINDOW, from_m=1.0, to_m=2.0), "lies over the door between 'south' and 'north'"),
        (replace(WINDOW, from_m=6.0, to_m=7.2), r"leaves its wall, which reaches from 0.05 to 6.95 m"),
        (replace(WINDOW, from_m=5.5, to_m=4.0), "ends before it begins"),
        (replace(WINDOW, sill_m=2.1), "sill"),
        (replace(WINDOW, top_m=2.6), "top"),
        (WINDOW, "overlaps that from 4.00 to 5.50 m"),
    ],
)
def test_windows_that_fit_no_outer_wall_are_refused(window: SceneWindow, sentence: str) -> None:
    with pytest.raises(BadSceneError, match=sentence):
        build_shell(ROOMS, DOORS, (WINDOW, window))

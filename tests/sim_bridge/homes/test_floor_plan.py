"""The floor plan and the mask of an L-shaped home with one piece of furniture, worked by hand."""

import numpy as np

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from sim_bridge.homes.floor_plan import FREE, OCCUPIED, UNKNOWN, candidate_mask, floor_plan
from sim_bridge.homes.home import Furniture, Home, Surface
from sim_bridge.homes.materials import material
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.rooms.walls import build_shell
from sim_bridge.homes.scene import SceneDoor, SceneRoom, Style

WOOD = material("oak wood")
# Its back is to the west wall, whose face is at x = 0.05.
SHELF = Furniture(
    name="low shelf 1",
    kind="low shelf",
    room="south",
    x_m=0.35,
    y_m=2.0,
    quarter_turns=0,
    style=Style(width_m=1.0, main=WOOD, accent=WOOD),
    depth_m=0.4,
    width_m=1.0,
    height_m=0.7,
    tall=False,
    surfaces=(
        Surface(area=Rect(x_min_m=-0.2, y_min_m=-0.5, x_max_m=0.2, y_max_m=0.5), height_m=0.7),
        Surface(area=Rect(x_min_m=-0.3, y_min_m=-0.4, x_max_m=-0.25, y_max_m=0.4), height_m=1.0, hangs=True),
    ),
    parts=(),
)


def _home() -> Home:
    rooms = [
        SceneRoom(
            name=name,
            kind="bedroom",
            area=Rect(x_min_m=0.0, y_min_m=y, x_max_m=x_max, y_max_m=y_max),
            floor=material("oak boards"),
            walls=material("white paint"),
        )
        for name, y, x_max, y_max in (("south", 0.0, 7.0, 4.0), ("north", 4.0, 3.0, 7.0))
    ]
    door = SceneDoor(rooms=("south", "north"), x_m=1.5, y_m=4.0, width_m=0.9)
    shell = build_shell(rooms, [door], [])
    return Home(
        name="an L",
        seed=None,
        bounds=shell.bounds,
        rooms=shell.rooms,
        doors=shell.doors,
        windows=shell.windows,
        walls=shell.walls,
        furniture=(SHELF,),
        objects=(),
        labels=(),
        start=Pose2D(x_m=4.0, y_m=2.0),
    )


def _at(grid: OccupancyMap, x_m: float, y_m: float) -> int:
    row = int((y_m - grid.origin.y_m) / grid.resolution_m)
    column = int((x_m - grid.origin.x_m) / grid.resolution_m)
    return int(grid.cells[row, column])


def test_the_plan_knows_floor_walls_doorways_and_outside() -> None:
    plan = floor_plan(_home())
    expected = {
        (4.0, 2.0): FREE,
        (1.0, 6.0): FREE,
        (1.5, 4.0): FREE,
        (2.5, 4.0): OCCUPIED,
        (5.0, 4.02): OCCUPIED,
        (3.02, 5.0): OCCUPIED,
        (0.35, 2.0): OCCUPIED,
        (5.0, 5.5): UNKNOWN,
        (3.12, 4.12): UNKNOWN,
        (-0.3, 2.0): UNKNOWN,
    }
    assert {place: _at(plan, *place) for place in expected} == expected


def test_no_free_cell_touches_the_outside() -> None:
    cells = floor_plan(_home()).cells
    for axis in (0, 1):
        for shift in (-1, 1):
            assert not ((cells == FREE) & (np.roll(cells, shift, axis=axis) == UNKNOWN)).any()


def test_the_mask_covers_carriers_and_where_objects_hang_behind_them() -> None:
    mask = candidate_mask(_home())
    assert _at(mask, 0.35, 2.0) == _at(mask, 0.52, 2.48) == OCCUPIED
    assert _at(mask, 0.07, 2.0) == OCCUPIED
    assert _at(mask, 0.07, 2.45) == _at(mask, 0.13, 2.0) == _at(mask, 0.6, 2.0) == FREE
    # 0.4 m x 1.0 m of shelf, and 0.05 m x 0.8 m of wall.
    assert int((mask.cells == OCCUPIED).sum()) == 8 * 20 + 1 * 16
    assert mask.cells.shape == floor_plan(_home()).cells.shape

"""Pictures of a home for people: from above, and as the robot sees its rooms."""

import math

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.home import WALL_HEIGHT_M, Home, Room
from sim_bridge.homes.obstacles import ClearanceGrid
from sim_bridge.sensors.camera import Camera, camera_model, look_at
from sim_bridge.sensors.scenery import Scenery, scenery_of

Pixels = NDArray[np.uint8]

# From so high up that one looks hardly at the walls.
ABOVE_M = 22.0
AROUND_M = 0.15
VIEW_RAD = math.pi / 3.0
RANGE_M = 25.0
# Where the robot stands to look at a room.
STAND_CLEARANCE_M = 0.30
GAP_PX = 6
VIEW_GRID = 12
MOST_COLUMNS = 3


def top_view(home: Home, width_px: int, scenery: Scenery | None = None) -> Pixels:
    """The home from above, north up: uint8 [height, width_px, 3]."""
    bounds = home.bounds
    x_m, y_m = bounds.centre_m
    # The tops of the walls are nearer, and look larger.
    nearer = ABOVE_M / (ABOVE_M - WALL_HEIGHT_M)
    wide_m, deep_m = (length * nearer + 2.0 * AROUND_M for length in (bounds.width_m, bounds.depth_m))
    height_px = round(width_px * deep_m / wide_m)
    view_rad = 2.0 * math.atan(wide_m / 2.0 / ABOVE_M)
    model = camera_model(width_px, height_px, view_rad)
    frame = look_at(scenery or scenery_of(home), model, (x_m, y_m, ABOVE_M), (x_m, y_m, 0.0))
    if frame.color is None:
        raise AssertionError("look_at always paints")
    return frame.color.pixels


def robot_views(home: Home, width_px: int, scenery: Scenery | None = None) -> dict[str, Pixels]:
    """For each room's name what the robot sees from where it sees most of the room's things: 4 by 3."""
    camera = Camera(
        scenery or scenery_of(home),
        camera_model(width_px, width_px * 3 // 4, VIEW_RAD),
        CameraMount(),
        RANGE_M,
    )
    small = Camera(camera.scenery, camera_model(64, 48, VIEW_RAD), camera.mount, RANGE_M)
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
    views = {}
    for room in home.rooms:
        color = camera.take(_best_pose(home, room, grid, small), 0).color
        if color is not None:
            views[room.name] = color.pixels
    return views


def sheet(home: Home, width_px: int) -> Pixels:
    """The home from above, and below it a view of each room."""
    scenery = scenery_of(home)
    rooms = len(home.rooms)
    columns = min(range(1, MOST_COLUMNS + 1), key=lambda count: (-rooms % count, -count)) if rooms > 1 else 1
    each_px = (width_px - GAP_PX * (columns - 1)) // columns
    views = list(robot_views(home, each_px, scenery).values())
    rows = [top_view(home, width_px, scenery)]
    for at in range(0, len(views), columns):
        row = np.full((each_px * 3 // 4, width_px, 3), 255, dtype=np.uint8)
        for column, view in enumerate(views[at : at + columns]):
            left = column * (each_px + GAP_PX)
            row[:, left : left + each_px] = view
        rows += [np.full((GAP_PX, width_px, 3), 255, dtype=np.uint8), row]
    return np.concatenate(rows)


def _best_pose(home: Home, room: Room, grid: ClearanceGrid, camera: Camera) -> Pose2D:
    """Where, among some places and headings, most different things of the room are in sight."""
    rows, columns = grid.cells_in(room.inside)
    free_rows, free_columns = np.nonzero(grid.cells_m[rows, columns] >= STAND_CLEARANCE_M)
    if not len(free_rows):
        return home.start
    x_m, y_m = grid.x_m[columns][free_columns], grid.y_m[rows][free_rows]
    middle_m = room.inside.centre_m
    own = [
        number
        for number, item in camera.scenery.items.items()
        if room.inside.holds(item.x_m, item.y_m) and (item.x_m, item.y_m) != (0.0, 0.0)
    ]
    best, most = home.start, -1.0
    for at in np.linspace(0, len(x_m) - 1, VIEW_GRID * VIEW_GRID).astype(int).tolist():
        towards = math.atan2(middle_m[1] - y_m[at], middle_m[0] - x_m[at])
        pose = Pose2D(x_m=float(x_m[at]), y_m=float(y_m[at]), yaw_rad=towards)
        numbers, counts = np.unique(camera.take(pose, 0, color=False).numbers, return_counts=True)
        seen = np.isin(numbers, own)
        # Many things, none of which fills the picture.
        worth = float(np.sqrt(counts[seen] / counts.sum()).sum()) if seen.any() else 0.0
        if worth > most:
            best, most = pose, worth
    return best

"""The floor that is left while a home is furnished: what fits, and whether the robot still gets everywhere.

Whether the floor is in one piece is asked of the room that a piece is put into, with its doorways as far as
the next room. Rooms share their doorways' floor, so that where each room is in one piece, the home is; and
no piece narrows another room's floor, because walls and the zones kept free before doors are nearer.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.ndimage

from robustnav_msgs_py.values import Float64
from sim_bridge.homes.furniture.carpentry import GAP_M, Design
from sim_bridge.homes.furniture.placement import Spot
from sim_bridge.homes.home import WALL_THICKNESS_M, Door, Room, Wall, Window
from sim_bridge.homes.obstacles import ClearanceGrid
from sim_bridge.homes.rect import GRID_M, Rect, Side
from sim_bridge.homes.scene import Style

DOOR_ZONE_M = 0.80
DOOR_ZONE_SIDE_M = 0.10
# Nothing tall stands so near to a window.
WINDOW_ZONE_M = 0.60
# The floor must be in one piece for robots of all these radii: ours with the distance that it keeps, and
# planners that keep more. The largest is closed out most often: it is asked first.
PASSAGE_RADII_M = (0.16, 0.18, 0.21, 0.25, 0.30)
# A robot of the largest radius gets so near to everything that carries objects.
REACH_M = 0.45


class Shell(Protocol):
    """A home without furniture."""

    @property
    def bounds(self) -> Rect: ...
    @property
    def rooms(self) -> tuple[Room, ...]: ...
    @property
    def doors(self) -> tuple[Door, ...]: ...
    @property
    def windows(self) -> tuple[Window, ...]: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """A piece on the floor, or one that might stand there. `front` is the floor kept free before it."""

    kind: str
    style: Style
    shape: Design
    room: str
    spot: Spot
    footprint: Rect
    front: Rect | None

    @property
    def carries(self) -> bool:
        """Whether objects stand on it, where a robot can see them."""
        return bool(self.shape.surfaces) and not self.shape.tall


def standing(kind: str, style: Style, shape: Design, room: str, spot: Spot) -> Standing:
    """A piece of that shape on that spot."""
    half_x, half_y = shape.depth_m / 2.0, shape.width_m / 2.0
    front = None
    if shape.front_m > 0.0:
        front = Rect(x_min_m=half_x, y_min_m=-half_y, x_max_m=half_x + shape.front_m, y_max_m=half_y)
    return Standing(
        kind=kind,
        style=style,
        shape=shape,
        room=room,
        spot=spot,
        footprint=spot.in_map(Rect(x_min_m=-half_x, y_min_m=-half_y, x_max_m=half_x, y_max_m=half_y)),
        front=None if front is None else spot.in_map(front),
    )


class FreeFloor:
    """What stands in a home so far. Owned by one furnishing; grows piece by piece, and can go back."""

    def __init__(self, shell: Shell) -> None:
        low_walls = [wall.base for wall in shell.walls if wall.z_min_m == 0.0]
        grid = ClearanceGrid(shell.bounds, GRID_M).with_rects(low_walls)
        self._x_m, self._y_m = grid.x_m, grid.y_m
        self._cells_m: Float64 = grid.cells_m.copy()
        self._door_zones = [door_zone(door) for door in shell.doors]
        self._window_zones = [window_zone(window) for window in shell.windows]
        self.pieces: list[Standing] = []

    def in_room(self, room: Room) -> list[Standing]:
        """What stands in the room."""
        return [piece for piece in self.pieces if piece.room == room.name]

    def snapshot(self) -> tuple[Float64, int]:
        """What `restore` goes back to."""
        return self._cells_m.copy(), len(self.pieces)

    def restore(self, before: tuple[Float64, int]) -> None:
        """Take away what was put since the snapshot."""
        self._cells_m = before[0].copy()
        del self.pieces[before[1] :]

    def fits(self, room: Room, piece: Standing, host: Standing | None = None) -> bool:
        """Whether nothing is in the piece's way, nor the piece in another's; `host` may have it in front."""
        footprint, front = piece.footprint, piece.front
        if not room.inside.grown(-GAP_M).contains(footprint):
            return False
        if front is not None and not room.inside.contains(front):
            return False
        if any(footprint.overlaps(zone) for zone in self._door_zones) or self._hides_window(piece):
            return False
        kept = footprint.grown(GAP_M)
        for other in self.pieces:
            if kept.overlaps(other.footprint):
                return False
            if front is not None and front.overlaps(other.footprint):
                return False
            if other.front is not None and other is not host and footprint.overlaps(other.front):
                return False
        return True

    def put(self, room: Room, pieces: Sequence[Standing]) -> bool:
        """Put pieces that fit all at once, if the robot can still go everywhere; else change nothing."""
        rows, columns = self._window(room)
        x_m, y_m = self._x_m[columns], self._y_m[rows]
        cells_m = self._cells_m[rows, columns].copy()
        for piece in pieces:
            np.minimum(cells_m, _distance_m(piece.footprint, x_m, y_m), out=cells_m)
        for radius_m in reversed(PASSAGE_RADII_M):
            if scipy.ndimage.label(cells_m >= radius_m)[1] != 1:
                return False
        roomy = cells_m >= max(PASSAGE_RADII_M)
        for piece in (*self.in_room(room), *pieces):
            near = _distance_m(piece.footprint, x_m, y_m) <= REACH_M
            if piece.carries and not (near & roomy).any():
                return False
        self._cells_m[rows, columns] = cells_m
        self.pieces.extend(pieces)
        return True

    def is_one_piece(self) -> bool:
        """Whether the whole home's floor is in one piece for all radii."""
        return all(scipy.ndimage.label(self._cells_m >= radius_m)[1] == 1 for radius_m in PASSAGE_RADII_M)

    def _window(self, room: Room) -> tuple[slice, slice]:
        """The rows and columns of a room with its doorways, and nothing of its neighbours."""
        area = room.inside.grown(WALL_THICKNESS_M)
        rows = np.searchsorted(self._y_m, (area.y_min_m, area.y_max_m))
        columns = np.searchsorted(self._x_m, (area.x_min_m, area.x_max_m))
        return slice(int(rows[0]), int(rows[1])), slice(int(columns[0]), int(columns[1]))

    def _hides_window(self, piece: Standing) -> bool:
        """Tall pieces hide windows, and nothing can hang on one."""
        shape = piece.shape
        covers = [piece.footprint] if shape.tall else []
        covers += [piece.spot.in_map(surface.area) for surface in shape.surfaces if surface.hangs]
        return any(cover.overlaps(zone) for cover in covers for zone in self._window_zones)


def door_zone(door: Door) -> Rect:
    """The floor on both sides of a door that furniture stays out of."""
    return _stretched(door.opening, door.along_x, DOOR_ZONE_SIDE_M, DOOR_ZONE_M)


def window_zone(window: Window) -> Rect:
    """The floor before a window (and the wall behind it) that tall furniture stays out of."""
    return _stretched(window.pane, window.side in (Side.SOUTH, Side.NORTH), 0.0, WINDOW_ZONE_M)


def _stretched(rect: Rect, along_x: bool, along_m: float, across_m: float) -> Rect:
    beyond_x, beyond_y = (along_m, across_m) if along_x else (across_m, along_m)
    return Rect(
        x_min_m=rect.x_min_m - beyond_x,
        y_min_m=rect.y_min_m - beyond_y,
        x_max_m=rect.x_max_m + beyond_x,
        y_max_m=rect.y_max_m + beyond_y,
    )


def _distance_m(rect: Rect, x_m: Float64, y_m: Float64) -> Float64:
    """From each point of a grid to the rectangle, [len(y_m), len(x_m)]; 0 inside."""
    beyond_x = np.maximum(np.maximum(rect.x_min_m - x_m, x_m - rect.x_max_m), 0.0)
    beyond_y = np.maximum(np.maximum(rect.y_min_m - y_m, y_m - rect.y_max_m), 0.0)
    return np.asarray(np.hypot(beyond_x[None, :], beyond_y[:, None]))

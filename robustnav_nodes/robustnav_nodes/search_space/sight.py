"""What is in view from a pose: the cone, the range, and what hides. The compiled loops of the camera view."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.search_space.buckets import Buckets
from robustnav_nodes.search_space.compiled import compiled

_ROUNDING = 1e-9  # what lies exactly on the edge of the view is in view


class Scene(NamedTuple):
    """What hides, what is looked for and how the camera looks, in the form that compiled loops take.

    hides: bool [height, width], cells of a grid whose corner is (x_m, y_m); buckets: of the candidates.
    """

    hides: NDArray[np.bool_]
    resolution_m: float
    x_m: float
    y_m: float
    candidate_x_m: Float64
    candidate_y_m: Float64
    candidate_half_m: float
    buckets: Buckets
    camera_forward_m: float
    half_view_rad: float
    range_min_m: float
    range_max_m: float


@compiled
def look(scene: Scene, x_m: float, y_m: float, yaw_rad: float, found: NDArray[np.int32]) -> int:
    """How many candidates a robot at the pose has in view; they are written to the front of `found`.

    found: int32 [k], scratch; bucket after bucket, so not ascending.
    """
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    camera_x = x_m + scene.camera_forward_m * cos
    camera_y = y_m + scene.camera_forward_m * sin
    nearest, farthest = scene.range_min_m**2, scene.range_max_m**2
    cos_half_view = math.cos(scene.half_view_rad)
    buckets = scene.buckets
    reach = scene.range_max_m + 1e-6  # a little more than the range, whatever is rounded on the way
    first_column = _clipped((camera_x - reach - buckets.x_m) / buckets.side_m, buckets.columns)
    last_column = _clipped((camera_x + reach - buckets.x_m) / buckets.side_m, buckets.columns)
    first_row = _clipped((camera_y - reach - buckets.y_m) / buckets.side_m, buckets.rows)
    last_row = _clipped((camera_y + reach - buckets.y_m) / buckets.side_m, buckets.rows)
    count = 0
    for row in range(first_row, last_row + 1):
        begin = buckets.start[row * buckets.columns + first_column]
        end = buckets.start[row * buckets.columns + last_column + 1]
        for j in buckets.member[begin:end]:
            dx, dy = scene.candidate_x_m[j] - camera_x, scene.candidate_y_m[j] - camera_y
            squared = dx * dx + dy * dy
            in_range = nearest <= squared <= farthest
            in_cone = in_range and cos * dx + sin * dy >= cos_half_view * math.sqrt(squared) - _ROUNDING
            if in_cone and line_of_sight(
                scene, camera_x, camera_y, scene.candidate_x_m[j], scene.candidate_y_m[j]
            ):
                found[count] = j
                count += 1
    return count


@compiled
def _clipped(place: float, count: int) -> int:
    """The bucket that `place` (in buckets from the first one) lies in, or the nearest of `count`."""
    return int(min(max(place, 0.0), count - 1.0))


@compiled
def line_of_sight(scene: Scene, camera_x: float, camera_y: float, x_m: float, y_m: float) -> bool:
    """True where no cell on the straight line from the camera to the candidate at (x_m, y_m) hides it.

    The cell that the camera is in and the cells of the candidate's own patch do not count; what lies
    outside the map hides.
    """
    height, width = scene.hides.shape
    resolution = scene.resolution_m
    camera_column = int(math.floor((camera_x - scene.x_m) / resolution))
    camera_row = int(math.floor((camera_y - scene.y_m) / resolution))

    # Always walked from the same end, so that ties at cell corners fall alike in both directions.
    ax, ay, bx, by = camera_x, camera_y, x_m, y_m
    if bx < ax or (bx == ax and by < ay):
        ax, ay, bx, by = bx, by, ax, ay
    ax, ay = (ax - scene.x_m) / resolution, (ay - scene.y_m) / resolution
    bx, by = (bx - scene.x_m) / resolution, (by - scene.y_m) / resolution
    own_x, own_y = (x_m - scene.x_m) / resolution, (y_m - scene.y_m) / resolution
    own_half = scene.candidate_half_m / resolution

    column, row = int(math.floor(ax)), int(math.floor(ay))
    steps = abs(int(math.floor(bx)) - column) + abs(int(math.floor(by)) - row)
    dx, dy = bx - ax, by - ay
    step_column, step_row = (1 if dx >= 0.0 else -1), (1 if dy >= 0.0 else -1)
    per_column = abs(1.0 / dx) if dx != 0.0 else math.inf
    per_row = abs(1.0 / dy) if dy != 0.0 else math.inf
    to_column = ((column + 1 - ax) if dx >= 0.0 else (ax - column)) * per_column if dx != 0.0 else math.inf
    to_row = ((row + 1 - ay) if dy >= 0.0 else (ay - row)) * per_row if dy != 0.0 else math.inf
    for _ in range(steps + 1):
        is_own = abs(column + 0.5 - own_x) <= own_half and abs(row + 0.5 - own_y) <= own_half
        if is_own or (column == camera_column and row == camera_row):
            pass
        elif column < 0 or row < 0 or column >= width or row >= height or scene.hides[row, column]:
            return False
        if to_column < to_row:
            to_column += per_column
            column += step_column
        else:
            to_row += per_row
            row += step_row
    return True


@compiled
def look_from_all(
    scene: Scene, x_m: Float64, y_m: Float64, yaw_rad: Float64, limit: int
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """How many candidates each of n poses has in view (int64 [n]), and which, pose after pose (int32 [s]).

    Those of one pose are in ascending order. Stops at the first pose after which there are more than `limit`.
    """
    count = np.zeros(len(x_m), dtype=np.int64)
    seen = np.empty(1024, dtype=np.int32)
    total = 0
    found = np.empty(len(scene.candidate_x_m), dtype=np.int32)
    for pose in range(len(x_m)):
        sights = look(scene, x_m[pose], y_m[pose], yaw_rad[pose], found)
        found[:sights].sort()
        if total + sights > len(seen):
            longer = np.empty(2 * (total + sights), dtype=np.int32)
            longer[:total] = seen[:total]
            seen = longer
        seen[total : total + sights] = found[:sights]
        count[pose] = sights
        total += sights
        if total > limit:
            break
    return count, seen[:total].copy()

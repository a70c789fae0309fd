"""What the camera can see of the candidate locations from any pose."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool, Float64, OccupancyMap, Pose2D
from robustnav_nodes.search_space.candidates import (
    Candidates,
    candidates_from_map,
    candidates_from_mask,
    see_through,
)
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.floor_grid import FREE, FloorGrid, floor_grid
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

_ROUNDING = 1e-9  # what lies exactly on the edge of the view is in view


class Scene(NamedTuple):
    """What hides, what is looked for and how the camera looks, in the form that compiled loops take.

    hides: bool [height, width], cells of a grid whose corner is (x_m, y_m).
    """

    hides: NDArray[np.bool_]
    resolution_m: float
    x_m: float
    y_m: float
    candidate_x_m: Float64
    candidate_y_m: Float64
    candidate_half_m: float
    camera_forward_m: float
    half_view_rad: float
    range_min_m: float
    range_max_m: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraView:
    """Says which candidates a robot at a pose has in view: in the cone, in range, and nothing hides them.

    Cells that are occupied or unknown hide what is behind them, unless the mask marks them: low furniture
    holds objects and hides none. A candidate's own patch never hides it.
    """

    grid: FloorGrid
    candidates: Candidates
    scene: Scene
    frame_id: str

    def visible(self, pose: Pose2D) -> Bool:
        """bool [k]: what a robot whose centre is at `pose` has in view."""
        seen = np.zeros(len(self.candidates), dtype=np.bool_)
        look(self.scene, pose.x_m, pose.y_m, pose.yaw_rad, seen)
        return seen


def build_camera_view(
    floor_map: OccupancyMap, candidate_mask: OccupancyMap | None, parameters: SearchSpaceParameters
) -> CameraView:
    """The view on `floor_map`; candidates come from the mask, or from the map where there is no mask.

    Raises BadMapError for a map without free floor, without candidates or with too many, or for a mask in
    another frame or another place.
    """
    grid = floor_grid(floor_map, parameters)
    hides = grid.kind != FREE
    if candidate_mask is None:
        candidates = candidates_from_map(grid, parameters)
    else:
        if candidate_mask.frame_id != floor_map.frame_id:
            raise BadMapError(
                f"the candidate mask is in frame {candidate_mask.frame_id!r}, the map in "
                f"{floor_map.frame_id!r}: publish the mask in the map's frame"
            )
        candidates = candidates_from_mask(candidate_mask, grid, parameters)
        hides &= ~see_through(candidate_mask, grid)
    scene = Scene(
        hides=hides,
        resolution_m=grid.resolution_m,
        x_m=grid.x_m,
        y_m=grid.y_m,
        candidate_x_m=candidates.x_m,
        candidate_y_m=candidates.y_m,
        candidate_half_m=0.5 * candidates.size_m,
        camera_forward_m=parameters.camera_forward_m,
        half_view_rad=0.5 * parameters.horizontal_view_rad,
        range_min_m=parameters.range_min_m,
        range_max_m=parameters.range_max_m,
    )
    return CameraView(grid=grid, candidates=candidates, scene=scene, frame_id=floor_map.frame_id)


@compiled
def look(scene: Scene, x_m: float, y_m: float, yaw_rad: float, seen: NDArray[np.bool_]) -> None:
    """Write into `seen` (bool [k]) what a robot at the pose has in view."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    camera_x = x_m + scene.camera_forward_m * cos
    camera_y = y_m + scene.camera_forward_m * sin
    nearest, farthest = scene.range_min_m**2, scene.range_max_m**2
    cos_half_view = math.cos(scene.half_view_rad)
    for j in range(len(seen)):
        dx, dy = scene.candidate_x_m[j] - camera_x, scene.candidate_y_m[j] - camera_y
        squared = dx * dx + dy * dy
        in_range = nearest <= squared <= farthest
        in_cone = in_range and cos * dx + sin * dy >= cos_half_view * math.sqrt(squared) - _ROUNDING
        seen[j] = in_cone and line_of_sight(
            scene, camera_x, camera_y, scene.candidate_x_m[j], scene.candidate_y_m[j]
        )


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

    Stops at the first pose after which there are more than `limit`.
    """
    count = np.zeros(len(x_m), dtype=np.int64)
    found = np.empty(1024, dtype=np.int32)
    total = 0
    seen = np.zeros(len(scene.candidate_x_m), dtype=np.bool_)
    for pose in range(len(x_m)):
        look(scene, x_m[pose], y_m[pose], yaw_rad[pose], seen)
        for j in range(len(seen)):
            if seen[j]:
                if total == len(found):
                    longer = np.empty(2 * total, dtype=np.int32)
                    longer[:total] = found
                    found = longer
                found[total] = j
                total += 1
                count[pose] += 1
        if total > limit:
            break
    return count, found[:total].copy()

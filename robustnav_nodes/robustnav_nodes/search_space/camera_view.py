"""What the camera can see of the candidate locations from any pose."""

from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool, OccupancyMap, Pose2D
from robustnav_nodes.search_space.buckets import bucketed
from robustnav_nodes.search_space.candidates import (
    Candidates,
    candidates_from_map,
    candidates_from_mask,
    see_through,
)
from robustnav_nodes.search_space.floor_grid import FREE, FloorGrid, floor_grid
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.sight import Scene, look

_LOOKS_FOR_SHARE = 256


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
        found = np.empty(len(self.candidates), dtype=np.int32)
        count = look(self.scene, pose.x_m, pose.y_m, pose.yaw_rad, found)
        seen = np.zeros(len(self.candidates), dtype=np.bool_)
        seen[found[:count]] = True
        return seen

    def share_in_view(self) -> float:
        """Part of the candidates that is in view on average, from free floor with any heading, in 0..1."""
        rng = np.random.default_rng(0)
        rows, columns = np.nonzero(self.grid.kind == FREE)
        chosen = rng.integers(len(rows), size=_LOOKS_FOR_SHARE)
        yaw_rad = rng.uniform(0.0, 2.0 * np.pi, size=_LOOKS_FOR_SHARE)
        found = np.empty(len(self.candidates), dtype=np.int32)
        counts = [
            look(
                self.scene,
                self.grid.x_m + (column + 0.5) * self.grid.resolution_m,
                self.grid.y_m + (row + 0.5) * self.grid.resolution_m,
                yaw,
                found,
            )
            for row, column, yaw in zip(rows[chosen], columns[chosen], yaw_rad, strict=True)
        ]
        return float(np.mean(counts)) / len(self.candidates)


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
        buckets=bucketed(candidates.x_m, candidates.y_m, parameters.range_max_m),
        camera_forward_m=parameters.camera_forward_m,
        half_view_rad=0.5 * parameters.horizontal_view_rad,
        range_min_m=parameters.range_min_m,
        range_max_m=parameters.range_max_m,
    )
    return CameraView(grid=grid, candidates=candidates, scene=scene, frame_id=floor_map.frame_id)

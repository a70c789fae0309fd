"""The search space of one floor: poses, candidate locations, and what sees what."""

from collections.abc import Callable
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool, OccupancyMap, Pose2D
from robustnav_nodes.search_space.camera_view import CameraView, build_camera_view
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability, build_observability
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph, build_pose_graph

LookFromAll = Callable[[CameraView, PoseGraph, SearchSpaceParameters], Observability]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchSpace:
    """Everything about the place that does not change while one search goes on; shared freely by threads.

    view: what a robot sees that stands between the poses; None where there is no map to tell it from, as in
    a space that was read from a table.
    """

    graph: PoseGraph
    candidates: Candidates
    observability: Observability
    view: CameraView | None = None
    frame_id: str = "map"

    @classmethod
    def build(
        cls,
        floor_map: OccupancyMap,
        candidate_mask: OccupancyMap | None,
        parameters: SearchSpaceParameters,
        start: Pose2D | None = None,
        look_from_all: LookFromAll = build_observability,
    ) -> "SearchSpace":
        """The search space of `floor_map`; with `start`, only what a robot there can reach.

        look_from_all: makes the observability table; a cache may take the place of the one that builds it.

        Raises BadMapError, with a sentence that says what to do, where nothing can be searched: no free
        floor, no candidates or none that can be seen, the robot fits nowhere, or the map is too large.
        """
        view = build_camera_view(floor_map, candidate_mask, parameters)
        graph = build_pose_graph(view.grid, parameters, start)
        observability = look_from_all(view, graph, parameters)
        if not observability.seen_from_somewhere().any():
            raise BadMapError(
                f"none of the {len(view.candidates)} candidate locations can be seen from any of the "
                f"{len(graph)} poses: check range_min_m, range_max_m and horizontal_view_rad, and that the "
                "robot and the candidates are on the same side of the walls"
            )
        return cls(
            graph=graph,
            candidates=view.candidates,
            observability=observability,
            view=view,
            frame_id=view.frame_id,
        )

    def visible(self, robot: Pose2D) -> Bool:
        """bool [k]: what a robot whose centre is at `robot` has in view."""
        if self.view is None:
            return self.observability.row(self.graph.nearest(robot))
        return self.view.visible(robot)

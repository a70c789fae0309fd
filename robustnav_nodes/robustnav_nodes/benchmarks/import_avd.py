"""Search scenes from the Active Vision Dataset: one folder per scene, such as `Home_001_1`.

| file | holds |
|---|---|
| `annotations.json` | by name of the image: its `bounding_boxes`, and the images that its moves lead to |
| `image_structs.mat` | `image_structs`, where each image was taken; `scale`, the millimetres in its unit |
| `detections.json` | not of the dataset: `bounding_boxes` of a detector, in the form of annotations.json |
| `instance_id_map.txt` | names of the instances, here or one folder up; may be missing |
"""

import math
import zlib
from collections import defaultdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.io import loadmat
from scipy.io.matlab import MatReadError
from scipy.sparse import csgraph

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Bool, Float64, OccupancyMap, Pose2D
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget, Sighting
from robustnav_nodes.benchmarks.search_suite import DESTINATION_M
from robustnav_nodes.benchmarks.text_files import read_instance_names, read_json_object
from robustnav_nodes.search_space.camera_view import build_camera_view
from robustnav_nodes.search_space.observability import build_observability
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

FOCAL_PX = 1070.0  # of the dataset's cameras, whose images are 1920 pixels wide
CENTRE_PX = 960.0
WAYS = {
    Action.FORWARD: "forward",
    Action.BACKWARD: "backward",
    Action.TURN_LEFT: "rotate_ccw",
    Action.TURN_RIGHT: "rotate_cw",
}

_CELL_M = 0.20
_VIEW_RAD = math.radians(60.0)
_RANGE_MIN_M, _RANGE_MAX_M = 0.5, 4.0
_MAX_SIDE_M = 200.0
_HEADINGS = 12  # where no image turns to another
_ONE_BEARING_M = 2.0  # how far away an object is taken to be that is seen along one line only
_LEAST_SPREAD = 1e-3  # of bearings that meet in a point: variance of their directions
_LEAST_SIGMA_RAD = math.radians(3.0)
_BESIDE = 2.0  # sigmas; a box farther beside all candidates in view is about none of them
_NEGLIGIBLE = 1e-6
_DAMAGE = (ValueError, TypeError, KeyError, IndexError, RuntimeError, EOFError, MatReadError, zlib.error)


class Box(NamedTuple):
    """Where an image shows an instance: the angle from its middle, counter-clockwise, and half the width."""

    pose: int
    bearing_rad: float
    half_width_rad: float


class Cameras(NamedTuple):
    """Where the images were taken, on the floor seen from above: float64 [n] each."""

    x_m: Float64
    y_m: Float64
    yaw_rad: Float64


def import_avd(folder: Path) -> SearchScene:
    """The scene in `folder`; every instance that has a box somewhere is a target.

    Poses are the images in the order of their names; those that turn into each other become one place, in
    their middle. Steps sideways are left out.

    The dataset has neither a map nor candidate locations, and no depth is used. Candidates are the cells of
    0.20 m that no camera stood in and that some pose has in view: 60 degrees, 0.5 to 4 m, through walls. A
    box gives a direction and no distance, so a detection is a normal density over the angle beside the box's
    middle, as wide as the box; several views together tell the distance. A target's place, which decides
    its destinations, is the candidate nearest to where the bearings of all its boxes meet.

    "perfect" fires where the annotations hold a box. "noisy" exists where `detections.json` does; its
    precision and recall, by pose, are measured on this scene itself.

    Raises BadFileError where a file is missing or wrong.
    """
    path = folder / "annotations.json"
    views = read_json_object(path)
    if not views:
        raise BadFileError(f"{str(path)!r} names no image: it must hold an entry for each")
    pose_of = {image: pose for pose, image in enumerate(sorted(views))}
    successors = _read_successors(path, views, pose_of)
    cameras = _read_cameras(folder / "image_structs.mat", list(pose_of), successors)
    space = _space(cameras, successors)
    truth = _read_boxes(path, views, pose_of)
    if not truth:
        raise BadFileError(f"{str(path)!r} holds no bounding box: there is nothing to look for")
    found = None
    if (path := folder / "detections.json").exists():
        found = _read_boxes(path, read_json_object(path), pose_of)
    names = _read_names(folder)
    return SearchScene(
        name=folder.resolve().name,
        difficulty="avd",
        space=space,
        targets=tuple(
            _target(
                names.get(instance, f"object {instance}"),
                space,
                cameras,
                truth[instance],
                found.get(instance, []) if found is not None else None,
            )
            for instance in sorted(truth)
        ),
        starts=np.zeros(0, dtype=np.int32),
    )


def where_bearings_meet(x_m: Float64, y_m: Float64, bearing_rad: Float64) -> tuple[float, float]:
    """The point nearest, by least squares, to the lines from (x_m, y_m) along the bearings: float64 [m].

    Lines that are all but parallel meet nowhere; the mean of the points 2 m along them stands in.
    """
    cos, sin = np.cos(bearing_rad), np.sin(bearing_rad)
    # Each line gives one equation: the point's distance from it, along its normal (-sin, cos), is zero.
    normals = np.stack([-sin, cos], axis=1)
    spread = np.linalg.eigvalsh(normals.T @ normals / len(normals))[0]
    if spread < _LEAST_SPREAD:
        return float(np.mean(x_m + _ONE_BEARING_M * cos)), float(np.mean(y_m + _ONE_BEARING_M * sin))
    point, *_ = np.linalg.lstsq(normals, -sin * x_m + cos * y_m, rcond=None)
    return float(point[0]), float(point[1])


def _read_successors(path: Path, views: dict[str, Any], pose_of: dict[str, int]) -> NDArray[np.int32]:
    successors = np.full((len(pose_of), len(Action)), NOWHERE, dtype=np.int32)
    for image, pose in pose_of.items():
        for action, way in WAYS.items():
            end = views[image].get(way, "") if isinstance(views[image], dict) else None
            if end != "" and (not isinstance(end, str) or end not in pose_of):
                raise BadFileError(
                    f"{way!r} of image {image!r} in {str(path)!r} is {end!r:.80}: it must name an image "
                    "of the scene, or be empty"
                )
            successors[pose, action] = pose_of.get(end, NOWHERE)
    return successors


def _read_boxes(path: Path, views: dict[str, Any], pose_of: dict[str, int]) -> dict[int, list[Box]]:
    """The boxes of each instance, in ascending order of the poses."""
    boxes = defaultdict(list)
    for image in sorted(views):
        if image not in pose_of:
            raise BadFileError(f"image {image!r:.80} in {str(path)!r} is not among those of annotations.json")
        rows = views[image].get("bounding_boxes") if isinstance(views[image], dict) else None
        if not isinstance(rows, list):
            raise BadFileError(
                f"image {image!r:.80} in {str(path)!r} must hold a list of 'bounding_boxes', "
                f"not {views[image]!r:.80}"
            )
        for row in rows:
            if not _is_box(row):
                raise BadFileError(
                    f"a box of image {image!r:.80} in {str(path)!r} is {row!r:.80}: it must be xmin, ymin, "
                    "xmax, ymax in pixels and the number of the instance"
                )
            left_rad, right_rad = (-math.atan((row[side] - CENTRE_PX) / FOCAL_PX) for side in (0, 2))
            middle_px = 0.5 * (row[0] + row[2])
            box = Box(
                pose=pose_of[image],
                bearing_rad=-math.atan((middle_px - CENTRE_PX) / FOCAL_PX),
                half_width_rad=0.5 * (left_rad - right_rad),
            )
            boxes[int(row[4])].append(box)
    return dict(boxes)


def _is_box(row: Any) -> bool:
    if not isinstance(row, list) or len(row) < 5:
        return False
    numbers = all(type(value) in (int, float) and math.isfinite(value) for value in row[:5])
    return numbers and row[0] <= row[2] and row[4] == int(row[4])


def _read_cameras(path: Path, images: list[str], successors: NDArray[np.int32]) -> Cameras:
    """Of the dataset's x, y and z, the floor is x and z.

    Which side of that plane is above is told by the turns: rotate_ccw goes counter-clockwise seen from above.
    Where there is no turn, y points up.
    """
    try:
        # MATLAB compresses such files, so that damage is noticed; in others it can crash scipy's reader.
        content = loadmat(path, squeeze_me=True, variable_names=["image_structs", "scale"])
        structs = {str(struct["image_name"]): struct for struct in np.atleast_1d(content["image_structs"])}
        metres = float(content["scale"]) / 1e3
    except OSError as error:
        raise BadFileError(f"cannot read {str(path)!r}: {error}; the folder must hold this file") from error
    except _DAMAGE as error:
        raise BadFileError(
            f"{str(path)!r} does not hold the dataset's 'image_structs' and 'scale' ({error}): get it anew"
        ) from error
    if not (math.isfinite(metres) and metres > 0.0):
        raise BadFileError(f"'scale' in {str(path)!r} is {1e3 * metres!r} mm: it must be positive")
    place = metres * np.stack([_vector(path, structs, image, "world_pos") for image in images])
    ahead = np.stack([_vector(path, structs, image, "direction") for image in images])
    if not np.hypot(ahead[:, 0], ahead[:, 2]).all():
        image = images[int(np.argmin(np.hypot(ahead[:, 0], ahead[:, 2])))]
        raise BadFileError(
            f"'direction' of image {image!r} in {str(path)!r} is upright: it must have a heading"
        )
    side_m = float(np.ptp(place[:, [0, 2]], axis=0).max())
    if side_m > _MAX_SIDE_M:
        raise BadFileError(
            f"the images in {str(path)!r} lie {side_m:.0f} m apart, more than {_MAX_SIDE_M:.0f} m: "
            "check 'scale'"
        )
    begins = np.nonzero(successors[:, Action.TURN_LEFT] != NOWHERE)[0]
    yaw_rad = np.arctan2(ahead[:, 2], ahead[:, 0])
    turned = np.sin(yaw_rad[successors[begins, Action.TURN_LEFT]] - yaw_rad[begins]).sum()
    side = 1.0 if turned > 0.0 else -1.0
    return Cameras(x_m=place[:, 0], y_m=side * place[:, 2], yaw_rad=np.mod(side * yaw_rad, math.tau))


def _vector(path: Path, structs: dict[str, Any], image: str, field: str) -> Float64:
    if image not in structs:
        raise BadFileError(f"{str(path)!r} lacks image {image!r}, which annotations.json has: get it anew")
    try:
        vector = np.asarray(structs[image][field], dtype=np.float64)
    except (ValueError, TypeError) as error:
        raise BadFileError(f"{field!r} of image {image!r} in {str(path)!r} is no vector: {error}") from error
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise BadFileError(
            f"{field!r} of image {image!r} in {str(path)!r} is {vector.tolist()!r:.80}: it must be x, y and z"
        )
    return vector


def _read_names(folder: Path) -> dict[int, str]:
    return read_instance_names(folder.resolve().parent / "instance_id_map.txt") | read_instance_names(
        folder / "instance_id_map.txt"
    )


def _space(cameras: Cameras, successors: NDArray[np.int32]) -> SearchSpace:
    graph = _graph(cameras, successors)
    x_m, y_m = cameras.x_m.min() - _RANGE_MAX_M, cameras.y_m.min() - _RANGE_MAX_M
    column = ((cameras.x_m - x_m) / _CELL_M).astype(np.int64)
    row = ((cameras.y_m - y_m) / _CELL_M).astype(np.int64)
    rim = math.ceil(_RANGE_MAX_M / _CELL_M)
    mask = np.full((row.max() + rim + 1, column.max() + rim + 1), 100, dtype=np.int8)
    mask[row, column] = 0
    parameters = SearchSpaceParameters(
        headings=graph.headings,
        horizontal_view_rad=_VIEW_RAD,
        range_min_m=_RANGE_MIN_M,
        range_max_m=_RANGE_MAX_M,
        camera_forward_m=0.0,
        candidate_size_m=_CELL_M,
        max_candidates=mask.size,
    )
    origin = Pose2D(x_m=float(x_m), y_m=float(y_m))
    nothing_hides = OccupancyMap(cells=np.zeros_like(mask), resolution_m=_CELL_M, origin=origin)
    everywhere = OccupancyMap(cells=mask, resolution_m=_CELL_M, origin=origin)
    view = build_camera_view(nothing_hides, everywhere, parameters)
    unseen = ~build_observability(view, graph, parameters).seen_from_somewhere()
    rows, columns = np.nonzero(mask)
    seen_mask = mask.copy()
    seen_mask[rows[unseen], columns[unseen]] = 0
    seen = OccupancyMap(cells=seen_mask, resolution_m=_CELL_M, origin=origin)
    view = build_camera_view(nothing_hides, seen, parameters)
    return SearchSpace(
        graph=graph,
        candidates=view.candidates,
        observability=build_observability(view, graph, parameters),
        view=view,
    )


def _graph(cameras: Cameras, successors: NDArray[np.int32]) -> PoseGraph:
    count = len(successors)
    turns = successors[:, [Action.TURN_LEFT, Action.TURN_RIGHT]]
    begins, column = np.nonzero(turns != NOWHERE)
    ends = turns[begins, column]
    links = sparse.csr_matrix((np.ones(len(ends)), (begins, ends)), shape=(count, count))
    _, place = csgraph.connected_components(links, directed=False)
    size = np.bincount(place)
    turn_rad = np.abs(np.angle(np.exp(1j * (cameras.yaw_rad[ends] - cameras.yaw_rad[begins]))))
    median_rad = float(np.median(turn_rad)) if len(turn_rad) else 0.0
    return PoseGraph(
        x_m=(np.bincount(place, weights=cameras.x_m) / size)[place],
        y_m=(np.bincount(place, weights=cameras.y_m) / size)[place],
        yaw_rad=cameras.yaw_rad,
        successors=successors,
        headings=round(math.tau / median_rad) if median_rad > 0.0 else _HEADINGS,
    )


def _target(
    label: str, space: SearchSpace, cameras: Cameras, truth: list[Box], found: list[Box] | None
) -> SearchTarget:
    in_view = _fired(truth, len(space.graph))
    detections = {"perfect": _record(space, truth, ClassStatistics(precision=1.0, recall=1.0))}
    if found is not None:
        detections["noisy"] = _record(space, found, _measured(_fired(found, len(space.graph)), in_view))
    return SearchTarget(
        label=label,
        in_view=in_view,
        destination=_destination(space, cameras, truth, in_view),
        detections=detections,
    )


def _fired(boxes: list[Box], poses: int) -> Bool:
    fired = np.zeros(poses, dtype=np.bool_)
    fired[[box.pose for box in boxes]] = True
    return fired


def _measured(fired: Bool, in_view: Bool) -> ClassStatistics:
    """Precision and recall by pose; a detector that never fired has neither."""
    right = float(np.count_nonzero(fired & in_view))
    return ClassStatistics(
        precision=right / max(1.0, float(np.count_nonzero(fired))),
        recall=right / float(np.count_nonzero(in_view)),
    )


def _destination(space: SearchSpace, cameras: Cameras, boxes: list[Box], in_view: Bool) -> Bool:
    """The poses in view of the target that are nearest to its place, and those at most 0.5 m farther."""
    pose = [box.pose for box in boxes]
    bearing_rad = cameras.yaw_rad[pose] + np.array([box.bearing_rad for box in boxes])
    x_m, y_m = where_bearings_meet(cameras.x_m[pose], cameras.y_m[pose], bearing_rad)
    candidates, graph = space.candidates, space.graph
    place = int(np.argmin(np.hypot(candidates.x_m - x_m, candidates.y_m - y_m)))
    distance_m = np.hypot(graph.x_m - candidates.x_m[place], graph.y_m - candidates.y_m[place])
    return np.asarray(in_view & (distance_m <= distance_m[in_view].min() + DESTINATION_M), dtype=np.bool_)


def _record(space: SearchSpace, boxes: list[Box], statistics: ClassStatistics) -> DetectionRecord:
    """One detection for each box that is about something in view."""
    sightings: list[Sighting] = []
    for box in boxes:
        here = space.graph.pose(box.pose)
        seen = space.observability.seen_by(box.pose)
        x_m, y_m = space.candidates.x_m[seen] - here.x_m, space.candidates.y_m[seen] - here.y_m
        beside = np.arctan2(y_m, x_m) - here.yaw_rad - box.bearing_rad
        sigmas = np.angle(np.exp(1j * beside)) / max(box.half_width_rad, _LEAST_SIGMA_RAD)
        nearest = np.abs(sigmas).min(initial=math.inf)
        if nearest <= _BESIDE:
            weight = np.exp(-0.5 * (sigmas**2 - nearest**2))
            kept = weight > _NEGLIGIBLE
            sightings.append((box.pose, seen[kept], weight[kept]))
    return DetectionRecord.of(statistics, sightings)

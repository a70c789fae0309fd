"""Detections, ground truth in view and the belief, as sensor_msgs/PointCloud2."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.conversions.arrays import from_array, to_array
from robustnav_msgs_py.conversions.stamps import header, stamp_from_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import PointCloud2, PointField
from robustnav_msgs_py.values import BeliefCloud, Detections, VisibleObjects

_POSITION = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
_BOX = [("u_min", "<f4"), ("v_min", "<f4"), ("u_max", "<f4"), ("v_max", "<f4")]
DETECTION_POINT = np.dtype([*_POSITION, ("score", "<f4"), ("label", "<u4"), *_BOX])
VISIBLE_POINT = np.dtype(
    [*_POSITION, ("visible_fraction", "<f4"), ("label", "<u4"), ("instance", "<u4"), *_BOX]
)
BELIEF_POINT = np.dtype([*_POSITION, ("probability", "<f8")])

_FIELD_TYPES = {
    np.dtype("<f4"): PointField.FLOAT32,
    np.dtype("<f8"): PointField.FLOAT64,
    np.dtype("<u4"): PointField.UINT32,
}


def detections_to_message(detections: Detections) -> PointCloud2:
    """One point per detection, in the optical frame."""
    points = np.zeros(len(detections), dtype=DETECTION_POINT)
    _fill(points, ("x", "y", "z"), detections.position_m)
    _fill(points, ("u_min", "v_min", "u_max", "v_max"), detections.box_px)
    points["score"], points["label"] = detections.score, detections.label
    return _to_cloud(points, detections.stamp_ns, detections.frame_id)


def detections_from_message(message: Any) -> Detections:
    """Read detections; refused when a field is missing or of another type."""
    points = _from_cloud(message, DETECTION_POINT)
    return Detections(
        position_m=_columns(points, ("x", "y", "z")),
        score=points["score"].copy(),
        label=points["label"].copy(),
        box_px=_columns(points, ("u_min", "v_min", "u_max", "v_max")),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def visible_to_message(objects: VisibleObjects) -> PointCloud2:
    """One point per object in view, in the optical frame."""
    points = np.zeros(len(objects), dtype=VISIBLE_POINT)
    _fill(points, ("x", "y", "z"), objects.position_m)
    _fill(points, ("u_min", "v_min", "u_max", "v_max"), objects.box_px)
    points["label"], points["instance"] = objects.label, objects.instance
    points["visible_fraction"] = objects.visible_fraction
    return _to_cloud(points, objects.stamp_ns, objects.frame_id)


def visible_from_message(message: Any) -> VisibleObjects:
    """Read the ground truth of one image."""
    points = _from_cloud(message, VISIBLE_POINT)
    return VisibleObjects(
        position_m=_columns(points, ("x", "y", "z")),
        label=points["label"].copy(),
        instance=points["instance"].copy(),
        visible_fraction=points["visible_fraction"].copy(),
        box_px=_columns(points, ("u_min", "v_min", "u_max", "v_max")),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def belief_to_message(belief: BeliefCloud) -> PointCloud2:
    """One point per candidate location, in the map."""
    points = np.zeros(len(belief.probability), dtype=BELIEF_POINT)
    _fill(points, ("x", "y", "z"), belief.position_m)
    points["probability"] = belief.probability
    return _to_cloud(points, belief.stamp_ns, belief.frame_id)


def belief_from_message(message: Any) -> BeliefCloud:
    """Read a belief; refused when it does not sum to one."""
    points = _from_cloud(message, BELIEF_POINT)
    return BeliefCloud(
        position_m=_columns(points, ("x", "y", "z")),
        probability=points["probability"].copy(),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def _fill(points: NDArray[Any], names: tuple[str, ...], columns: NDArray[Any]) -> None:
    for index, name in enumerate(names):
        points[name] = columns[:, index]


def _columns(points: NDArray[Any], names: tuple[str, ...]) -> NDArray[np.float32]:
    return np.stack([points[name] for name in names], axis=1).astype(np.float32, copy=False)


def _to_cloud(points: NDArray[Any], stamp_ns: int, frame_id: str) -> PointCloud2:
    fields = [
        PointField(name=name, offset=int(offset), datatype=_FIELD_TYPES[dtype], count=1)
        for name, (dtype, offset) in _layout(points.dtype).items()
    ]
    return PointCloud2(
        header=header(stamp_ns, frame_id),
        height=1,
        width=len(points),
        fields=fields,
        is_bigendian=False,
        point_step=points.dtype.itemsize,
        row_step=points.nbytes,
        data=to_array(points.view(np.uint8)),
        is_dense=bool(np.isfinite(points["x"]).all()),
    )


def _from_cloud(message: Any, dtype: "np.dtype[Any]") -> NDArray[Any]:
    """The points of a cloud that has at least the fields of `dtype`, wherever in the point they lie."""
    offsets = {field.name: (int(field.offset), int(field.datatype)) for field in message.fields}
    for name, (field_dtype, _) in _layout(dtype).items():
        if name not in offsets or offsets[name][1] != _FIELD_TYPES[field_dtype]:
            raise BadMessageError(
                f"a point cloud needs a field {name!r} of type {field_dtype.name}; it has {sorted(offsets)}"
            )
    step, count = int(message.point_step), int(message.width) * int(message.height)
    if message.is_bigendian:
        raise BadMessageError("a point cloud is big-endian; robustnav reads little-endian clouds")
    fits = all(offsets[name][0] + field.itemsize <= step for name, (field, _) in _layout(dtype).items())
    if not fits or step == 0:
        raise BadMessageError(f"a point cloud has point_step {step}, too short for its own fields")
    data = from_array(message.data, np.uint8)
    if data.size != count * step:
        raise BadMessageError(
            f"a point cloud of {count} points of {step} bytes has {data.size} bytes of data"
        )
    names = list(_layout(dtype))
    padded = np.dtype(
        {
            "names": names,
            "formats": [dtype[name] for name in names],
            "offsets": [offsets[name][0] for name in names],
            "itemsize": step,
        }
    )
    return data.view(padded)


def _layout(dtype: "np.dtype[Any]") -> dict[str, tuple["np.dtype[Any]", int]]:
    assert dtype.fields is not None
    return {name: (entry[0], int(entry[1])) for name, entry in dtype.fields.items()}

"""The values of robustnav in a bag, by the contract's topic names, whatever namespace the robot ran in."""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from bags.reader import Bag
from robustnav_msgs_py import contract, conversions
from robustnav_msgs_py.errors import BadFileError, BadMessageError
from robustnav_msgs_py.records import Decision, DetectorRecord, DialogueState, Episode, SearchState


def _record(kind: type[Any]) -> Callable[[Any], Any]:
    return lambda message: conversions.record_from_message(message, kind)


CONVERSIONS: Mapping[str, Callable[[Any], Any]] = MappingProxyType(
    {
        "camera/image_raw": conversions.color_from_message,
        "camera/depth/image_raw": conversions.depth_from_message,
        "camera/camera_info": conversions.camera_from_message,
        "scan": conversions.scan_from_message,
        "odom": conversions.odometry_from_message,
        "map": conversions.map_from_message,
        "search/candidates": conversions.map_from_message,
        "truth/objects": conversions.objects_from_message,
        "truth/labels": conversions.labels_from_message,
        "truth/visible": conversions.visible_from_message,
        "truth/episode": _record(Episode),
        "cmd_vel": conversions.velocity_from_message,
        "goal_pose": conversions.pose_from_message,
        "initialpose": conversions.pose_from_message,
        "detections": conversions.detections_from_message,
        "detections/labels": conversions.labels_from_message,
        "belief/cloud": conversions.belief_from_message,
        "belief/map": conversions.map_from_message,
        "belief/detector": _record(DetectorRecord),
        "search/facts": conversions.text_from_message,
        "search/target": conversions.text_from_message,
        "search/state": _record(SearchState),
        "planner/decision": _record(Decision),
        "plan": conversions.path_from_message,
        "chat/from_user": conversions.text_from_message,
        "chat/to_user": conversions.text_from_message,
        "dialogue/state": _record(DialogueState),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedValue:
    """A value as it was said on the contract's topic `topic`, at wall-clock time `log_time_ns`."""

    topic: str
    log_time_ns: int
    value: Any


def namespace_of(bag: Bag, topic: str) -> str:
    """Namespace in which the contract's `topic` was recorded, "" for none.

    Raises BadFileError where it was recorded of several robots, so that one must be chosen.
    """
    found = sorted(row.name.removesuffix("/" + topic) for row in bag.topics if row.name.endswith("/" + topic))
    if len(found) > 1:
        raise BadFileError(f"{bag.path} holds {topic!r} of several robots; choose one of {', '.join(found)}")
    return found[0] if found else ""


def recorded_values(bag: Bag, topics: Collection[str], *, namespace: str = "") -> Iterator[RecordedValue]:
    """Values of the contract's `topics` of the robot in `namespace`, in order of log time.

    Raises BadMessageError, with topic and time, where a message does not hold what its type promises, and
    BadFileError as `Bag.messages` does.
    """
    recorded_name = {_full_name(topic, namespace): topic for topic in topics}
    for recorded in bag.messages(recorded_name.keys()):
        topic = recorded_name[recorded.topic]
        if recorded.type != contract.topic(topic).type:
            continue
        try:
            value = CONVERSIONS[topic](recorded.message)
        except BadMessageError as error:
            raise BadMessageError(
                f"{bag.path}, {recorded.topic} at {recorded.log_time_ns / 1e9:.3f} s: {error}"
            ) from error
        yield RecordedValue(topic=topic, log_time_ns=recorded.log_time_ns, value=value)


def _full_name(topic: str, namespace: str) -> str:
    return f"/{namespace.strip('/')}/{topic}" if namespace.strip("/") else f"/{topic}"

"""How good the detector of a recorded run was, from a bag with ground truth."""

from collections.abc import Sequence

import numpy as np

from bags.metrics_settings import settings_of
from bags.reader import Bag
from bags.recorded_values import namespace_of, recorded_values
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.values import Detections, VisibleObjects
from robustnav_nodes.benchmarks.detection_pictures import floor_distance_m
from robustnav_nodes.benchmarks.detection_tally import Tally, TrueObjects
from robustnav_nodes.detection.boxes import Boxes

TOPICS = ("truth/visible", "truth/labels", "detections", "detections/labels")
UNKNOWN = np.uint32(2**32 - 1)


def detection_figures(
    bag: Bag,
    *,
    namespace: str | None = None,
    score_min: float = 0.0,
    mount: CameraMount | None = None,
    into: Tally | None = None,
) -> Tally:
    """What the detector said of each image beside what the image showed, matched by their stamps.

    score_min: precision and recall are of scores from here up; the node has dropped lower ones already.
    mount: how the camera sits on the robot, to tell distances on the floor; None: as the bag's manifest
    says. into: the tally of other bags, to which this one is added. A bag knows boxes, not pixels: an object
    counts as large as its box times the part of it that is visible. Raises BadFileError where ground truth or
    detections were not recorded, were never of the same image, or are of other classes than those in `into`.
    """
    if namespace is None:
        namespace = namespace_of(bag, "detections")
    seen: dict[int, VisibleObjects] = {}
    said: dict[int, Detections] = {}
    names: dict[str, tuple[str, ...]] = {}
    for heard in recorded_values(bag, TOPICS, namespace=namespace):
        if heard.topic == "truth/visible":
            seen[heard.value.stamp_ns] = heard.value
        elif heard.topic == "detections":
            said[heard.value.stamp_ns] = heard.value
        else:
            names[heard.topic] = heard.value
    missing = [topic for topic in ("truth/labels", "detections/labels") if topic not in names]
    missing += [topic for topic, values in (("truth/visible", seen), ("detections", said)) if not values]
    if missing:
        raise BadFileError(
            f"{bag.path} has no {', '.join(missing)}: the detector can be measured only in a bag with ground "
            "truth, such as the simulator's"
        )
    tally = Tally(names["detections/labels"], score_min) if into is None else into
    if tally.labels != names["detections/labels"]:
        raise BadFileError(
            f"{bag.path} was recorded with a detector of other classes than the bags before it: measure it "
            "by itself"
        )
    mount = mount or settings_of(bag.manifest, namespace).mount
    before = tally.images
    for stamp_ns in sorted(seen.keys() & said.keys()):
        truth = _in_names(seen[stamp_ns], names["truth/labels"], tally.labels, mount)
        tally.add(truth, _known(said[stamp_ns], names["truth/labels"], tally.labels))
    if tally.images == before:
        raise BadFileError(f"{bag.path} has ground truth and detections, but never of the same image")
    return tally


def _in_names(
    seen: VisibleObjects, true_names: Sequence[str], labels: Sequence[str], mount: CameraMount
) -> TrueObjects:
    """The objects whose classes the detector knows, by its numbers."""
    number_of = {name: number for number, name in enumerate(labels)}
    numbers = np.array([number_of.get(true_names[label], UNKNOWN) for label in seen.label], dtype=np.uint32)
    known = numbers != UNKNOWN
    size_px = np.prod(seen.box_px[:, 2:] - seen.box_px[:, :2], axis=1)
    return TrueObjects(
        box_px=seen.box_px[known],
        label=numbers[known],
        distance_m=floor_distance_m(seen, mount)[known],
        visible=seen.visible_fraction[known].astype(np.float64),
        pixels=(size_px * seen.visible_fraction)[known].astype(np.float64),
    )


def _known(detections: Detections, true_names: Sequence[str], labels: Sequence[str]) -> Boxes:
    """Detections of classes of which the truth is known."""
    judged = [number for number, name in enumerate(labels) if name in true_names]
    kept = np.isin(detections.label, np.array(judged, dtype=np.uint32))
    return Boxes(box_px=detections.box_px[kept], score=detections.score[kept], label=detections.label[kept])

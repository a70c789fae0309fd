"""What the camera showed when the robot decided, as small pictures with the boxes of the detections."""

import base64
import io
import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from bags.recorded_values import RecordedValue
from bags.search_run import Heard
from robustnav_msgs_py.values import ColorImage, Detections

MOST_PICTURES = 60
WIDEST_GAP_S = 2.0  # between pictures, where that does not make them too many
WIDEST_PX = 320
JPEG_QUALITY = 72
SAME_IMAGE_NS = 300_000_000  # a detection that is stamped farther from an image was made in another


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A detection in a picture, in parts of its width and height; `wanted`: of the target's class."""

    left: float
    top: float
    right: float
    bottom: float
    label: str
    score: float
    wanted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraFrame:
    """What the camera showed at `t_s`. jpeg: base64; `decision` counts from 0, None where none was made.

    The last one is of the end.
    """

    t_s: float
    decision: int | None
    width: int
    height: int
    jpeg: str
    boxes: tuple[Box, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """A moment that a picture is wanted of."""

    log_time_ns: int
    t_s: float
    decision: int | None


def chosen_moments(moments: Sequence[Moment]) -> tuple[Moment, ...]:
    """At most `MOST_PICTURES` of them, evenly spread, the first and the last among them.

    Where they are fewer, moments without a decision are put into the gaps between them, so that the picture
    keeps up with a robot that drives for long on one decision.
    """
    if len(moments) > MOST_PICTURES:
        places = np.linspace(0, len(moments) - 1, MOST_PICTURES).round().astype(int)
        return tuple(moments[place] for place in places)
    if len(moments) < 2:
        return tuple(moments)
    spare = MOST_PICTURES - len(moments)
    gap_s = max(WIDEST_GAP_S, (moments[-1].t_s - moments[0].t_s) / max(spare, 1))
    chosen = [moments[0]]
    for before, after in itertools.pairwise(moments):
        count = min(int((after.t_s - before.t_s) / gap_s), spare)
        spare -= count
        parts = [(number + 1) / (count + 1) for number in range(count)]
        chosen += [_between(before, after, part) for part in parts]
        chosen.append(after)
    return tuple(chosen)


def _between(before: Moment, after: Moment, part: float) -> Moment:
    log_time_ns = before.log_time_ns + round(part * (after.log_time_ns - before.log_time_ns))
    t_s = round(before.t_s + part * (after.t_s - before.t_s), 3)
    return Moment(log_time_ns=log_time_ns, t_s=t_s, decision=None)


def camera_frames(
    images: Iterable[RecordedValue],
    moments: Sequence[Moment],
    detections: Sequence[Heard[Detections]],
    labels: Sequence[str],
    target: str,
) -> tuple[CameraFrame, ...]:
    """The last picture before each of `moments`, which are in order; none before the first image.

    Holds one image at a time in memory.
    """
    stamps = np.array([heard.value.stamp_ns for heard in detections], dtype=np.int64)
    frames = []
    for moment, image in _pictures(images, moments):
        boxes: tuple[Box, ...] = ()
        if len(stamps):
            nearest = int(np.argmin(np.abs(stamps - image.stamp_ns)))
            if abs(int(stamps[nearest]) - image.stamp_ns) <= SAME_IMAGE_NS:
                boxes = _boxes(detections[nearest].value, image, labels, target)
        frames.append(_frame(moment, image, boxes))
    return tuple(frames)


def _pictures(
    images: Iterable[RecordedValue], moments: Sequence[Moment]
) -> Iterator[tuple[Moment, ColorImage]]:
    waiting = list(moments)
    last: ColorImage | None = None
    for image in images:
        while waiting and waiting[0].log_time_ns < image.log_time_ns:
            moment = waiting.pop(0)
            if last is not None:
                yield moment, last
        last = image.value
        if not waiting:
            return
    for moment in waiting:
        if last is not None:
            yield moment, last


def _boxes(found: Detections, image: ColorImage, labels: Sequence[str], target: str) -> tuple[Box, ...]:
    height, width = image.pixels.shape[:2]
    boxes = []
    for (u_min, v_min, u_max, v_max), score, number in zip(
        found.box_px.tolist(), found.score.tolist(), found.label.tolist(), strict=True
    ):
        if not (u_max > u_min and v_max > v_min):  # a detector that tells places only
            continue
        label = labels[number] if number < len(labels) else f"class {number}"
        boxes.append(
            Box(
                left=_part(u_min, width),
                top=_part(v_min, height),
                right=_part(u_max, width),
                bottom=_part(v_max, height),
                label=label,
                score=round(score, 3),
                wanted=label == target,
            )
        )
    return tuple(sorted(boxes, key=lambda box: box.wanted))  # what is drawn last lies on top


def _part(position_px: float, size_px: int) -> float:
    return round(min(max(position_px / size_px, 0.0), 1.0), 4)


def _frame(moment: Moment, image: ColorImage, boxes: tuple[Box, ...]) -> CameraFrame:
    picture = Image.fromarray(image.pixels)
    if picture.width > WIDEST_PX:
        picture = picture.resize((WIDEST_PX, max(1, round(picture.height * WIDEST_PX / picture.width))))
    content = io.BytesIO()
    picture.save(content, "JPEG", quality=JPEG_QUALITY)
    return CameraFrame(
        t_s=moment.t_s,
        decision=moment.decision,
        width=picture.width,
        height=picture.height,
        jpeg=base64.b64encode(content.getvalue()).decode("ascii"),
        boxes=boxes,
    )

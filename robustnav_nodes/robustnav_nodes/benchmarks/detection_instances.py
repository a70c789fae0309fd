"""Whether a detector tells this mug from others: one picture of it, then five of its class to choose from."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.benchmarks.detection_pictures import Picture, floor_distance_m
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.parameters import DetectionParameters
from robustnav_nodes.detection.placement import place_boxes

CHOICES = 5
NEAR_M, PIXELS_MIN, VISIBLE_MIN = 2.5, 150.0, 0.5


class Matcher(Protocol):
    """Compares boxes with one reference."""

    def scores(self, image: ColorImage, box_px: Float32, height_m: Float32 | None = None) -> Float32:
        """For boxes [n, 4] how sure it is that each is the one: float32 [n]."""


# From an image, the box [4] of the reference in it, and its height (m).
MatcherMaker = Callable[[ColorImage, Float32, float], Matcher]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sighting:
    """An object near by, as one picture shows it: `thing` is its home's seed and its number there."""

    thing: tuple[int, int]
    label: str
    image: ColorImage
    box_px: Float32
    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One choice among CHOICES things of class `label`."""

    label: str
    is_right: bool


def sightings(picture: Picture, parameters: DetectionParameters) -> Iterator[Sighting]:
    """The objects of a picture that are near, large and whole enough, in their true boxes."""
    seen = picture.seen
    near = floor_distance_m(seen, CameraMount()) <= NEAR_M
    rows = np.flatnonzero(
        near & (picture.pixels >= PIXELS_MIN) & (seen.visible_fraction >= VISIBLE_MIN)
    ).astype(np.uint32)
    boxes = Boxes(box_px=seen.box_px[rows], score=np.ones(len(rows), dtype=np.float32), label=rows)
    placed, _ = place_boxes(boxes, picture.depth, picture.camera, parameters)
    for row, box, place in zip(placed.label, placed.box_px, placed.position_m, strict=True):
        yield Sighting(
            thing=(picture.home, int(seen.instance[row])),
            label=picture.labels[seen.label[row]],
            image=picture.color,
            box_px=box,
            height_m=float((box[3] - box[1]) * place[2] / picture.camera.fy),
        )


def trials(found: Sequence[Sighting], matcher: MatcherMaker, rng: np.random.Generator) -> list[Trial]:
    """One for each thing that was seen twice: another view of it among one view each of four others.

    The others are of its class, of its own home where it has so many, and then of other homes.
    """
    by_class: dict[str, dict[tuple[int, int], list[Sighting]]] = defaultdict(lambda: defaultdict(list))
    for sighting in found:
        by_class[sighting.label][sighting.thing].append(sighting)
    rows = []
    for label, things in by_class.items():
        for thing, own in things.items():
            others = sorted((other for other in things if other != thing), key=lambda o: o[0] != thing[0])
            if len(own) < 2 or len(others) < CHOICES - 1:
                continue
            reference, again = (own[at] for at in rng.choice(len(own), 2, replace=False))
            views = [things[other] for other in others[: CHOICES - 1]]
            shown = [again, *(view[int(rng.integers(len(view)))] for view in views)]
            asked = matcher(reference.image, reference.box_px, reference.height_m)
            scores = [_score(asked, choice) for choice in shown]
            rows.append(Trial(label=label, is_right=scores[0] > max(scores[1:])))
    return rows


def top1(rows: Sequence[Trial], label: str | None = None) -> float | None:
    """Share of right choices, of one class or of all; None without a trial. Chance has 1 / CHOICES."""
    right = [row.is_right for row in rows if label in (None, row.label)]
    return float(np.mean(right)) if right else None


def _score(matcher: Matcher, choice: Sighting) -> float:
    height_m = np.array([choice.height_m], dtype=np.float32)
    return float(matcher.scores(choice.image, choice.box_px[np.newaxis], height_m)[0])

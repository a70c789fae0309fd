"""This one among five of its class, with matchers whose answers are known."""

from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.benchmarks.detection_instances import Matcher, Sighting, sightings, top1, trials
from robustnav_nodes.benchmarks.detection_pictures import pictures
from robustnav_nodes.detection.parameters import DetectionParameters


def seen(home: int, number: int, label: str = "mug") -> Sighting:
    """The picture's first pixel tells which thing it shows."""
    pixels = np.full((4, 4, 3), 10 * home + number, np.uint8)
    image = ColorImage(pixels=pixels, stamp_ns=1, frame_id="c")
    box_px = np.zeros(4, np.float32)
    return Sighting(thing=(home, number), label=label, image=image, box_px=box_px, height_m=0.1)


class ByPixel:
    """Sure where the first pixels agree; `sense` 0 sees nothing, -1 takes every other for it."""

    def __init__(self, image: ColorImage, sense: float) -> None:
        self._own = int(image.pixels[0, 0, 0])
        self._sense = sense

    def scores(self, image: ColorImage, box_px: Float32, height_m: Float32 | None = None) -> Float32:
        assert height_m is not None
        same = float(image.pixels[0, 0, 0] == self._own)
        return np.full(len(box_px), 0.5 + self._sense * (same - 0.5), np.float32)


def maker(sense: float) -> Callable[[ColorImage, Float32, float], Matcher]:
    return lambda image, _box, _height: ByPixel(image, sense)


@pytest.mark.parametrize(("sense", "share"), [(1.0, 1.0), (0.0, 0.0), (-1.0, 0.0)])
def test_only_the_right_one_counts(sense: float, share: float) -> None:
    """Five mugs seen twice; a tie is no answer."""
    found = [seen(1, number) for number in range(5)] * 2
    rows = trials(found, maker(sense), np.random.default_rng(0))
    assert (len(rows), top1(rows), top1(rows, "mug"), top1(rows, "book")) == (5, share, share, None)


def test_what_was_seen_once_is_no_reference_and_four_others_are_needed() -> None:
    rng = np.random.default_rng(0)
    once = [seen(1, number) for number in range(5)]
    assert trials(once, maker(1.0), rng) == []
    assert len(trials([*once, seen(1, 0)], maker(1.0), rng)) == 1
    assert trials([*once[:4], seen(1, 0)], maker(1.0), rng) == []
    assert trials([*once[:4], seen(1, 0), seen(2, 0, "book")], maker(1.0), rng) == []
    assert top1([]) is None


def test_pictures_of_homes_with_look_alikes_show_several_of_a_class() -> None:
    pytest.importorskip("pybullet")
    found = [
        sighting
        for picture in pictures([500_000], 30, "none", look_alikes=True)
        for sighting in sightings(picture, DetectionParameters())
    ]
    assert len({sighting.thing for sighting in found if sighting.label == "mug"}) >= 3
    assert all(0.01 < sighting.height_m < 2.0 for sighting in found)

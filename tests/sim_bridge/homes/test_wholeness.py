"""No part of a thing floats beside the rest of it: from every part, touching parts lead to the ground."""

import numpy as np
import pytest

from sim_bridge.homes.furniture.catalogue import KINDS, design
from sim_bridge.homes.objects.catalogue import CLASSES, LABELS
from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Part

# A knob may stand a hair before what carries it.
TOUCH_M = 0.005


def loose_parts(parts: tuple[Part, ...], held: np.ndarray) -> list[Part]:
    """The parts that hang together with none of those that are `held`: bool [parts]."""
    centre = np.array([part.centre_m for part in parts])
    half = np.array([part.size_m for part in parts]) / 2.0 + TOUCH_M / 2.0
    apart = np.abs(centre[:, None] - centre[None]) - (half[:, None] + half[None])
    touching = (apart <= 0.0).all(axis=2)
    reached = held.copy()
    for _ in parts:
        reached |= touching[reached].any(axis=0)
    return [part for part, found in zip(parts, reached, strict=True) if not found]


def lowest_m(parts: tuple[Part, ...]) -> np.ndarray:
    return np.array([part.centre_m[2] - part.size_m[2] / 2.0 for part in parts])


@pytest.mark.parametrize("kind", KINDS)
def test_furniture_stands_on_the_floor_with_all_its_parts(kind: str) -> None:
    entry = KINDS[kind]
    for width_m in entry.widths_m:
        parts = design(kind, Style(width_m=width_m, main=entry.mains[0], accent=entry.accents[0])).parts
        assert loose_parts(parts, lowest_m(parts) <= TOUCH_M) == []


@pytest.mark.parametrize("item", CLASSES, ids=LABELS)
def test_objects_are_in_one_piece(item: ObjectClass) -> None:
    for look in {(look.pattern, look.size): look for look in item.looks.all()}.values():
        parts = item.parts(look)
        first = lowest_m(parts) <= lowest_m(parts).min() + 1e-6
        assert loose_parts(parts, first) == [], look


def test_a_part_that_floats_is_found() -> None:
    parts = design(
        "chair", Style(width_m=0.45, main=KINDS["chair"].mains[0], accent=KINDS["chair"].mains[0])
    ).parts
    seat = [part for part in parts if part.centre_m[2] < 0.3]
    assert loose_parts((seat[0], parts[-1]), np.array([True, False])) == [parts[-1]]

"""What is moved into homes: cardboard boxes, suitcases, clothes racks and folding screens.

Frames and footprints are like furniture's: x out of the front, multiples of the floor plan's resolution.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sim_bridge.homes.materials import Material, material
from sim_bridge.homes.shapes import Part, Vector3, box, cylinder

T = TypeVar("T")


def _materials(*words: str) -> tuple[Material, ...]:
    return tuple(material(line) for line in words)


MATERIALS: dict[str, tuple[Material, ...]] = {
    "cardboard": (
        material("#b88f61 paper"),
        material("#a88054 paper"),
        material("#c29e73 paper"),
    ),
    "tape": (
        material("#d1c29e paper"),
        material("#735433 paper"),
    ),
    "shell": (
        material("#1f2126 plastic"),
        material("#29426b plastic"),
        material("#8c1f29 plastic"),
        material("#9ea3a8 plastic"),
    ),
    "rubber": _materials("#141414 plastic"),
    "metal": (
        material("#b2b8bf metal"),
        material("#333338 metal"),
    ),
    "cloth": (
        material("#3d4c6b fabric"),
        material("#ad9e8a fabric"),
        material("#612933 fabric"),
        material("#dbd9d1 fabric"),
        material("#4c614c fabric"),
        material("#29292e fabric"),
    ),
    "wood": (
        material("#6b4226 wood"),
        material("#a88052 wood"),
    ),
    "paper": (
        material("#e6dec7 paper"),
        material("#d6ccb8 paper"),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class OccluderDesign:
    """An occluder that stands nowhere yet; `size_m` is its depth, width and height."""

    kind: str
    size_m: Vector3
    parts: tuple[Part, ...]


def pick(rng: np.random.Generator, options: Sequence[T]) -> T:
    """One of the options."""
    return options[int(rng.integers(len(options)))]


def _cardboard_boxes(rng: np.random.Generator) -> OccluderDesign:
    """One to three closed boxes on top of each other, each with tape along its middle."""
    depth_m, width_m = pick(rng, (0.30, 0.40)), pick(rng, (0.40, 0.50, 0.60))
    tape_m, skin_m, slip_m = 0.05, 0.004, 0.03
    parts: list[Part] = []
    z_m = 0.0
    for level in range(int(rng.integers(1, 4))):
        high_m = pick(rng, (0.30, 0.35, 0.40))
        # The upper ones are smaller and stand a little askew, within the footprint.
        size_x, size_y = depth_m - 2.0 * slip_m * level, width_m - 2.0 * slip_m * level
        shift = slip_m * level
        x_m, y_m = rng.uniform(-shift, shift), rng.uniform(-shift, shift)
        card, tape = pick(rng, MATERIALS["cardboard"]), pick(rng, MATERIALS["tape"])
        parts.append(box((x_m, y_m, z_m + high_m / 2.0), (size_x, size_y, high_m - skin_m), card))
        parts.append(box((x_m, y_m, z_m + high_m / 2.0), (tape_m, size_y - skin_m, high_m), tape))
        z_m += high_m
    return OccluderDesign(kind="cardboard boxes", size_m=(depth_m, width_m, z_m), parts=tuple(parts))


def _suitcase(rng: np.random.Generator) -> OccluderDesign:
    """Upright on four wheels, handle pulled out."""
    depth_m, width_m, shell_m = 0.30, 0.50, pick(rng, (0.55, 0.65, 0.75))
    wheel_m, rib_m, handle_m, bar_m = 0.06, 0.02, 0.35, 0.02
    shell, metal, rubber = (pick(rng, MATERIALS[name]) for name in ("shell", "metal", "rubber"))
    darker = shell.shaded(0.7)
    inner_m = depth_m - 2.0 * rib_m
    parts = [box((0.0, 0.0, wheel_m + shell_m / 2.0), (inner_m, width_m - 2.0 * rib_m, shell_m), shell)]
    parts += [
        box((0.0, y_m, wheel_m + shell_m / 2.0), (depth_m, rib_m, shell_m * 0.9), darker)
        for y_m in (-0.15, -0.05, 0.05, 0.15)
    ]
    wheel_x, wheel_y = (inner_m - wheel_m) / 2.0, width_m / 2.0 - wheel_m
    parts += [
        cylinder((sx * wheel_x, sy * wheel_y, wheel_m / 2.0), wheel_m, wheel_m, rubber)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    top_m = wheel_m + shell_m
    back_m = -inner_m / 2.0 + bar_m
    parts += [
        box((back_m, sy * 0.09, top_m + handle_m / 2.0), (bar_m, bar_m, handle_m), metal) for sy in (-1, 1)
    ]
    parts.append(box((back_m, 0.0, top_m + handle_m - bar_m / 2.0), (bar_m, 0.20, bar_m), rubber))
    return OccluderDesign(kind="suitcase", size_m=(depth_m, width_m, top_m + handle_m), parts=tuple(parts))


def _clothes_rack(rng: np.random.Generator) -> OccluderDesign:
    """A rail on two feet, full of clothes of several lengths."""
    depth_m, width_m, height_m = 0.50, pick(rng, (0.90, 1.10)), 1.60
    tube_m, foot_m, gap_m = 0.03, 0.04, 0.02
    metal = pick(rng, MATERIALS["metal"])
    post_y = (width_m - tube_m) / 2.0
    rail_z = height_m - tube_m / 2.0
    parts = [box((0.0, 0.0, rail_z), (tube_m, width_m, tube_m), metal)]
    for sign in (-1, 1):
        parts.append(box((0.0, sign * post_y, foot_m / 2.0), (depth_m, tube_m, foot_m), metal))
        parts.append(
            box((0.0, sign * post_y, (foot_m + rail_z) / 2.0), (tube_m, tube_m, rail_z - foot_m), metal)
        )
    pieces = 8
    step_m = (width_m - 4.0 * tube_m) / pieces
    for number in range(pieces):
        y_m = (number + 0.5) * step_m - pieces * step_m / 2.0
        long_m, broad_m = rng.uniform(0.70, 1.20), rng.uniform(0.36, 0.46)
        size: Vector3 = (broad_m, step_m - gap_m, long_m)
        parts.append(box((0.0, y_m, rail_z - tube_m - long_m / 2.0), size, pick(rng, MATERIALS["cloth"])))
    return OccluderDesign(kind="clothes rack", size_m=(depth_m, width_m, height_m), parts=tuple(parts))


def _folding_screen(rng: np.random.Generator) -> OccluderDesign:
    """Panels of paper in wooden frames that stand in steps, one before and one behind: boxes do not slant."""
    panels, panel_m, height_m = pick(rng, (3, 4)), 0.40, 1.60
    frame_m, thick_m, step_m = 0.04, 0.03, 0.10
    depth_m, width_m = 2.0 * step_m, panels * panel_m
    wood, paper = pick(rng, MATERIALS["wood"]), pick(rng, MATERIALS["paper"])
    parts: list[Part] = []
    for number in range(panels):
        x_m = (depth_m - thick_m) / 2.0 * (1 if number % 2 else -1)
        y_m = (number + 0.5) * panel_m - width_m / 2.0
        inner_m = panel_m - 2.0 * frame_m
        middle_z = height_m / 2.0
        parts.append(box((x_m, y_m, middle_z), (thick_m / 2.0, inner_m, height_m - 2.0 * frame_m), paper))
        parts += [
            box((x_m, y_m + sign * (panel_m - frame_m) / 2.0, middle_z), (thick_m, frame_m, height_m), wood)
            for sign in (-1, 1)
        ]
        parts += [
            box((x_m, y_m, z_m), (thick_m, inner_m, frame_m), wood)
            for z_m in (frame_m / 2.0, middle_z, height_m - frame_m / 2.0)
        ]
        if number:
            seam_y = y_m - panel_m / 2.0
            parts.append(box((0.0, seam_y, middle_z), (depth_m, thick_m, height_m), wood))
    return OccluderDesign(kind="folding screen", size_m=(depth_m, width_m, height_m), parts=tuple(parts))


DESIGNS: tuple[Callable[[np.random.Generator], OccluderDesign], ...] = (
    _cardboard_boxes,
    _suitcase,
    _clothes_rack,
    _folding_screen,
)

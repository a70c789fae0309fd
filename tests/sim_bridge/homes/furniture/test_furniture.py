"""Kinds of furniture: whole in every style, inside their footprints, with places that objects can use."""

from itertools import combinations, product

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.furniture.carpentry import GAP_M, Design
from sim_bridge.homes.furniture.catalogue import (
    KINDS,
    build_furniture,
    default_style,
    design,
    draw_style,
)
from sim_bridge.homes.scene import SceneFurniture, Style
from sim_bridge.homes.shapes import Part, Shape, extent

GRID_M = 0.05
TOLERANCE_M = 1e-6
MAX_PARTS = 25
# Books are parts too.
MAX_PARTS_OF = {"bookcase": 40}
# Rings on a hob and cushions may end this far below the height where objects stand.
SUNK_M = 0.012
# Between two cushions is a seam.
SUPPORTED_SHARE = 0.85
# At least so tall an object fits on every surface.
HEADROOM_M = 0.25
CARRIERS = """kitchen counter, sink unit, stove, dining table, chair, stool, sofa, armchair, coffee table,
side table, tv stand, sideboard, low shelf, bed, single bed, nightstand, dresser, desk, office chair,
filing cabinet, washstand, toilet, bathtub, washing machine, dryer, ironing board, console table, shoe bench,
toy chest, mat""".replace("\n", " ").split(", ")
TALL = ["fridge", "cupboard", "bookcase", "wardrobe", "bathroom cabinet"]
WITH_HANGING = [
    "sofa",
    "sideboard",
    "low shelf",
    "bed",
    "single bed",
    "dresser",
    "desk",
    "console table",
]


def designs() -> list[tuple[str, Design]]:
    """Every kind in each of its widths, and with each of its materials once."""
    found = []
    for kind, entry in KINDS.items():
        looks = max(len(entry.mains), len(entry.accents), len(entry.widths_m))
        for index in range(looks):
            style = Style(
                width_m=entry.widths_m[index % len(entry.widths_m)],
                main=entry.mains[index % len(entry.mains)],
                accent=entry.accents[index % len(entry.accents)],
            )
            found.append((kind, design(kind, style)))
    return found


ALL = designs()


def low_high(part: Part) -> tuple[np.ndarray, np.ndarray]:
    centre, half = np.array(part.centre_m), np.array(part.size_m) / 2.0
    return centre - half, centre + half


def test_there_are_the_35_kinds_that_everyone_agreed_on():
    assert sorted(KINDS) == sorted(CARRIERS + TALL)
    assert len(KINDS) == 35


def test_no_part_reaches_out_of_its_footprint_or_below_the_floor():
    for kind, made in ALL:
        low, high = extent(made.parts)
        half = (made.depth_m / 2.0, made.width_m / 2.0)
        assert low[2] >= -TOLERANCE_M, kind
        assert high[2] <= made.height_m + TOLERANCE_M, kind
        for axis in (0, 1):
            assert low[axis] >= -half[axis] - TOLERANCE_M, kind
            assert high[axis] <= half[axis] + TOLERANCE_M, kind


def test_every_piece_stands_on_the_floor():
    for kind, made in ALL:
        assert extent(made.parts)[0][2] == pytest.approx(0.0, abs=1e-9), kind


def test_the_parts_fill_the_footprint_that_the_map_shows():
    for kind, made in ALL:
        low, high = extent(made.parts)
        assert high[0] - low[0] >= made.depth_m - 0.05, kind
        assert high[1] - low[1] >= made.width_m - 0.05, kind


def test_footprints_are_multiples_of_the_floor_plans_resolution():
    for kind, made in ALL:
        for length_m in (made.depth_m, made.width_m):
            assert length_m / GRID_M == pytest.approx(round(length_m / GRID_M), abs=1e-9), kind


def test_no_piece_has_more_parts_than_a_camera_can_draw_many_of():
    for kind, made in ALL:
        assert len(made.parts) <= MAX_PARTS_OF.get(kind, MAX_PARTS), kind


def test_no_part_is_hidden_in_a_box():
    for kind, made in ALL:
        for outer, inner in product(made.parts, made.parts):
            if outer is inner or outer.shape is not Shape.BOX:
                continue
            (low, high), (inner_low, inner_high) = low_high(outer), low_high(inner)
            within = (inner_low >= low - TOLERANCE_M).all() and (inner_high <= high + TOLERANCE_M).all()
            assert not within, f"{kind}: {inner} is inside {outer}"


def test_no_two_faces_of_different_materials_share_a_place():
    """Where they do, a camera sees one through the other in patches."""
    for kind, made in ALL:
        boxes = [(part, *low_high(part)) for part in made.parts if part.shape is Shape.BOX]
        for (a, a_low, a_high), (b, b_low, b_high) in combinations(boxes, 2):
            if a.material == b.material:
                continue
            for axis in range(3):
                others = [other for other in range(3) if other != axis]
                shared = np.minimum(a_high, b_high)[others] - np.maximum(a_low, b_low)[others]
                if (shared <= 0.005).any():
                    continue
                # What faces the floor is seen by nobody.
                bottom = axis == 2 and a_low[2] == pytest.approx(0.0, abs=1e-9)
                at_low = abs(a_low[axis] - b_low[axis]) < 5e-4 and not bottom
                at_high = abs(a_high[axis] - b_high[axis]) < 5e-4
                shares = at_low or at_high
                assert not shares, f"{kind}: {a} and {b} share a face across axis {axis}"


def test_carriers_carry_and_tall_pieces_hide():
    for kind, made in ALL:
        assert made.tall == (kind in TALL), kind
        standing = [surface for surface in made.surfaces if not surface.hangs]
        assert bool(standing) == (kind in CARRIERS), kind
        hanging = [surface for surface in made.surfaces if surface.hangs]
        assert bool(hanging) == (kind in WITH_HANGING), kind


def test_surfaces_are_free_above_and_filled_below():
    for kind, made in ALL:
        for surface in made.surfaces:
            if surface.hangs:
                continue
            area, height_m = surface.area, surface.height_m
            tops = []
            points = [
                (x, y)
                for x in np.linspace(area.x_min_m, area.x_max_m, 7)
                for y in np.linspace(area.y_min_m, area.y_max_m, 7)
            ]
            spans = [low_high(part) for part in made.parts]
            for low, high in spans:
                beside = (
                    high[0] <= area.x_min_m + TOLERANCE_M
                    or low[0] >= area.x_max_m - TOLERANCE_M
                    or high[1] <= area.y_min_m + TOLERANCE_M
                    or low[1] >= area.y_max_m - TOLERANCE_M
                )
                outside = high[2] <= height_m + TOLERANCE_M or low[2] >= height_m + HEADROOM_M
                assert beside or outside, kind
            for x, y in points:
                below = [
                    high[2]
                    for low, high in spans
                    if low[0] <= x <= high[0] and low[1] <= y <= high[1] and high[2] <= height_m + TOLERANCE_M
                ]
                tops.append(max(below, default=0.0))
            supported = np.mean(np.array(tops) >= height_m - SUNK_M)
            assert supported >= SUPPORTED_SHARE, f"{kind}: too little is under {surface}"
            assert area.width_m >= 0.10, kind
            assert area.depth_m >= 0.20, kind


def test_things_hang_on_the_wall_just_behind_a_piece_within_a_cameras_view():
    for kind, made in ALL:
        for surface in made.surfaces:
            if surface.hangs:
                assert surface.area.x_min_m == pytest.approx(-made.depth_m / 2.0 - GAP_M), kind
                assert surface.area.width_m == pytest.approx(0.05), kind
                assert surface.area.depth_m == pytest.approx(made.width_m - 0.2), kind
                assert 0.95 <= surface.height_m <= 1.15, kind


def test_a_low_shelf_has_two_boards_and_a_mat_lies_on_the_floor():
    shelf = design("low shelf", default_style("low shelf"))
    assert [surface.height_m for surface in shelf.surfaces if not surface.hangs] == [0.70, 0.35]
    assert design("mat", default_style("mat")).surfaces[0].height_m == 0.01


def test_every_drawn_style_can_be_built_and_comes_again_with_its_seed():
    for seed in range(200):
        for kind in KINDS:
            style = draw_style(np.random.default_rng(seed), kind)
            assert style == draw_style(np.random.default_rng(seed), kind)
            entry = KINDS[kind]
            assert style.width_m in entry.widths_m


def piece(kind: str, width_m: float) -> SceneFurniture:
    looks = KINDS["chair"]
    return SceneFurniture(
        name=f"{kind} 1",
        kind=kind,
        room="kitchen",
        x_m=1.0,
        y_m=2.0,
        quarter_turns=1,
        style=Style(width_m=width_m, main=looks.mains[0], accent=looks.accents[0]),
    )


def test_a_described_piece_keeps_its_description():
    described = piece("desk", 1.4)
    built = build_furniture(described)
    assert (built.name, built.kind, built.room) == ("desk 1", "desk", "kitchen")
    assert (built.x_m, built.y_m, built.quarter_turns) == (1.0, 2.0, 1)
    assert built.style == described.style
    assert (built.footprint.width_m, built.footprint.depth_m) == pytest.approx((1.4, 0.65))
    assert built.carries


def test_a_slip_of_the_pen_in_a_kind_is_answered_with_the_nearest():
    with pytest.raises(BadSceneError, match="'coffe table'; did you mean 'coffee table'"):
        build_furniture(piece("coffe table", 0.9))


def test_an_unknown_kind_is_answered_with_all_that_there_are():
    with pytest.raises(BadSceneError, match="'zzz'; there are kitchen counter, sink unit"):
        build_furniture(piece("zzz", 0.9))


@pytest.mark.parametrize("width_m", [0.5, 3.0, float("nan"), -1.0])
def test_a_width_that_a_kind_cannot_have_is_refused(width_m: float):
    with pytest.raises(BadSceneError, match=r"a desk is 1.2..1.4 m wide, not"):
        build_furniture(piece("desk", width_m))


def test_a_width_between_those_of_the_catalogue_is_fine():
    assert build_furniture(piece("desk", 1.27)).width_m == 1.27

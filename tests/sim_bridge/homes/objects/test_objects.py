"""Every class of objects in every look: it can be built, it is whole, and it is like no other class."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Furniture, Surface
from sim_bridge.homes.materials import Pattern, Substance, material
from sim_bridge.homes.objects.catalogue import CLASSES, LABELS, build_object, default_look, object_class
from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import SCALE, Look, SceneObject, Size, Style
from sim_bridge.homes.shapes import Axis, Part, Shape, Vector3, extent

COLOURS = {
    *("red", "blue", "green", "yellow", "white", "black", "brown", "grey", "orange", "purple"),
    *("pink", "turquoise", "silver", "gold", "beige"),
}
# What people have one of in a few sober versions.
FEW_LOOKS = ("tv", "laptop", "keyboard", "phone")
FLAT = ("keyboard", "plate", "picture")
MAX_PARTS = 16
APART_M = 0.001
ROUNDING_M = 1e-6

by_class = pytest.mark.parametrize("item", CLASSES, ids=LABELS)


def looks_of_every_shape(item: ObjectClass) -> list[Look]:
    """One look per pattern and size: colour and substance change no shape, except by a trim's colour."""
    seen = {(look.pattern, look.size): look for look in item.looks.all()}
    return list(seen.values())


def test_the_catalogue_keeps_its_order() -> None:
    assert LABELS[:14] == (
        *("mug", "book", "plant", "laptop", "bottle", "bowl", "lamp"),
        *("clock", "teddy", "vase", "pillow", "tv", "backpack", "apple"),
    )
    assert LABELS[14:] == (
        *("picture", "candle", "basket", "shoe", "ball", "toy car", "guitar", "headphones", "phone"),
        *("keyboard", "kettle", "toaster", "pan", "pot", "plate", "towel", "toilet roll", "soap dispenser"),
        *("hat", "umbrella", "gift box", "watering can"),
    )
    assert [item.label for item in CLASSES if item.hangs] == ["picture"]


@by_class
def test_a_class_comes_in_many_looks_of_few_words(item: ObjectClass) -> None:
    looks = item.looks
    assert len(set(looks.all())) == len(looks.all()) >= (4 if item.label in FEW_LOOKS else 12)
    assert len(looks.colours) >= 4
    assert set(looks.colours) <= COLOURS
    assert len(looks.substances) >= 2 or len(looks.patterns) >= 2
    assert all(look in looks for look in looks.all())
    assert default_look(item.label) in looks


@by_class
def test_every_look_is_seen_and_nothing_floats_or_sinks(item: ObjectClass) -> None:
    for look in item.looks.all():
        parts = item.parts(look)
        low, high = extent(parts)
        assert 1 <= len(parts) <= MAX_PARTS
        assert any(part.material == look.material for part in parts), look
        assert abs(low[2]) < ROUNDING_M, look
        # Seen from the front or the side, it is no needle; nor larger than what furniture can carry.
        across = sorted(top - bottom for bottom, top in zip(low, high, strict=True))
        scale = SCALE[look.size]
        assert across[1] >= 0.08 * scale - ROUNDING_M, look
        assert item.label in FLAT or across[0] >= 0.06 * scale, look
        assert across[2] <= 1.2, look


@by_class
def test_its_origin_is_below_its_middle(item: ObjectClass) -> None:
    low, high = extent(item.parts(item.default_look))
    for axis in (0, 1):
        reach = (high[axis] - low[axis]) / 2.0
        assert abs(high[axis] + low[axis]) / 2.0 <= 0.45 * reach + 0.01


@by_class
def test_size_is_nothing_but_scale(item: ObjectClass) -> None:
    for look in item.looks.all()[:: len(Size)]:
        low, high = extent(item.parts(replace(look, size=Size.SMALL)))
        if Size.LARGE in item.looks.sizes:
            grown_low, grown_high = extent(item.parts(replace(look, size=Size.LARGE)))
            ratio = SCALE[Size.LARGE] / SCALE[Size.SMALL]
            assert [ratio * value for value in (*low, *high)] == pytest.approx([*grown_low, *grown_high])


def faces(part: Part) -> Iterator[tuple[int, float, float]]:
    """The flat faces of a part: axis, direction out of it, position along the axis."""
    if part.shape is Shape.BALL:
        return
    for axis in (0, 1, 2) if part.shape is Shape.BOX else (int(part.axis),):
        for out in (-1.0, 1.0):
            yield axis, out, part.centre_m[axis] + out * part.size_m[axis] / 2.0


def inside(point: Vector3, part: Part) -> bool:
    offsets = [value - middle for value, middle in zip(point, part.centre_m, strict=True)]
    halves = [length / 2.0 for length in part.size_m]
    if part.shape is Shape.BALL:
        return math.hypot(*offsets) <= halves[0]
    if part.shape is Shape.CYLINDER:
        around = part.axis.others
        round_enough = math.hypot(*(offsets[at] for at in around)) <= halves[around[0]]
        return round_enough and abs(offsets[part.axis]) <= halves[part.axis]
    return all(abs(offset) <= half for offset, half in zip(offsets, halves, strict=True))


def spots_in_common(first: Part, second: Part, axis: int, at_m: float) -> Iterator[Vector3]:
    """Points of a grid that lie on the faces of both parts across the axis, at that height of it."""
    ranges = []
    for other in Axis(axis).others:
        sides = [(part.centre_m[other], part.size_m[other] / 2.0 - ROUNDING_M) for part in (first, second)]
        low, high = max(m - half for m, half in sides), min(m + half for m, half in sides)
        ranges.append([low + (high - low) * (n + 0.5) / 12 for n in range(12)] if low < high else [])
    for spot in itertools.product(*ranges):
        point = [at_m] * 3
        for other, value in zip(Axis(axis).others, spot, strict=True):
            point[other] = value
        on_faces = [list(point), list(point)]
        for part, on_face in zip((first, second), on_faces, strict=True):
            on_face[axis] = part.centre_m[axis]
        if all(inside((q[0], q[1], q[2]), part) for q, part in zip(on_faces, (first, second), strict=True)):
            yield point[0], point[1], point[2]


@by_class
def test_no_two_parts_share_a_face_that_is_seen(item: ObjectClass) -> None:
    for look in looks_of_every_shape(item):
        parts = item.parts(look)
        for first, second in itertools.combinations(parts, 2):
            for one, other in itertools.product(faces(first), faces(second)):
                (axis, out, at_m), (other_axis, other_out, other_m) = one, other
                if (axis, out) != (other_axis, other_out) or abs(at_m - other_m) >= APART_M - ROUNDING_M:
                    continue
                underneath = axis == 2 and out < 0.0 and at_m < 0.002
                on_the_wall = item.hangs and axis == 0 and out < 0.0
                if underneath or on_the_wall:
                    continue
                rest = [part for part in parts if part not in (first, second)]
                for spot in spots_in_common(first, second, axis, at_m):
                    assert any(inside(spot, part) for part in rest), (look, axis, first, second)


def filled_cells(item: ObjectClass) -> set[tuple[int, ...]]:
    """Which cells of a grid the object fills, whatever its colour, counted from its lowest corner."""
    cell_m = 0.02
    parts = item.parts(item.default_look)
    low, high = extent(parts)
    counts = [int((top - bottom) / cell_m) + 1 for bottom, top in zip(low, high, strict=True)]
    cells = set()
    for cell in itertools.product(*(range(count) for count in counts)):
        x, y, z = (bottom + (n + 0.5) * cell_m for bottom, n in zip(low, cell, strict=True))
        if any(inside((x, y, z), part) for part in parts):
            cells.add(cell)
    return cells


def test_the_shapes_of_two_classes_differ() -> None:
    shapes = {item.label: filled_cells(item) for item in CLASSES}
    for one, other in itertools.combinations(shapes, 2):
        common, either = shapes[one] & shapes[other], shapes[one] | shapes[other]
        assert len(common) / len(either) < 0.75, (one, other)


def test_pictures_are_flat_and_their_pattern_decides_what_they_show() -> None:
    picture = object_class("picture")
    motifs = set()
    for pattern in Pattern:
        look = replace(picture.default_look, pattern=pattern, size=Size.LARGE)
        low, high = extent(picture.parts(look))
        assert high[0] - low[0] <= 0.05
        assert abs(high[0] + low[0]) <= 0.006
        motifs.add(tuple(part for part in picture.parts(look) if part.material != look.material))
    assert len(motifs) == len(Pattern)


# --- building what a scene names -------------------------------------------------------------------------

DESK = Furniture(
    name="desk 1",
    kind="desk",
    room="office",
    x_m=2.0,
    y_m=1.0,
    quarter_turns=1,
    style=Style(width_m=1.2, main=material("oak wood"), accent=material("white paint")),
    depth_m=0.6,
    width_m=1.2,
    height_m=0.75,
    tall=False,
    surfaces=(
        Surface(area=Rect(x_min_m=-0.28, y_min_m=-0.58, x_max_m=0.28, y_max_m=0.58), height_m=0.75),
        Surface(area=Rect(x_min_m=-0.4, y_min_m=-0.5, x_max_m=-0.35, y_max_m=0.5), height_m=1.0, hangs=True),
    ),
    parts=(),
)
MUG = SceneObject(
    label="mug",
    look=Look(colour="red", substance=Substance.CERAMIC, pattern=Pattern.STRIPED),
    furniture="desk 1",
    surface=0,
    x_m=0.1,
    y_m=-0.2,
    turn_rad=math.radians(30.0),
)


def test_an_object_is_built_where_its_furniture_stands() -> None:
    mug = build_object(7, MUG, DESK)
    # The desk looks north: its x is north, its y west.
    assert (mug.x_m, mug.y_m, mug.z_m) == pytest.approx((2.2, 1.1, 0.75))
    assert mug.yaw_rad == pytest.approx(math.radians(120.0))
    assert (mug.instance, mug.label, mug.look, mug.surface) == (7, "mug", MUG.look, 0)
    assert (mug.room, mug.furniture) == ("office", "desk 1")
    assert mug.parts == object_class("mug").parts(MUG.look)


def test_what_cannot_be_is_refused_with_a_way_out() -> None:
    picture = default_look("picture")
    cases = [
        (replace(MUG, label="mugg"), r"no class of objects is called 'mugg'; do you mean 'mug'\?"),
        (replace(MUG, label="zeppelin"), r"called 'zeppelin'; there are mug, book,"),
        (
            replace(MUG, look=replace(MUG.look, colour="purple")),
            "object 7, a mug on 'desk 1', cannot be medium and of 'purple striped ceramic'; choose from: red",
        ),
        (replace(MUG, look=replace(MUG.look, substance=Substance.WOOD)), "of 'red striped wood'"),
        (replace(MUG, surface=2), "on surface 2, but a desk has 2, counted from 0"),
        (replace(MUG, surface=-1), "on surface -1"),
        (replace(MUG, surface=1), "a mug on 'desk 1', stands, but on surface 1 objects hang"),
        (replace(MUG, label="picture", look=picture), "hangs, but on surface 0 objects stand"),
    ]
    for thing, words in cases:
        with pytest.raises(BadSceneError, match=words):
            build_object(7, thing, DESK)
    assert build_object(7, replace(MUG, label="picture", look=picture, surface=1), DESK).z_m == 1.0

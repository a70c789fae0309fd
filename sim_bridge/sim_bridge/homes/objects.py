"""The small objects that stand in homes: how each class looks, its colours, and where it belongs.

Every class has a shape of its own, so that a person (and a detector) tells it from the others whatever its
colour. An object's frame has its origin below its middle; x is its front.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from sim_bridge.homes.shapes import Colour, Part, ball, box, cylinder

COLOURS: dict[str, Colour] = {
    "red": (0.80, 0.12, 0.10),
    "blue": (0.13, 0.30, 0.75),
    "green": (0.14, 0.55, 0.22),
    "yellow": (0.93, 0.78, 0.12),
    "white": (0.96, 0.96, 0.95),
    "black": (0.10, 0.10, 0.11),
    "brown": (0.50, 0.32, 0.18),
    "grey": (0.55, 0.56, 0.58),
    "orange": (0.93, 0.48, 0.10),
    "purple": (0.48, 0.22, 0.60),
}
PAPER: Colour = (0.97, 0.95, 0.88)
LEAF: Colour = (0.16, 0.48, 0.17)
LIGHT_LEAF: Colour = (0.30, 0.62, 0.24)
EARTH: Colour = (0.25, 0.16, 0.10)
DARK: Colour = (0.09, 0.09, 0.10)
SCREEN: Colour = (0.35, 0.62, 0.90)
METAL: Colour = (0.66, 0.67, 0.70)
GLOW: Colour = (1.00, 0.95, 0.74)


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectClass:
    """One class of objects: its colours by name, and how willingly it stands on which furniture."""

    label: str
    colours: tuple[str, ...]
    build: Callable[[Colour], tuple[Part, ...]]
    belongs_on: Mapping[str, float] = field(default_factory=dict)


def mug(colour: Colour) -> tuple[Part, ...]:
    """A mug with its handle at +y."""
    return (
        cylinder((0.0, 0.0, 0.05), 0.085, 0.10, colour),
        cylinder((0.0, 0.0, 0.1005), 0.068, 0.003, EARTH),
        box((0.0, 0.060, 0.075), (0.014, 0.040, 0.014), colour),
        box((0.0, 0.060, 0.028), (0.014, 0.040, 0.014), colour),
        box((0.0, 0.074, 0.0515), (0.014, 0.014, 0.061), colour),
    )


def book(colour: Colour) -> tuple[Part, ...]:
    """A thick book that lies, its spine at -y."""
    return (
        box((0.0, 0.0, 0.004), (0.24, 0.17, 0.008), colour),
        box((0.0, 0.003, 0.028), (0.23, 0.158, 0.04), PAPER),
        box((0.0, 0.0, 0.052), (0.24, 0.17, 0.008), colour),
        box((0.0, -0.081, 0.028), (0.24, 0.008, 0.04), colour),
        box((0.0, 0.0, 0.0565), (0.10, 0.10, 0.001), PAPER),
    )


def plant(colour: Colour) -> tuple[Part, ...]:
    """A pot with a bush in it."""
    return (
        cylinder((0.0, 0.0, 0.07), 0.15, 0.14, colour),
        cylinder((0.0, 0.0, 0.145), 0.17, 0.03, colour),
        cylinder((0.0, 0.0, 0.161), 0.14, 0.004, EARTH),
        cylinder((0.0, 0.0, 0.20), 0.02, 0.08, EARTH),
        ball((0.0, 0.0, 0.31), 0.19, LEAF),
        ball((0.06, 0.05, 0.26), 0.12, LIGHT_LEAF),
        ball((-0.06, 0.04, 0.28), 0.12, LEAF),
        ball((0.02, -0.07, 0.27), 0.12, LIGHT_LEAF),
        ball((0.0, 0.02, 0.40), 0.10, LIGHT_LEAF),
    )


def laptop(colour: Colour) -> tuple[Part, ...]:
    """An open laptop; its screen faces +x."""
    return (
        box((0.0, 0.0, 0.009), (0.25, 0.34, 0.018), colour),
        box((-0.015, 0.0, 0.019), (0.11, 0.30, 0.002), DARK),
        box((0.08, 0.0, 0.019), (0.06, 0.10, 0.002), DARK),
        box((-0.121, 0.0, 0.129), (0.008, 0.34, 0.222), colour),
        box((-0.1165, 0.0, 0.132), (0.001, 0.31, 0.19), SCREEN),
    )


def bottle(colour: Colour) -> tuple[Part, ...]:
    """A tall bottle with a label and a cap."""
    return (
        cylinder((0.0, 0.0, 0.10), 0.085, 0.20, colour),
        cylinder((0.0, 0.0, 0.10), 0.087, 0.07, PAPER),
        cylinder((0.0, 0.0, 0.215), 0.055, 0.03, colour),
        cylinder((0.0, 0.0, 0.26), 0.032, 0.06, colour),
        cylinder((0.0, 0.0, 0.30), 0.036, 0.02, DARK),
    )


def bowl(colour: Colour) -> tuple[Part, ...]:
    """A wide bowl, stepped, white inside."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.10, 0.02, colour),
        cylinder((0.0, 0.0, 0.035), 0.17, 0.03, colour),
        cylinder((0.0, 0.0, 0.065), 0.23, 0.03, colour),
        cylinder((0.0, 0.0, 0.081), 0.20, 0.002, COLOURS["white"]),
    )


def lamp(colour: Colour) -> tuple[Part, ...]:
    """A table lamp with a shade that glows."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.15, 0.02, colour),
        cylinder((0.0, 0.0, 0.15), 0.02, 0.26, METAL),
        cylinder((0.0, 0.0, 0.30), 0.26, 0.06, GLOW),
        cylinder((0.0, 0.0, 0.36), 0.22, 0.06, GLOW),
        cylinder((0.0, 0.0, 0.42), 0.18, 0.06, GLOW),
    )


def clock(colour: Colour) -> tuple[Part, ...]:
    """A table clock; its face looks towards +x."""
    return (
        box((0.0, 0.0, 0.11), (0.06, 0.20, 0.20), colour),
        box((0.0, 0.0, 0.005), (0.08, 0.16, 0.01), DARK),
        box((0.0305, 0.0, 0.11), (0.001, 0.16, 0.16), COLOURS["white"]),
        box((0.0315, 0.0, 0.14), (0.001, 0.012, 0.06), DARK),
        box((0.0315, -0.02, 0.11), (0.001, 0.052, 0.012), DARK),
    )


def teddy(colour: Colour) -> tuple[Part, ...]:
    """A sitting teddy bear that looks towards +x."""
    return (
        ball((0.0, 0.0, 0.10), 0.20, colour),
        ball((0.01, 0.0, 0.25), 0.16, colour),
        ball((0.085, 0.0, 0.235), 0.06, PAPER),
        ball((0.113, 0.0, 0.24), 0.022, DARK),
        ball((0.0, 0.065, 0.325), 0.06, colour),
        ball((0.0, -0.065, 0.325), 0.06, colour),
        ball((0.11, 0.07, 0.04), 0.08, colour),
        ball((0.11, -0.07, 0.04), 0.08, colour),
        ball((0.05, 0.11, 0.15), 0.07, colour),
        ball((0.05, -0.11, 0.15), 0.07, colour),
    )


def vase(colour: Colour) -> tuple[Part, ...]:
    """A vase with three flowers."""
    stems = ((0.0, 0.0), (0.03, 0.03), (-0.03, 0.03))
    blossoms = ((0.0, -0.03, 0.40), (0.05, 0.05, 0.36), (-0.05, 0.04, 0.38))
    return (
        cylinder((0.0, 0.0, 0.02), 0.09, 0.04, colour),
        cylinder((0.0, 0.0, 0.09), 0.13, 0.10, colour),
        cylinder((0.0, 0.0, 0.165), 0.08, 0.05, colour),
        cylinder((0.0, 0.0, 0.195), 0.10, 0.01, colour),
        *(cylinder((x, y, 0.28), 0.012, 0.16, LEAF) for x, y in stems),
        *(ball(centre, 0.08, COLOURS["orange"]) for centre in blossoms),
        *(ball((x, y, z + 0.028), 0.04, COLOURS["yellow"]) for x, y, z in blossoms),
    )


def pillow(colour: Colour) -> tuple[Part, ...]:
    """A thick pillow, thin at the seams, with a stripe across."""
    stripe = (colour[0] * 0.75, colour[1] * 0.75, colour[2] * 0.75)
    layers = ((0.40, 0.52, 0.04), (0.38, 0.50, 0.07), (0.35, 0.47, 0.10), (0.31, 0.43, 0.12))
    return (
        *(box((0.0, 0.0, 0.065), size, colour) for size in layers),
        box((0.0, 0.0, 0.065), (0.25, 0.37, 0.13), colour),
        box((0.0, 0.0, 0.066), (0.06, 0.38, 0.132), stripe),
    )


def tv(colour: Colour) -> tuple[Part, ...]:
    """A television on a foot; its screen faces +x."""
    return (
        box((0.0, 0.0, 0.01), (0.20, 0.40, 0.02), colour),
        box((0.0, 0.0, 0.06), (0.04, 0.10, 0.08), colour),
        box((0.0, 0.0, 0.36), (0.05, 0.92, 0.54), colour),
        box((0.0255, 0.0, 0.365), (0.001, 0.86, 0.48), (0.16, 0.22, 0.34)),
    )


def backpack(colour: Colour) -> tuple[Part, ...]:
    """A backpack that stands; its pocket is at +x."""
    return (
        box((0.0, 0.0, 0.19), (0.16, 0.28, 0.38), colour),
        box((0.0, 0.0, 0.39), (0.12, 0.22, 0.04), colour),
        box((0.105, 0.0, 0.13), (0.05, 0.22, 0.18), DARK),
        box((0.132, 0.0, 0.19), (0.004, 0.18, 0.012), METAL),
        box((0.082, 0.0, 0.31), (0.004, 0.28, 0.02), DARK),
        box((0.0, 0.0, 0.44), (0.02, 0.08, 0.02), DARK),
        box((0.0, 0.035, 0.42), (0.02, 0.02, 0.04), DARK),
        box((0.0, -0.035, 0.42), (0.02, 0.02, 0.04), DARK),
    )


def apple(colour: Colour) -> tuple[Part, ...]:
    """An apple with stalk and leaf."""
    return (
        ball((0.0, 0.0, 0.045), 0.09, colour),
        cylinder((0.0, 0.0, 0.098), 0.010, 0.025, EARTH),
        box((0.0, 0.017, 0.100), (0.014, 0.034, 0.006), LEAF),
    )


TABLES = {"dining table": 3.0, "coffee table": 3.0, "desk": 3.0, "kitchen counter": 1.0, "sideboard": 2.0}
CHESTS = {"sideboard": 3.0, "dresser": 3.0, "tv stand": 1.0, "nightstand": 2.0, "washing machine": 0.5}
SEATS = {"sofa": 3.0, "armchair": 2.0, "bed": 3.0, "chair": 1.0}

# In the order of their label numbers: append, never insert.
CLASSES: tuple[ObjectClass, ...] = (
    ObjectClass(
        label="mug",
        colours=("red", "blue", "white", "green"),
        build=mug,
        belongs_on={**TABLES, "kitchen counter": 4.0, "nightstand": 2.0, "washstand": 0.5},
    ),
    ObjectClass(
        label="book",
        colours=("red", "blue", "green", "purple"),
        build=book,
        belongs_on={**TABLES, **CHESTS, "sofa": 1.0, "bed": 1.0, "chair": 0.5, "kitchen counter": 0.3},
    ),
    ObjectClass(
        label="plant",
        colours=("brown", "white", "orange"),
        build=plant,
        belongs_on={**TABLES, **CHESTS, "washstand": 1.0},
    ),
    ObjectClass(
        label="laptop",
        colours=("grey", "black"),
        build=laptop,
        belongs_on={"desk": 5.0, "dining table": 2.0, "coffee table": 2.0, "bed": 0.7, "sofa": 0.5},
    ),
    ObjectClass(
        label="bottle",
        colours=("green", "blue", "red"),
        build=bottle,
        belongs_on={"kitchen counter": 4.0, "dining table": 3.0, "washstand": 2.0, "sideboard": 1.0},
    ),
    ObjectClass(
        label="bowl",
        colours=("blue", "red", "yellow"),
        build=bowl,
        belongs_on={"kitchen counter": 4.0, "dining table": 3.0, "coffee table": 2.0, "sideboard": 1.0},
    ),
    ObjectClass(
        label="lamp",
        colours=("black", "brown", "red"),
        build=lamp,
        belongs_on={"nightstand": 5.0, "desk": 2.0, "sideboard": 2.0, "dresser": 2.0},
    ),
    ObjectClass(
        label="clock",
        colours=("red", "brown", "black", "green"),
        build=clock,
        belongs_on={**CHESTS, "desk": 1.0, "kitchen counter": 1.0, "washstand": 1.0},
    ),
    ObjectClass(label="teddy", colours=("brown", "white"), build=teddy, belongs_on={**SEATS, "dresser": 1.0}),
    ObjectClass(
        label="vase",
        colours=("blue", "white", "purple"),
        build=vase,
        belongs_on={"dining table": 3.0, "coffee table": 2.0, "sideboard": 2.0, "washstand": 1.0},
    ),
    ObjectClass(
        label="pillow",
        colours=("white", "yellow", "green"),
        build=pillow,
        belongs_on={"bed": 5.0, "sofa": 3.0, "armchair": 1.0},
    ),
    ObjectClass(label="tv", colours=("black",), build=tv, belongs_on={"tv stand": 6.0, "dresser": 1.0}),
    ObjectClass(
        label="backpack",
        colours=("red", "blue", "orange", "green"),
        build=backpack,
        belongs_on={**SEATS, "desk": 1.0},
    ),
    ObjectClass(
        label="apple",
        colours=("red", "green", "yellow"),
        build=apple,
        belongs_on={"kitchen counter": 3.0, "dining table": 3.0, "coffee table": 2.0, "desk": 1.0},
    ),
)
LABELS: tuple[str, ...] = tuple(item.label for item in CLASSES)

"""How furniture is built from boards, boxes and tubes: what the kinds in `furniture` have in common.

Every design has its own frame: x out of its front, y to its left, the origin on the floor below its
middle. Nothing of it reaches out of its footprint, or below the floor.
"""

from collections.abc import Callable
from dataclasses import dataclass

from sim_bridge.homes.home import Surface
from sim_bridge.homes.materials import Material, material
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Axis, Part, Vector3, box, cylinder

# Between furniture and anything else, and so between a piece and the wall behind it.
GAP_M = 0.10
# Objects keep this far from a surface's edge.
EDGE_M = 0.03
LEG_M = 0.05
BOARD_M = 0.04
# The skin is a door's or drawer's thickness; handles stand out before it.
SKIN_M = 0.02
HANDLE_M = 0.02
SEAM_M = 0.02
PLINTH_M = 0.06
# Where things hang on the wall behind a piece: out of the way of what stands on it, but within the picture of
# a camera 1.1 m above the floor.
HANG_LOWEST_M, HANG_HIGHEST_M = 0.95, 1.15
HANG_ABOVE_M = 0.25
HANG_SIDE_M = 0.10
HANG_DEPTH_M = 0.05


def materials(*words: str) -> tuple[Material, ...]:
    """Several materials, each as `material` reads it."""
    return tuple(material(each) for each in words)


WOODS = materials("oak wood", "walnut wood", "cherry wood", "beige wood", "white wood")
DARK_WOODS = materials("walnut wood", "brown wood", "charcoal wood")
FABRICS = materials("red fabric", "blue fabric", "green fabric", "grey fabric", "beige fabric", "navy fabric")
CUSHIONS = materials(
    "yellow striped fabric", "orange dotted fabric", "cream checked fabric", "turquoise striped fabric"
)
COVERS = materials(
    "blue striped fabric", "red checked fabric", "green striped fabric", "purple dotted fabric", "grey fabric"
)
FRONTS = materials("white paint", "turquoise paint", "navy paint", "cream paint", "grey paint", "green paint")
WHITE_PAINT = material("white paint")
LINEN = material("cream fabric")
CERAMIC = material("white ceramic")
STEEL = material("silver metal")
BLACK_METAL = material("charcoal metal")
BLACK_GLASS = material("black glass")
BLACK_PLASTIC = material("black plastic")


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """One piece of furniture, not yet placed. `front_m` is the floor that must stay free before it."""

    depth_m: float
    width_m: float
    height_m: float
    parts: tuple[Part, ...]
    surfaces: tuple[Surface, ...] = ()
    tall: bool = False
    front_m: float = 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class FurnitureKind:
    """A kind of furniture: how it is built from a style, and which styles it comes in."""

    kind: str
    build: Callable[[Style], Design]
    widths_m: tuple[float, ...]
    mains: tuple[Material, ...]
    accents: tuple[Material, ...]


def surface_at(
    depth_m: float, width_m: float, height_m: float, x_m: float = 0.0, y_m: float = 0.0
) -> Surface:
    """Where objects stand on a board of this size around (x_m, y_m)."""
    area = Rect(
        x_min_m=x_m - depth_m / 2.0 + EDGE_M,
        y_min_m=y_m - width_m / 2.0 + EDGE_M,
        x_max_m=x_m + depth_m / 2.0 - EDGE_M,
        y_max_m=y_m + width_m / 2.0 - EDGE_M,
    )
    return Surface(area=area, height_m=height_m)


def wall_behind(depth_m: float, width_m: float, height_m: float) -> Surface:
    """Where things hang on the wall behind a piece of this size that stands GAP_M before it."""
    area = Rect(
        x_min_m=-depth_m / 2.0 - GAP_M,
        y_min_m=-width_m / 2.0 + HANG_SIDE_M,
        x_max_m=-depth_m / 2.0 - GAP_M + HANG_DEPTH_M,
        y_max_m=width_m / 2.0 - HANG_SIDE_M,
    )
    lowest_m = min(HANG_HIGHEST_M, max(HANG_LOWEST_M, height_m + HANG_ABOVE_M))
    return Surface(area=area, height_m=lowest_m, hangs=True)


def legs(
    size_m: Vector3, stuff: Material, inset_m: float = 0.0, thickness_m: float = LEG_M
) -> tuple[Part, ...]:
    """Four square legs in the corners of a footprint, as high as `size_m` says."""
    x = size_m[0] / 2.0 - thickness_m / 2.0 - inset_m
    y = size_m[1] / 2.0 - thickness_m / 2.0 - inset_m
    return tuple(
        box((sx * x, sy * y, size_m[2] / 2.0), (thickness_m, thickness_m, size_m[2]), stuff)
        for sx in (-1, 1)
        for sy in (-1, 1)
    )


def ring(outer: Rect, inner: Rect, z_m: tuple[float, float], stuff: Material) -> tuple[Part, ...]:
    """Four boxes around a hole, from z_m[0] up to z_m[1]."""
    strips = (
        Rect(x_min_m=outer.x_min_m, y_min_m=outer.y_min_m, x_max_m=inner.x_min_m, y_max_m=outer.y_max_m),
        Rect(x_min_m=inner.x_max_m, y_min_m=outer.y_min_m, x_max_m=outer.x_max_m, y_max_m=outer.y_max_m),
        Rect(x_min_m=inner.x_min_m, y_min_m=outer.y_min_m, x_max_m=inner.x_max_m, y_max_m=inner.y_min_m),
        Rect(x_min_m=inner.x_min_m, y_min_m=inner.y_max_m, x_max_m=inner.x_max_m, y_max_m=outer.y_max_m),
    )
    return tuple(slab(strip, z_m, stuff) for strip in strips)


def slab(area: Rect, z_m: tuple[float, float], stuff: Material) -> Part:
    """A box over a rectangle of the design's frame, from z_m[0] up to z_m[1]."""
    x_m, y_m = area.centre_m
    return box((x_m, y_m, (z_m[0] + z_m[1]) / 2.0), (area.width_m, area.depth_m, z_m[1] - z_m[0]), stuff)


def table(
    style: Style,
    depth_m: float,
    height_m: float,
    *,
    front_m: float,
    leg_m: float = LEG_M,
    hangs: bool = False,
) -> Design:
    """A board of the main material on four legs of the accent, with an apron under it."""
    width_m = style.width_m
    apron_m, inset_m = 0.06, 0.03
    under_m = height_m - BOARD_M
    top = box((0.0, 0.0, height_m - BOARD_M / 2.0), (depth_m, width_m, BOARD_M), style.main)
    apron = box(
        (0.0, 0.0, under_m - apron_m / 2.0),
        (depth_m - 2.0 * (inset_m + leg_m), width_m - 2.0 * (inset_m + leg_m), apron_m),
        style.accent,
    )
    surfaces: tuple[Surface, ...] = (surface_at(depth_m, width_m, height_m),)
    if hangs:
        surfaces = (*surfaces, wall_behind(depth_m, width_m, height_m))
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(top, apron, *legs((depth_m, width_m, under_m), style.accent, inset_m, leg_m)),
        surfaces=surfaces,
        front_m=front_m,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Fronts:
    """The doors or drawers of a chest: `columns` by `rows` panels between two heights."""

    columns: int
    rows: int
    stuff: Material
    handles: Material = STEEL

    def parts(self, depth_m: float, width_m: float, z_m: tuple[float, float]) -> tuple[Part, ...]:
        """The panels with a handle each; they fill SKIN_M + HANDLE_M of the depth behind the front."""
        panel_w = (width_m - SEAM_M) / self.columns - SEAM_M
        panel_h = (z_m[1] - z_m[0]) / self.rows - SEAM_M
        panel_x = depth_m / 2.0 - HANDLE_M - SKIN_M / 2.0
        found = []
        for column in range(self.columns):
            y = -width_m / 2.0 + SEAM_M + panel_w / 2.0 + column * (panel_w + SEAM_M)
            for row in range(self.rows):
                z = z_m[0] + panel_h / 2.0 + row * (panel_h + SEAM_M)
                found.append(box((panel_x, y, z), (SKIN_M, panel_w, panel_h), self.stuff))
                found.append(self._handle(depth_m, (y, z), (panel_w, panel_h), column))
        return tuple(found)

    def _handle(
        self, depth_m: float, at_m: tuple[float, float], panel_m: tuple[float, float], column: int
    ) -> Part:
        """A bar: across drawers, upright at the edge of doors, which open in pairs."""
        x, (y, z), (panel_w, panel_h) = depth_m / 2.0 - HANDLE_M / 2.0, at_m, panel_m
        if panel_w >= panel_h:
            return cylinder(
                (x, y, z + panel_h * 0.2), HANDLE_M, min(0.16, panel_w * 0.4), self.handles, Axis.Y
            )
        side = 1 if column % 2 == 0 else -1
        return cylinder(
            (x, y + side * (panel_w / 2.0 - 0.05), z), HANDLE_M, min(0.2, panel_h * 0.4), self.handles
        )


def chest(
    size_m: Vector3,
    body: Material,
    fronts: Fronts,
    top: Material | None = None,
    *,
    tall: bool = False,
    hangs: bool = False,
    front_m: float = 0.6,
) -> Design:
    """A body with a grid of doors or drawers in front and a top board. Tall ones carry nothing."""
    depth_m, width_m, height_m = size_m
    body_m = height_m - BOARD_M
    before_m = SKIN_M + HANDLE_M
    surfaces: tuple[Surface, ...] = () if tall else (surface_at(depth_m, width_m, height_m),)
    if hangs:
        surfaces = (*surfaces, wall_behind(depth_m, width_m, height_m))
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box((-before_m / 2.0, 0.0, body_m / 2.0), (depth_m - before_m, width_m, body_m), body),
            box((0.0, 0.0, height_m - BOARD_M / 2.0), (depth_m, width_m, BOARD_M), top or body),
            *fronts.parts(depth_m, width_m, (PLINTH_M, body_m)),
        ),
        surfaces=surfaces,
        tall=tall,
        front_m=front_m,
    )

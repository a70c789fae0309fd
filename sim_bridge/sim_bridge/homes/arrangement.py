"""Which small objects a home holds, and where on the furniture they stand."""

import math
from collections.abc import Sequence

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Furniture, SmallObject, Surface
from sim_bridge.homes.objects import CLASSES, COLOURS, ObjectClass
from sim_bridge.homes.shapes import Part, extent

# Besides at least this many classes of which the home holds one object ...
UNIQUE_CLASSES = 5
# ... objects of other classes come in twos and threes.
MAX_ALIKE = 3
# Homes lack some classes, so that a search for what is not there can be tried.
CLASSES_PRESENT = (9, 13)
OBJECT_GAP_M = 0.03
YAW_SPREAD_RAD = 0.5
TRIES = 30
CERTAIN_LABELS = ("mug", "book")


def arrange(rng: np.random.Generator, furniture: Sequence[Furniture], count: int) -> tuple[SmallObject, ...]:
    """Put `count` objects of 9 to 13 classes, or of more where that many objects need them, on furniture.

    Raises BadSceneError where the furniture has no room for them; draw again then.
    """
    carriers = [piece for piece in furniture if piece.carries]
    placed: list[SmallObject] = []
    order = [CLASSES[at] for at in rng.permutation(len(CLASSES))]
    order.sort(key=lambda item: item.label not in CERTAIN_LABELS)
    alike: dict[str, int] = {}
    needed = UNIQUE_CLASSES + math.ceil((count - UNIQUE_CLASSES) / MAX_ALIKE)
    wanted = max(needed, int(rng.integers(CLASSES_PRESENT[0], CLASSES_PRESENT[1] + 1)))
    for item in order:
        found = _stand(rng, item, carriers, placed) if len(placed) < min(count, wanted) else None
        if found is not None:
            placed.append(found)
            alike[item.label] = 1
    # The classes that come last in the draw stay unique.
    repeated = [item for item in order if item.label in alike][: max(0, len(alike) - UNIQUE_CLASSES)]
    while len(placed) < count:
        open_classes = [item for item in repeated if alike[item.label] < MAX_ALIKE]
        if not open_classes:
            raise BadSceneError(f"the furniture has room for {len(placed)} objects, not for {count}")
        item = open_classes[int(rng.integers(len(open_classes)))]
        found = _stand(rng, item, carriers, placed)
        if found is None:
            repeated.remove(item)
            continue
        placed.append(found)
        alike[item.label] += 1
    return tuple(placed)


def _stand(
    rng: np.random.Generator,
    item: ObjectClass,
    carriers: Sequence[Furniture],
    placed: Sequence[SmallObject],
) -> SmallObject | None:
    """One more object of the class on a piece of furniture where it belongs; None where none has room."""
    weights = np.array([item.belongs_on.get(piece.kind, 0.0) for piece in carriers])
    if not weights.any():
        return None
    taken = {other.colour_name for other in placed if other.label == item.label}
    colours = [name for name in item.colours if name not in taken] or list(item.colours)
    colour_name = colours[int(rng.integers(len(colours)))]
    parts = item.build(COLOURS[colour_name])
    for attempt in range(TRIES):
        piece = carriers[int(rng.choice(len(carriers), p=weights / weights.sum()))]
        surface = piece.surfaces[int(rng.integers(len(piece.surfaces)))]
        # Wide objects only fit when they stand straight: turn them less and less.
        spread_rad = YAW_SPREAD_RAD * (1.0 - attempt / (TRIES - 1))
        turn_rad = rng.uniform(-spread_rad, spread_rad)
        spot = _spot(rng, surface, parts, turn_rad)
        if spot is None:
            continue
        x_m, y_m = piece.point_in_map(*spot)
        found = SmallObject(
            instance=len(placed),
            label=item.label,
            colour_name=colour_name,
            room=piece.room,
            furniture=piece.name,
            x_m=x_m,
            y_m=y_m,
            z_m=surface.height_m,
            yaw_rad=math.remainder(piece.yaw_rad + turn_rad, math.tau),
            parts=parts,
        )
        kept = found.footprint.grown(OBJECT_GAP_M)
        crowded = any(other.furniture == piece.name and kept.overlaps(other.footprint) for other in placed)
        if not crowded:
            return found
    return None


def _spot(
    rng: np.random.Generator, surface: Surface, parts: tuple[Part, ...], turn_rad: float
) -> tuple[float, float] | None:
    """A point of the surface (furniture's frame) where the whole object stands on it; None: too large."""
    low, high = extent(parts)
    corners = np.array([(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])])
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    turned = corners @ np.array([[cos, sin], [-sin, cos]])
    below, above = turned.min(axis=0), turned.max(axis=0)
    area = surface.area
    x_range = (area.x_min_m - below[0], area.x_max_m - above[0])
    y_range = (area.y_min_m - below[1], area.y_max_m - above[1])
    if x_range[0] > x_range[1] or y_range[0] > y_range[1]:
        return None
    return float(rng.uniform(*x_range)), float(rng.uniform(*y_range))

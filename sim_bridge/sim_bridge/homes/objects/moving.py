"""An object is taken from where it stands and put on another piece of furniture."""

import math
from collections.abc import Sequence

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from sim_bridge.homes.home import Furniture, SmallObject
from sim_bridge.homes.objects.catalogue import build_object, object_class
from sim_bridge.homes.scene import SceneObject

TRIES = 200
GAP_M = 0.02


def moved(
    rng: np.random.Generator, thing: SmallObject, piece: Furniture, others: Sequence[SmallObject]
) -> SmallObject:
    """The object somewhere on `piece`, wholly on one of its surfaces and beside the others.

    Raises BadMessageError where the piece has no room for it.
    """
    hangs = object_class(thing.label).hangs
    surfaces = [number for number, surface in enumerate(piece.surfaces) if surface.hangs == hangs]
    beside = [other.footprint for other in others if other.furniture == piece.name]
    for _ in range(TRIES if surfaces else 0):
        number = surfaces[int(rng.integers(len(surfaces)))]
        surface = piece.surfaces[number]
        area = surface.area
        found = build_object(
            thing.instance,
            SceneObject(
                label=thing.label,
                look=thing.look,
                furniture=piece.name,
                surface=number,
                x_m=float(rng.uniform(area.x_min_m, area.x_max_m)),
                y_m=float(rng.uniform(area.y_min_m, area.y_max_m)),
                turn_rad=0.0 if hangs else float(rng.uniform(-math.pi, math.pi)),
            ),
            piece,
        )
        kept = found.footprint.grown(GAP_M)
        if piece.in_map(area).contains(found.footprint) and not any(kept.overlaps(other) for other in beside):
            return found
    raise BadMessageError(f"the {piece.name} has no room for the {thing.look.colour} {thing.label}")

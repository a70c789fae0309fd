"""An object is taken from where it stands and put on another piece of furniture."""

import math
from collections.abc import Sequence

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from sim_bridge.homes.home import Furniture, SmallObject, Wall, Window
from sim_bridge.homes.objects.arrangement import headroom_m, is_on_a_wall
from sim_bridge.homes.objects.catalogue import build_object, object_class
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import SceneObject
from sim_bridge.homes.shapes import extent

TRIES = 200
GAP_M = 0.02


def moved(
    rng: np.random.Generator,
    thing: SmallObject,
    piece: Furniture,
    others: Sequence[SmallObject],
    *,
    walls: Sequence[Wall] = (),
    windows: Sequence[Window] = (),
) -> SmallObject:
    """The object somewhere on `piece`: wholly on a surface, below the next board, beside the others.

    What hangs touches the wall behind the piece, one of `walls`, beside the `windows`. Raises BadMessageError
    where the piece has no room for it.
    """
    hangs = object_class(thing.label).hangs
    low, high = extent(thing.parts)
    surfaces = [
        number
        for number, surface in enumerate(piece.surfaces)
        if surface.hangs == hangs and high[2] <= headroom_m(piece, surface)
    ]
    beside = [other.footprint for other in others if other.furniture == piece.name]
    for _ in range(TRIES if surfaces else 0):
        number = surfaces[int(rng.integers(len(surfaces)))]
        surface = piece.surfaces[number]
        area = surface.area
        y_m = float(rng.uniform(area.y_min_m, area.y_max_m))
        if hangs:
            x_m, turn_rad = area.x_min_m - low[0], 0.0
            back = Rect(
                x_min_m=x_m + low[0], y_min_m=y_m + low[1], x_max_m=x_m + high[0], y_max_m=y_m + high[1]
            )
            height_m = (surface.height_m, surface.height_m + high[2])
            if not is_on_a_wall(piece, back, height_m, walls, windows):
                continue
        else:
            x_m = float(rng.uniform(area.x_min_m, area.x_max_m))
            turn_rad = float(rng.uniform(-math.pi, math.pi))
        found = build_object(
            thing.instance,
            SceneObject(
                label=thing.label,
                look=thing.look,
                furniture=piece.name,
                surface=number,
                x_m=x_m,
                y_m=y_m,
                turn_rad=turn_rad,
            ),
            piece,
        )
        kept = found.footprint.grown(GAP_M)
        if piece.in_map(area).contains(found.footprint) and not any(kept.overlaps(other) for other in beside):
            return found
    raise BadMessageError(f"the {piece.name} has no room for the {thing.look.colour} {thing.label}")

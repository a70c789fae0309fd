"""All classes of small objects, and how one that a scene names is built."""

import difflib
import math

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Furniture, SmallObject
from sim_bridge.homes.objects import (
    bath_and_bed,
    carried_things,
    decorations,
    kitchenware,
    office_things,
    toys,
)
from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.scene import Look, SceneObject

# In the order of their label numbers: append, never insert.
CLASSES: tuple[ObjectClass, ...] = (
    kitchenware.MUG,
    office_things.BOOK,
    decorations.PLANT,
    office_things.LAPTOP,
    kitchenware.BOTTLE,
    kitchenware.BOWL,
    decorations.LAMP,
    decorations.CLOCK,
    toys.TEDDY,
    decorations.VASE,
    bath_and_bed.PILLOW,
    office_things.TV,
    carried_things.BACKPACK,
    kitchenware.APPLE,
    decorations.PICTURE,
    decorations.CANDLE,
    carried_things.BASKET,
    carried_things.SHOE,
    toys.BALL,
    toys.TOY_CAR,
    toys.GUITAR,
    office_things.HEADPHONES,
    office_things.PHONE,
    office_things.KEYBOARD,
    kitchenware.KETTLE,
    kitchenware.TOASTER,
    kitchenware.PAN,
    kitchenware.POT,
    kitchenware.PLATE,
    bath_and_bed.TOWEL,
    bath_and_bed.TOILET_ROLL,
    bath_and_bed.SOAP_DISPENSER,
    carried_things.HAT,
    carried_things.UMBRELLA,
    carried_things.GIFT_BOX,
    carried_things.WATERING_CAN,
)
LABELS: tuple[str, ...] = tuple(item.label for item in CLASSES)
_BY_LABEL = dict(zip(LABELS, CLASSES, strict=True))


def object_class(label: str) -> ObjectClass:
    """The class of that label. Raises BadSceneError, with the nearest label, where there is none."""
    if label in _BY_LABEL:
        return _BY_LABEL[label]
    near = difflib.get_close_matches(label, LABELS, n=1)
    hint = f"; do you mean {near[0]!r}?" if near else f"; there are {', '.join(LABELS)}"
    raise BadSceneError(f"no class of objects is called {label!r}{hint}")


def default_look(label: str) -> Look:
    """How an object looks of which nothing but its class is said. Raises BadSceneError: unknown class."""
    return object_class(label).default_look


def build_object(instance: int, thing: SceneObject, piece: Furniture) -> SmallObject:
    """Build object number `instance` on the piece of furniture that `thing` names.

    Raises BadSceneError for a class that there is not, a look it does not come in, a surface that the piece
    has not, and for what hangs on a surface to stand on, or the reverse.
    """
    item = object_class(thing.label)
    where = f"object {instance}, a {thing.label} on {piece.name!r},"
    if thing.look not in item.looks:
        look = thing.look
        raise BadSceneError(
            f"{where} cannot be {look.size} and of {str(look.material)!r}; choose from: {item.looks}"
        )
    if not 0 <= thing.surface < len(piece.surfaces):
        raise BadSceneError(
            f"{where} is on surface {thing.surface!r}, but a {piece.kind} has {len(piece.surfaces)}, "
            f"counted from 0"
        )
    surface = piece.surfaces[thing.surface]
    if surface.hangs != item.hangs:
        does, holds = ("hangs", "stand") if item.hangs else ("stands", "hang")
        raise BadSceneError(
            f"{where} {does}, but on surface {thing.surface!r} objects {holds}: choose another surface"
        )
    x_m, y_m = piece.point_in_map(thing.x_m, thing.y_m)
    return SmallObject(
        instance=instance,
        label=thing.label,
        look=thing.look,
        room=piece.room,
        furniture=piece.name,
        surface=thing.surface,
        x_m=x_m,
        y_m=y_m,
        z_m=surface.height_m,
        yaw_rad=math.remainder(piece.yaw_rad + thing.turn_rad, math.tau),
        parts=item.parts(thing.look),
    )

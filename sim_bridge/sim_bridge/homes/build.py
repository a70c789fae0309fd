"""From the description of a home to its walls, boards and handles."""

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.furniture.catalogue import build_furniture
from sim_bridge.homes.home import Furniture, Home
from sim_bridge.homes.objects.catalogue import LABELS, build_object
from sim_bridge.homes.rooms.walls import build_shell
from sim_bridge.homes.scene import Scene, SceneObject
from sim_bridge.homes.scene_check import check_home


def build_home(scene: Scene) -> Home:
    """Build what a scene describes (some 10 ms).

    Raises BadSceneError, with the first thing that is wrong in a sentence, unless the home holds together:
    nothing overlaps or floats, and the robot gets into every room.
    """
    shell = build_shell(scene.rooms, scene.doors, scene.windows)
    furniture = tuple(build_furniture(piece) for piece in scene.furniture)
    pieces = {piece.name: piece for piece in furniture}
    home = Home(
        name=scene.name,
        seed=scene.seed,
        bounds=shell.bounds,
        rooms=shell.rooms,
        doors=shell.doors,
        windows=shell.windows,
        walls=shell.walls,
        furniture=furniture,
        objects=tuple(
            build_object(number, thing, _support(pieces, thing)) for number, thing in enumerate(scene.objects)
        ),
        labels=LABELS,
        start=scene.start,
    )
    check_home(home)
    return home


def _support(pieces: dict[str, Furniture], thing: SceneObject) -> Furniture:
    if thing.furniture not in pieces:
        raise BadSceneError(
            f"a {thing.label} is said to be on {thing.furniture!r}, but no furniture has that name; "
            f"there are {', '.join(pieces) or 'no pieces'}"
        )
    return pieces[thing.furniture]

"""A home that does not hold together is refused with a sentence that names what is wrong and where."""

import dataclasses
import math

import pytest

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.build import build_home
from sim_bridge.homes.furniture.catalogue import default_style
from sim_bridge.homes.generator import generate_scene
from sim_bridge.homes.home import Furniture, Home, SmallObject
from sim_bridge.homes.objects.catalogue import default_look
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Scene, SceneFurniture, SceneObject
from sim_bridge.homes.scene_check import check_home, check_passages


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Three rooms, with a picture."""
    scenes = (generate_scene(seed) for seed in range(100))
    return next(scene for scene in scenes if any(thing.label == "picture" for thing in scene.objects))


@pytest.fixture(scope="module")
def home(scene: Scene) -> Home:
    return build_home(scene)


def refused(home: Home, sentence: str) -> None:
    with pytest.raises(BadSceneError, match=f"^home '{home.name}': {sentence}"):
        check_home(home)


def with_piece(home: Home, piece: Furniture, at: int = 0) -> Home:
    return dataclasses.replace(home, furniture=(*home.furniture[:at], piece, *home.furniture[at + 1 :]))


def with_object(home: Home, thing: SmallObject, at: int = 0) -> Home:
    return dataclasses.replace(home, objects=(*home.objects[:at], thing, *home.objects[at + 1 :]))


def bare(home: Home, *pieces: Furniture) -> Home:
    """The home with nothing in it but these pieces."""
    return dataclasses.replace(home, furniture=pieces, objects=())


def block(home: Home, area: Rect, room: str) -> Furniture:
    """A cupboard that covers an area."""
    piece = next(piece for piece in home.furniture if piece.tall)
    x_m, y_m = area.centre_m
    return dataclasses.replace(
        piece,
        name="block 1",
        room=room,
        x_m=x_m,
        y_m=y_m,
        quarter_turns=0,
        depth_m=area.width_m,
        width_m=area.depth_m,
    )


def test_sound_homes_pass(homes: list[Home]) -> None:
    for home in homes:
        check_home(home)
        check_passages(home)


def test_two_pieces_of_one_name(home: Home) -> None:
    first, second = home.furniture[:2]
    refused(
        with_piece(home, dataclasses.replace(second, name=first.name), 1),
        f"two pieces of furniture are called '{first.name}'; give each a name of its own$",
    )


def test_a_piece_in_no_room(home: Home) -> None:
    piece = dataclasses.replace(home.furniture[0], room="ballroom")
    refused(with_piece(home, piece), f"the {piece.name} is said to be in 'ballroom', which is no room of it$")


def test_a_piece_through_a_wall(home: Home) -> None:
    piece = home.furniture[0]
    inside = next(room.inside for room in home.rooms if room.name == piece.room)
    moved = dataclasses.replace(piece, x_m=inside.x_max_m)
    refused(
        with_piece(home, moved),
        rf"the {piece.name} reaches through a wall of the {piece.room}: it covers x .*, y .* m, "
        rf"the floor is x {inside.x_min_m:.2f}\.\.{inside.x_max_m:.2f}, y .* m$",
    )


def test_a_piece_in_a_door(home: Home) -> None:
    door = home.doors[0]
    wider = next(room for room in home.rooms if room.name == door.rooms[0])
    rooms = tuple(
        dataclasses.replace(room, inside=room.inside.grown(0.5)) if room is wider else room
        for room in home.rooms
    )
    # Only where the room's floor reaches into the doorway is a piece in it not through a wall first.
    broken = dataclasses.replace(bare(home, block(home, door.opening, wider.name)), rooms=rooms)
    refused(broken, f"the block 1 stands in the door between {door.rooms[0]} and {door.rooms[1]}$")


def test_two_pieces_in_one_place(home: Home) -> None:
    piece = home.furniture[0]
    twin = dataclasses.replace(piece, name="twin 1")
    refused(
        dataclasses.replace(home, furniture=(*home.furniture, twin)),
        f"the twin 1 and the {piece.name} overlap$",
    )


def name_of(thing: SmallObject) -> str:
    return rf"the {thing.look.colour} {thing.label} \(object {thing.instance}\)"


def test_a_wrong_instance(home: Home) -> None:
    thing = dataclasses.replace(home.objects[0], instance=7)
    refused(with_object(home, thing), f"{name_of(thing)} is number 0 in the list; instances count from 0$")


def test_a_class_without_a_label(home: Home) -> None:
    thing = dataclasses.replace(home.objects[0], label="dragon")
    refused(with_object(home, thing), f"{name_of(thing)} is of a class that the labels mug, book.* lack$")


def test_a_floating_object(home: Home) -> None:
    thing = dataclasses.replace(home.objects[0], z_m=home.objects[0].z_m + 0.1)
    stands = f"{name_of(thing)} does not stand on the {thing.furniture}: all of it must be on one surface$"
    refused(with_object(home, thing), stands)
    beside = dataclasses.replace(home.objects[0], x_m=home.objects[0].x_m + 2.0)
    refused(with_object(home, beside), stands)


def test_an_object_on_no_furniture_and_on_no_surface(home: Home) -> None:
    for change in ({"furniture": "cloud 9"}, {"surface": 9}, {"surface": -1}):
        thing = dataclasses.replace(home.objects[0], **change)
        refused(with_object(home, thing), f"{name_of(thing)} does not stand on the {thing.furniture}: ")


def test_a_picture_that_hangs_in_the_air(home: Home) -> None:
    """Its furniture stands away from the wall, and it with it."""
    at, thing = next((at, thing) for at, thing in enumerate(home.objects) if thing.label == "picture")
    number, piece = next(
        (n, piece) for n, piece in enumerate(home.furniture) if piece.name == thing.furniture
    )
    ahead = (math.cos(piece.yaw_rad) * 0.1, math.sin(piece.yaw_rad) * 0.1)
    broken = dataclasses.replace(
        home,
        furniture=(dataclasses.replace(piece, x_m=piece.x_m + ahead[0], y_m=piece.y_m + ahead[1]),),
        objects=(dataclasses.replace(thing, instance=0, x_m=thing.x_m + ahead[0], y_m=thing.y_m + ahead[1]),),
    )
    assert home.furniture[number] is piece
    assert home.objects[at] is thing
    thing = broken.objects[0]
    refused(
        broken,
        f"{name_of(thing)} hangs in the air: no wall, or a door or window, is behind the {piece.name}$",
    )


def hung(home: Home) -> tuple[Home, SmallObject, Furniture]:
    """The home with nothing in it but a picture and the piece that it hangs over."""
    thing = next(thing for thing in home.objects if thing.label == "picture")
    piece = next(piece for piece in home.furniture if piece.name == thing.furniture)
    thing = dataclasses.replace(thing, instance=0)
    return dataclasses.replace(home, furniture=(piece,), objects=(thing,)), thing, piece


def test_a_picture_over_a_window_or_a_door(home: Home) -> None:
    sound, thing, piece = hung(home)
    check_home(sound)
    area = thing.footprint.grown(0.01)
    hangs = f"{name_of(thing)} hangs in the air: no wall, or a door or window, is behind the {piece.name}$"
    window = dataclasses.replace(home.windows[0], pane=area)
    refused(dataclasses.replace(sound, windows=(window,)), hangs)
    # Above the window's top, or below its sill, it may hang.
    low = dataclasses.replace(window, z_min_m=0.1, z_max_m=thing.z_m - 0.01)
    check_home(dataclasses.replace(sound, windows=(low,)))
    # Of the wall behind it, only the lintel is left.
    behind = area.grown(0.1)
    walls = tuple(
        dataclasses.replace(wall, z_min_m=2.05) if wall.base.overlaps(behind) else wall for wall in home.walls
    )
    refused(dataclasses.replace(sound, walls=walls), hangs)


def test_an_object_that_reaches_through_the_board_above_it(scene: Scene) -> None:
    room = scene.rooms[0]
    shelf = SceneFurniture(
        name="low shelf 9",
        kind="low shelf",
        room=room.name,
        x_m=scene.start.x_m,
        y_m=scene.start.y_m + 0.6,
        quarter_turns=0,
        style=default_style("low shelf"),
    )
    plant = SceneObject(
        label="plant",
        look=default_look("plant"),
        furniture=shelf.name,
        surface=1,
        x_m=0.0,
        y_m=0.0,
        turn_rad=0.0,
    )
    x_m, y_m = room.area.centre_m
    alone = dataclasses.replace(
        scene,
        furniture=(dataclasses.replace(shelf, x_m=x_m, y_m=y_m),),
        objects=(plant,),
        start=Pose2D(x_m=x_m, y_m=y_m - 1.2),
    )
    with pytest.raises(BadSceneError, match=r"plant \(object 0\) is too tall for the board above it; choose"):
        build_home(alone)
    on_top = dataclasses.replace(plant, surface=0)
    assert build_home(dataclasses.replace(alone, objects=(on_top,))).objects[0].label == "plant"


def test_a_room_of_an_unknown_kind_and_a_home_that_no_map_can_hold(scene: Scene) -> None:
    first = scene.rooms[0]

    def with_first(**changed: object) -> Scene:
        return dataclasses.replace(scene, rooms=(dataclasses.replace(first, **changed), *scene.rooms[1:]))

    with pytest.raises(
        BadSceneError, match=f"room '{first.name}' is of the kind 'kichen', .* mean 'kitchen'"
    ):
        build_home(with_first(kind="kichen"))
    with pytest.raises(BadSceneError, match="is of the kind 'moon base', which no room is; there are living"):
        build_home(with_first(kind="moon base"))
    far = Rect(x_min_m=900.0, y_min_m=900.0, x_max_m=904.0, y_max_m=904.0)
    with pytest.raises(
        BadSceneError, match=r"the home is 90\d\.\d+ m x 90\d\.\d+ m; make it smaller, 5000 m2"
    ):
        build_home(with_first(area=far))


def test_two_objects_in_one_place(home: Home) -> None:
    thing = home.objects[0]
    twin = dataclasses.replace(thing, instance=len(home.objects))
    refused(
        dataclasses.replace(home, objects=(*home.objects, twin)),
        f"{name_of(twin)} and the {thing.look.colour} {thing.label} overlap$",
    )


def test_a_start_in_a_wall_and_outside(home: Home) -> None:
    for x_m, y_m in (home.walls[0].base.centre_m, (-50.0, 0.0)):
        refused(
            dataclasses.replace(home, start=Pose2D(x_m=x_m, y_m=y_m)),
            rf"the robot cannot start at \({x_m:.2f}, {y_m:.2f}\): something is in the way$",
        )


def test_a_room_that_is_shut_off(home: Home) -> None:
    """Furniture fills a room from wall to wall, right behind its only door."""
    doors = [door for room in home.rooms for door in home.doors if room.name in door.rooms]
    room = next(room for room in home.rooms if sum(room.name in door.rooms for door in home.doors) == 1)
    assert doors
    other = next(other for other in home.rooms if other is not room)
    x_m, y_m = other.inside.centre_m
    full = bare(home, block(home, room.inside.grown(-0.05), room.name))
    refused(
        dataclasses.replace(full, start=Pose2D(x_m=x_m, y_m=y_m)),
        f"the robot gets from its start not into the {room.name}: the way is shut or too narrow$",
    )


def test_an_object_on_furniture_that_is_not_there_is_refused_when_it_is_built(scene: Scene) -> None:
    thing = dataclasses.replace(scene.objects[0], furniture="cloud 9")
    with pytest.raises(BadSceneError, match=f"a {thing.label} is said to be on 'cloud 9', but no furniture"):
        build_home(dataclasses.replace(scene, objects=(thing, *scene.objects[1:])))


def test_a_home_for_large_robots_too(home: Home) -> None:
    """A drawn home lets also robots through that keep more distance."""
    start = dataclasses.replace(
        home, start=Pose2D(x_m=home.rooms[0].inside.x_min_m + 0.19, y_m=home.start.y_m)
    )
    with pytest.raises(BadSceneError, match="a large robot cannot start at"):
        check_passages(start)
    inside = home.rooms[0].inside
    row = block(
        home,
        Rect(
            x_min_m=inside.x_min_m,
            y_min_m=inside.centre_m[1] - 0.1,
            x_max_m=inside.x_max_m,
            y_max_m=inside.centre_m[1] + 0.1,
        ),
        home.rooms[0].name,
    )
    middle = home.rooms[1].inside.centre_m
    parted = dataclasses.replace(bare(home, row), start=Pose2D(x_m=middle[0], y_m=middle[1]))
    with pytest.raises(BadSceneError, match=r"the floor falls into \d parts for a robot of 0\.\d+ m radius"):
        check_passages(parted)

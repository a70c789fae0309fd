"""A home that does not hold together is refused with a sentence that names what is wrong."""

import dataclasses

import pytest

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.homes.scene_check import check_home


@pytest.fixture
def home(homes: list[Home]) -> Home:
    return homes[0]


def refused(home: Home, sentence: str) -> None:
    with pytest.raises(BadSceneError, match=sentence):
        check_home(home)


def test_a_sound_home_passes(homes: list[Home]) -> None:
    for home in homes:
        check_home(home)


def test_a_floating_object(home: Home) -> None:
    thing = dataclasses.replace(home.objects[0], z_m=home.objects[0].z_m + 0.1)
    refused(
        dataclasses.replace(home, objects=(thing, *home.objects[1:])), f"{thing.label}.*does not stand on"
    )


def test_two_objects_in_one_place(home: Home) -> None:
    twin = dataclasses.replace(home.objects[0], instance=len(home.objects))
    refused(dataclasses.replace(home, objects=(*home.objects, twin)), "overlap")


def test_furniture_in_a_wall(home: Home) -> None:
    piece = dataclasses.replace(home.furniture[0], x_m=home.bounds.x_max_m)
    refused(dataclasses.replace(home, furniture=(piece, *home.furniture[1:])), "does not stand in the")


def test_furniture_that_closes_the_way(home: Home) -> None:
    room = home.rooms[0]
    x_m, y_m = room.inside.centre_m
    piece = next(piece for piece in home.furniture if piece.tall)
    block = dataclasses.replace(
        piece, name="block", room=room.name, x_m=x_m, y_m=y_m, quarter_turns=0, depth_m=room.inside.width_m
    )
    others = tuple(other for other in home.furniture if other.room != room.name)
    kept = {other.name for other in others}
    objects = tuple(
        dataclasses.replace(thing, instance=at)
        for at, thing in enumerate(thing for thing in home.objects if thing.furniture in kept)
    )
    refused(dataclasses.replace(home, furniture=(*others, block), objects=objects), "parts|cannot start")


def test_a_start_in_a_wall(home: Home) -> None:
    refused(dataclasses.replace(home, start=Pose2D(x_m=0.0, y_m=0.0)), "cannot start")


def test_two_rooms(home: Home) -> None:
    refused(dataclasses.replace(home, rooms=home.rooms[:2]), "2 rooms")

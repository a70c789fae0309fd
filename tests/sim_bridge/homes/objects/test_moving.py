"""What is moved is wholly on a surface again, beside the others, or the sentence says that it has no room."""

import dataclasses

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from sim_bridge.homes.home import Furniture, Home, SmallObject
from sim_bridge.homes.objects.moving import moved
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene_check import check_home
from sim_bridge.homes.shapes import extent

# Cushions may end this far above or below the height where objects stand.
SUNK_M = 0.013


def reaches_into(thing: SmallObject, piece: Furniture) -> bool:
    """Whether the object's box and a part of the furniture share a place."""
    for part in piece.parts:
        low, high = extent((part,))
        area = piece.in_map(Rect(x_min_m=low[0], y_min_m=low[1], x_max_m=high[0], y_max_m=high[1]))
        level = thing.z_m < high[2] - SUNK_M and low[2] < thing.z_m + thing.size_m[2]
        if level and area.overlaps(thing.footprint):
            return True
    return False


def carriers(home: Home) -> list[Furniture]:
    return [piece for piece in home.furniture if piece.carries]


def test_a_home_in_which_things_were_moved_is_sound(homes: list[Home]) -> None:
    rng = np.random.default_rng(0)
    count = 0
    for home in homes[::2]:
        for _ in range(12):
            thing = home.objects[int(rng.integers(len(home.objects)))]
            piece = carriers(home)[int(rng.integers(len(carriers(home))))]
            others = [other for other in home.objects if other is not thing]
            try:
                put = moved(rng, thing, piece, others, walls=home.walls, windows=home.windows)
            except BadMessageError:
                continue
            count += 1
            assert (put.instance, put.label, put.look) == (thing.instance, thing.label, thing.look)
            assert (put.furniture, put.room) == (piece.name, piece.room)
            home = dataclasses.replace(
                home, objects=tuple(put if other is thing else other for other in home.objects)
            )
            assert not reaches_into(put, piece), (put.label, piece.name)
        check_home(home)
    assert count > 40


def test_nothing_tall_is_squeezed_between_two_boards(homes: list[Home]) -> None:
    rng = np.random.default_rng(1)
    shelves = [(home, piece) for home in homes[::2] for piece in home.furniture if piece.kind == "low shelf"]
    surfaces = set()
    for home, shelf in shelves:
        for thing in home.objects:
            if thing.label == "picture" or thing.size_m[2] < 0.2:
                continue
            try:
                put = moved(rng, thing, shelf, [])
            except BadMessageError:
                continue
            assert not reaches_into(put, shelf), thing.label
            surfaces.add(put.surface)
    assert surfaces == {0, 1}


def test_pictures_hang_on_walls_beside_windows_or_find_no_room(homes: list[Home]) -> None:
    rng = np.random.default_rng(2)
    hung = 0
    for home in homes:
        pictures = [thing for thing in home.objects if thing.label == "picture"]
        for thing in pictures[:1]:
            for piece in carriers(home):
                if not any(surface.hangs for surface in piece.surfaces):
                    continue
                others = [other for other in home.objects if other is not thing]
                try:
                    put = moved(rng, thing, piece, others, walls=home.walls, windows=home.windows)
                except BadMessageError:
                    continue
                hung += 1
                inside = next(room.inside for room in home.rooms if room.name == piece.room)
                assert not inside.grown(-0.005).contains(put.footprint)
                top_m = put.z_m + put.size_m[2]
                for window in home.windows:
                    level = put.z_m < window.z_max_m and window.z_min_m < top_m
                    assert not (level and window.pane.grown(0.03).overlaps(put.footprint))
    assert hung > 10


def test_where_there_is_no_room_a_sentence_says_so(homes: list[Home]) -> None:
    home = homes[-1]
    largest = max(home.objects, key=lambda thing: thing.size_m[0] * thing.size_m[1])
    smallest = min(carriers(home), key=lambda piece: piece.footprint.area_m2)
    with pytest.raises(BadMessageError, match=f"the {smallest.name} has no room for the .* {largest.label}$"):
        moved(np.random.default_rng(0), largest, smallest, [])

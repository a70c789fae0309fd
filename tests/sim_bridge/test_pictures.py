"""Pictures for people show the whole home from above, and every room as the robot sees it."""

import numpy as np

from sim_bridge.homes.generator import generate_home
from sim_bridge.homes.rooms.room_programmes import Difficulty
from sim_bridge.pictures import robot_views, sheet, top_view

WIDTH_PX = 240


def test_the_whole_home_is_seen_from_above() -> None:
    home = generate_home(2)
    picture = top_view(home, WIDTH_PX)
    assert picture.shape[1:] == (WIDTH_PX, 3)
    # Around the home is what has no surface, in one colour: no wall reaches out of the picture.
    rim = np.concatenate([picture[0], picture[-1], picture[:, 0], picture[:, -1]])
    assert (rim == rim[0]).all()
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 500


def test_each_room_is_seen_with_things_in_it() -> None:
    home = generate_home(2)
    views = robot_views(home, WIDTH_PX)
    assert list(views) == [room.name for room in home.rooms]
    for name, view in views.items():
        assert view.shape == (WIDTH_PX * 3 // 4, WIDTH_PX, 3), name
        assert view.std(axis=(0, 1)).max() > 12, f"the view of the {name} shows next to nothing"


def test_a_sheet_has_rows_for_all_rooms() -> None:
    for difficulty in (Difficulty.EASY, Difficulty.MEDIUM):
        home = generate_home(1, difficulty=difficulty)
        picture = sheet(home, WIDTH_PX)
        above = top_view(home, WIDTH_PX)
        assert picture.shape[1] == WIDTH_PX
        assert len(picture) > len(above)
        assert (picture[: len(above)] == above).all()

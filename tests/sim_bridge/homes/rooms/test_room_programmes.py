"""Which rooms homes have: the names and kinds that every number of rooms brings."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.rooms.room_programmes import NEEDS, Difficulty, draw_programme, room_count_of


@pytest.mark.parametrize("room_count", range(1, 11))
def test_a_home_has_the_rooms_that_its_size_calls_for(room_count: int) -> None:
    for seed in range(100):
        programme = draw_programme(np.random.default_rng(seed), room_count)
        kinds = {room.kind for room in programme}
        assert len({room.name for room in programme}) == len(programme) == room_count
        assert kinds <= set(NEEDS)
        assert room_count != 2 or "kitchen" in kinds
        assert room_count < 3 or {"living room", "kitchen", "bedroom"} <= kinds
        assert room_count < 4 or "bathroom" in kinds
        assert ("hallway" in kinds) == (room_count >= 5)


def test_difficulties_bring_their_numbers_of_rooms() -> None:
    rng = np.random.default_rng(0)
    counts = {level: {room_count_of(rng, level) for _ in range(200)} for level in Difficulty}
    assert counts == {Difficulty.EASY: {1}, Difficulty.MEDIUM: {3, 4}, Difficulty.HARD: set(range(6, 11))}


@pytest.mark.parametrize("room_count", [0, 11])
def test_other_numbers_of_rooms_are_refused(room_count: int) -> None:
    with pytest.raises(BadSceneError, match=f"1..10 rooms, not {room_count}"):
        draw_programme(np.random.default_rng(0), room_count)


def test_every_kind_of_room_appears() -> None:
    kinds = {room.kind for seed in range(60) for room in draw_programme(np.random.default_rng(seed), 10)}
    assert kinds == set(NEEDS)

"""A side is judged alike in a walk and in its mirror image, and learned from where it was said."""

import numpy as np
import pytest

from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.scene import scene_of
from robustnav_nodes.instruction.side_model import (
    ARRIVING,
    FEATURES,
    LEAVING,
    RANK,
    SIDES,
    WAY_BY_1,
    WAY_BY_2,
    learn_sides,
    mirrored,
    side_features,
    walk_sides,
)
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import SeenObject, Trajectory, Viewpoint
from tests.instruction.small_world import in_mirror, said_walks

TOKENS = tokenized("Pass the bed on your left and turn right at the painting.")


@pytest.mark.parametrize("number", [0, 1])
def test_the_other_side_in_the_mirror_is_the_same(walk: Trajectory, number: int) -> None:
    scene = scene_of(walk)
    mentions = find_mentions(TOKENS)
    m = [k for k, mention in enumerate(mentions) if mention.concept in SIDES][number]
    left, right = (side_features(walk_sides(scene), scene, TOKENS, mentions, m, sign) for sign in (1.0, -1.0))
    assert left.shape == (len(scene), FEATURES)
    assert not np.allclose(left, right)
    other = in_mirror(scene)
    assert np.allclose(side_features(walk_sides(other), other, TOKENS, mentions, m, -1.0), left)
    assert np.allclose(mirrored(left), right)


def test_the_leftmost_in_the_mirror_is_the_rightmost() -> None:
    doors = tuple(SeenObject(name="door", bearing_rad=bearing, range_m=2.0) for bearing in (0.6, -0.6))
    walk = Trajectory(
        viewpoints=tuple(
            Viewpoint(
                x_m=x, y_m=0.6 * x, z_m=0.0, yaw_in_rad=0.0, yaw_out_rad=0.0, objects=() if at else doors
            )
            for at, x in enumerate((0.0, 1.0, 2.0))
        )
    )
    tokens = tokenized("take the leftmost door")
    mentions = find_mentions(tokens)
    scene, other = scene_of(walk), in_mirror(scene_of(walk))
    left, right = (side_features(walk_sides(scene), scene, tokens, mentions, 0, sign) for sign in (1.0, -1.0))
    assert left[0, RANK] > 0.5
    assert right[0, RANK] < -0.5
    assert np.allclose(side_features(walk_sides(other), other, tokens, mentions, 0, -1.0), left)


def test_a_thing_to_the_left_speaks_for_the_left(walk: Trajectory) -> None:
    """The bed, named before "on your left", stands to the left of the first viewpoint."""
    scene = scene_of(walk)
    mentions = find_mentions(TOKENS)
    m = next(k for k, mention in enumerate(mentions) if mention.concept == "left")
    left, right = (side_features(walk_sides(scene), scene, TOKENS, mentions, m, sign) for sign in (1.0, -1.0))
    assert left[0, ARRIVING] > 0.5
    assert left[0, LEAVING] > 0.5
    assert right[0, ARRIVING] < -0.5


def test_a_way_to_the_left_of_a_thing_is_a_way_by_its_left_side() -> None:
    """The couch stands ahead on the right; the way goes straight on, left of it, then to its right."""
    couch = (SeenObject(name="couch", bearing_rad=-0.6, range_m=1.0),)
    walk = Trajectory(
        viewpoints=tuple(
            Viewpoint(x_m=x, y_m=y, z_m=0.0, yaw_in_rad=0.0, yaw_out_rad=0.0, objects=() if at else couch)
            for at, (x, y) in enumerate(((0.0, 0.0), (1.0, 0.0), (1.0, -2.0)))
        )
    )
    tokens = tokenized("walk to the left of the couch")
    scene, mentions = scene_of(walk), find_mentions(tokens)
    left, right = (side_features(walk_sides(scene), scene, tokens, mentions, 0, sign) for sign in (1.0, -1.0))
    assert left[0, WAY_BY_1] > 0.2 > -0.2 > right[0, WAY_BY_1]
    assert right[0, WAY_BY_2] > 0.1 > -0.1 > left[0, WAY_BY_2]
    assert left[0, ARRIVING] < -0.2  # the couch itself is on the right


def test_what_was_said_at_turns_is_learned() -> None:
    rows, placed = [], []
    for one in said_walks(homes=3, walks=4, seed=0):
        scene = scene_of(one.trajectory)
        mentions = find_mentions(one.tokens)
        for m, mention in enumerate(mentions):
            if mention.concept in SIDES:
                sign = SIDES[mention.concept]
                rows.append(side_features(walk_sides(scene), scene, one.tokens, mentions, m, sign))
                placed.append(np.eye(len(scene))[np.abs(scene.turn_rad).argmax()])
    sides = learn_sides(rows, placed, seed=1, epochs=40)
    right_place = np.concatenate(placed) > 0.5
    found = np.concatenate([sides.log_ratio(row) for row in rows])
    wrong_side = np.concatenate([sides.log_ratio(mirrored(row)) for row in rows])
    assert found[right_place].mean() > 1.0  # likelier there than anywhere
    assert wrong_side[right_place].mean() < -1.0
    assert np.array_equal(learn_sides(rows, placed, seed=1, epochs=40).out, sides.out)


def test_without_a_side_nothing_is_known_of_sides() -> None:
    assert learn_sides([], [], seed=1, epochs=2).log_ratio(np.ones((3, FEATURES))).tolist() == [0.0] * 3

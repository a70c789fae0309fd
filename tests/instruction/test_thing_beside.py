"""A side is said of the thing that is named beside it, and the outermost of several is told from the rest."""

import math

import pytest

from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.scene import FAR_M, TO_THE_END, Scene, scene_of, way_ahead_m
from robustnav_nodes.instruction.side_model import SIDES
from robustnav_nodes.instruction.thing_beside import nearest_views, outermost, thing_beside
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import SeenObject, Trajectory, Viewpoint


def scene_with(*things: tuple[str, float, float], steps: int = 3, turn_rad: float = 0.0) -> Scene:
    """A walk along x, then to the side, metre by metre; `things` (name, x, y) are seen from its start."""
    viewpoints = []
    for at in range(steps):
        x, y = (1.0 + (at - 1) * math.cos(turn_rad), (at - 1) * math.sin(turn_rad)) if at else (0.0, 0.0)
        yaw_out = 0.0 if at == 0 else turn_rad
        seen = tuple(
            SeenObject(name=name, bearing_rad=math.atan2(there, ahead), range_m=math.hypot(ahead, there))
            for name, ahead, there in things
        )
        viewpoints.append(
            Viewpoint(
                x_m=x,
                y_m=y,
                z_m=0.0,
                yaw_in_rad=0.0 if at < 2 else turn_rad,
                yaw_out_rad=yaw_out,
                objects=seen if at == 0 else (),
            )
        )
    return scene_of(Trajectory(viewpoints=tuple(viewpoints)))


@pytest.mark.parametrize(
    ("text", "thing"),
    [
        ("pass the couch on your left", "couch"),
        ("keep the teddy bear on your left and go on", "teddy bear"),
        ("turn left at the window", "window"),
        ("turn left and walk straight ahead until you are at the window", None),
        ("turn left . stop at the unicorn", None),
        ("pass the teddy bear and go on to the left", "teddy bear"),
        ("pass the teddy bear and then go on to the left", None),
        ("walk past the couch . turn left", None),
        ("take the window to the left of the couch", "couch"),
        ("pass the window on the left side of the room", None),
        ("left", None),
    ],
)
def test_the_thing_of_a_side(text: str, thing: str | None) -> None:
    scene = scene_with(("couch", 1.0, 1.0), ("Teddy_Bear", 2.0, 1.0), ("window", 2.0, 0.0))
    tokens = tokenized(text)
    mentions = find_mentions(tokens)
    m = next(k for k, mention in enumerate(mentions) if mention.concept in SIDES)
    assert thing_beside(scene, tokens, mentions, m) == thing


def test_where_the_way_goes_on() -> None:
    scene = scene_with(
        steps=4, turn_rad=3.6
    )  # backwards, so that the last yaw has a negative sine and cosine
    ahead, aside = way_ahead_m(scene, 1)
    assert ahead == pytest.approx([1.0, math.cos(3.6), 1.0, 0.0])
    assert aside == pytest.approx([0.0, math.sin(3.6), 0.0, 0.0], abs=1e-12)
    far, _ = way_ahead_m(scene, TO_THE_END)
    assert far == pytest.approx([1.0 + 2.0 * math.cos(3.6), 2.0 * math.cos(3.6), 1.0, 0.0])
    assert math.atan2(aside[-1], ahead[-1]) == 0.0  # straight on


def test_the_nearest_of_several_is_seen() -> None:
    scene = scene_with(("chair", 0.0, 2.0), ("dining chair", 0.0, -1.0))
    ranges, bearings = nearest_views(scene, "chair")
    assert ranges.tolist() == pytest.approx([1.0, FAR_M, FAR_M])
    assert bearings[0] == pytest.approx(-math.pi / 2.0)


def test_the_way_leads_to_the_leftmost_door_or_the_rightmost() -> None:
    doors = (("door", 1.0, 1.5), ("door", 2.0, 0.0), ("door", 1.0, -1.5))
    assert outermost(scene_with(*doors, turn_rad=math.radians(90.0)), "door")[0] > 0.1
    assert outermost(scene_with(*doors, turn_rad=math.radians(-90.0)), "door")[0] < -0.1
    for order in (doors, doors[::-1], doors[::2], doors[::-2]):
        assert outermost(scene_with(*order), "door")[0] == pytest.approx(0.0, abs=1e-9)


def test_what_is_seen_at_an_unknown_distance_is_no_outermost() -> None:
    seen = tuple(SeenObject(name="door", bearing_rad=bearing) for bearing in (-0.5, 0.5))
    one = Viewpoint(x_m=0.0, y_m=0.0, z_m=0.0, yaw_in_rad=0.0, yaw_out_rad=0.0, objects=seen)
    assert outermost(scene_of(Trajectory(viewpoints=(one, one))), "door").tolist() == [0.0, 0.0]


def test_one_thing_alone_is_no_outermost() -> None:
    twice = (("door", 1.0, 0.5), ("door", 1.1, 0.5))  # one door, seen a little beside itself
    assert outermost(scene_with(*twice), "door").tolist() == [0.0, 0.0, 0.0]


def test_a_walk_of_one_viewpoint_leads_nowhere() -> None:
    scene = scene_with(("door", 1.0, 1.0), ("door", 1.0, -1.0), steps=1)
    assert outermost(scene, "door").shape == (1,)

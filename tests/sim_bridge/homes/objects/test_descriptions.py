"""What people call objects: short, in English, and never two objects by one name."""

import numpy as np
import pytest

from sim_bridge.homes.home import SmallObject
from sim_bridge.homes.materials import Pattern, Substance
from sim_bridge.homes.objects.catalogue import object_class
from sim_bridge.homes.objects.descriptions import describe
from sim_bridge.homes.scene import Look, Size


def thing(
    instance: int,
    words: str,
    furniture: str = "desk 1",
    room: str = "kitchen",
    label: str = "mug",
    size: Size = Size.MEDIUM,
) -> SmallObject:
    colour, pattern, substance = words.split()
    look = Look(colour=colour, substance=Substance(substance), pattern=Pattern(pattern), size=size)
    return SmallObject(
        instance=instance,
        label=label,
        look=look,
        room=room,
        furniture=furniture,
        surface=0,
        x_m=0.0,
        y_m=0.0,
        z_m=0.75,
        yaw_rad=0.0,
        parts=object_class(label).parts(look),
    )


RED = thing(0, "red striped ceramic")


def test_attributes_are_what_a_person_can_say() -> None:
    small = thing(3, "blue plain metal", "dining table 2", "bedroom 2", "bottle", Size.SMALL)
    assert small.attributes == (
        ("class", "bottle"),
        ("colour", "blue"),
        ("material", "metal"),
        ("pattern", "plain"),
        ("size", "small"),
        ("on", "dining table"),
        ("room", "bedroom 2"),
    )


@pytest.mark.parametrize(
    ("others", "phrase"),
    [
        ([], "the mug"),
        ([RED], "the mug"),
        ([thing(1, "red plain ceramic", label="book")], "the mug"),
        ([thing(1, "blue striped ceramic")], "the red mug"),
        ([thing(1, "red plain ceramic")], "the striped mug"),
        ([thing(1, "red striped metal")], "the ceramic mug"),
        ([thing(1, "red striped ceramic", size=Size.LARGE)], "the medium-sized mug"),
        ([thing(1, "red striped ceramic", "chair 3")], "the mug on the desk"),
        ([thing(1, "red striped ceramic", "desk 2", "office")], "the mug in the kitchen"),
        ([thing(1, "red striped ceramic", "desk 2")], None),
        ([thing(1, "red plain ceramic"), thing(2, "blue striped ceramic")], "the red striped mug"),
        (
            [
                thing(1, "blue striped ceramic"),
                thing(2, "red plain ceramic"),
                thing(3, "red striped metal"),
                thing(4, "red striped ceramic", size=Size.SMALL),
                thing(5, "red striped ceramic", "chair 1"),
                thing(6, "red striped ceramic", "desk 2", "office"),
            ],
            "the medium-sized red striped ceramic mug on the desk in the kitchen",
        ),
    ],
)
def test_phrases_worked_by_hand(others: list[SmallObject], phrase: str | None) -> None:
    everything = "the medium-sized red striped ceramic mug on desk 1 in the kitchen"
    assert describe(RED, others) == (phrase or everything)


def test_english_is_kept() -> None:
    wooden = thing(0, "red plain wood", label="lamp", room="bedroom 2")
    assert describe(wooden, [thing(1, "red plain metal", label="lamp")]) == "the wooden lamp"
    assert describe(wooden, [thing(1, "red plain wood", label="lamp")]) == "the lamp in bedroom 2"
    above = thing(0, "brown plain wood", "sofa 1", label="picture")
    assert (
        describe(above, [thing(1, "brown plain wood", "bed 1", label="picture")])
        == "the picture above the sofa"
    )


def test_a_phrase_never_has_more_attributes_than_it_needs() -> None:
    rng = np.random.default_rng(0)
    looks = object_class("mug").looks.all()
    for _ in range(100):
        chosen = [looks[int(at)] for at in rng.choice(len(looks), size=8, replace=False)]
        mugs = [
            thing(n, f"{look.colour} {look.pattern} {look.substance}", size=look.size)
            for n, look in enumerate(chosen)
        ]
        phrases = [describe(mug, mugs) for mug in mugs]
        assert len(set(phrases)) == len(mugs)
        for mug, phrase in zip(mugs, phrases, strict=True):
            colour_tells = all(other.look.colour != mug.look.colour for other in mugs if other is not mug)
            assert (phrase == f"the {mug.look.colour} mug") == colour_tells

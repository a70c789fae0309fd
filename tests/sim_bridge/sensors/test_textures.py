"""Surfaces have colours between 0 and 1, patterns of two colours, and details that fade with distance."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from sim_bridge.homes.materials import COLOURS, Material, Pattern, Substance
from sim_bridge.homes.objects.catalogue import CLASSES
from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.shapes import Part, ball, box, cylinder
from sim_bridge.sensors.camera import camera_model, look_at
from sim_bridge.sensors.scenery import PATTERN_CODE, SUBSTANCE_CODE, Item, Scenery, second_colour
from sim_bridge.sensors.textures import BACKGROUND_RGB, albedo, pattern_share

PERIOD_M = 0.05
NEAR_PX_M, FAR_PX_M = 0.0003, 0.5
PRINTED = [pattern for pattern in Pattern if pattern is not Pattern.PLAIN]


def swatch(substance: Substance, pattern: Pattern, colour: str, footprint_m: float) -> np.ndarray:
    """Colours at places scattered over a square metre, [n, 3]."""
    material = Material(substance=substance, colour=colour, pattern=pattern)
    colours = (*material.rgb, *second_colour(material))
    look = SUBSTANCE_CODE[substance], PATTERN_CODE[pattern]
    places = np.random.default_rng(0).uniform(-0.5, 0.5, (400, 2))
    return np.array([albedo(look, colours, (s, t, s, t), PERIOD_M, footprint_m) for s, t in places.tolist()])


def picture_of(part: Part, distance_m: float = 1.0, width: int = 160) -> np.ndarray:
    item = Item(number=1, name="it", parts=(part,), light_m=(1.0, -1.0, 2.0))
    frame = look_at(
        Scenery([item]),
        camera_model(width, width * 3 // 4, 0.6),
        (distance_m, -0.2, 0.3 * distance_m),
        (0.0, 0.0, 0.0),
    )
    assert frame.color is not None
    return frame.color.pixels


@pytest.mark.parametrize("substance", Substance)
@pytest.mark.parametrize("pattern", Pattern)
def test_every_material_has_colours_between_0_and_1(substance: Substance, pattern: Pattern) -> None:
    for colour in COLOURS:
        material = Material(substance=substance, colour=colour, pattern=pattern)
        colours = (*material.rgb, *second_colour(material))
        look = SUBSTANCE_CODE[substance], PATTERN_CODE[pattern]
        for s, t in ((0.0, 0.0), (0.013, -0.7), (-3.31, 8.2), (1e3, -1e3)):
            for footprint_m in (NEAR_PX_M, 0.01, FAR_PX_M):
                rgb = np.array(albedo(look, colours, (s, t, s, t), PERIOD_M, footprint_m))
                assert ((rgb >= 0.0) & (rgb <= 1.0)).all()


@pytest.mark.parametrize("substance", Substance)
def test_a_plain_material_keeps_its_colour_on_the_whole(substance: Substance) -> None:
    mean = swatch(substance, Pattern.PLAIN, "beige", 0.002).mean(axis=0)
    np.testing.assert_allclose(mean, COLOURS["beige"], rtol=0.08)


@pytest.mark.parametrize("pattern", PRINTED)
@pytest.mark.parametrize("colour", ["red", "white"])
def test_patterns_show_two_colours(pattern: Pattern, colour: str) -> None:
    material = Material(substance=Substance.CERAMIC, colour=colour, pattern=pattern)
    shown = swatch(Substance.CERAMIC, pattern, colour, NEAR_PX_M)
    for rgb in (material.rgb, second_colour(material)):
        assert (np.abs(shown - rgb).max(axis=1) < 0.01).mean() > 0.2


@pytest.mark.parametrize("pattern", PRINTED)
def test_patterns_far_away_are_their_mean(pattern: Pattern) -> None:
    rng = np.random.default_rng(1)
    places = rng.uniform(-1.0, 1.0, (3000, 2)).tolist()
    code = PATTERN_CODE[pattern]
    near = [pattern_share(code, s, t, PERIOD_M, NEAR_PX_M) for s, t in places]
    far = [pattern_share(code, s, t, PERIOD_M, FAR_PX_M) for s, t in places]
    assert np.ptp(far) < 0.01
    assert np.mean(near) == pytest.approx(np.mean(far), abs=0.03)


@pytest.mark.parametrize("substance", Substance)
def test_details_fade_with_distance(substance: Substance) -> None:
    near = swatch(substance, Pattern.PLAIN, "oak", NEAR_PX_M).std(axis=0).mean()
    far = swatch(substance, Pattern.PLAIN, "oak", FAR_PX_M).std(axis=0).mean()
    plain = {Substance.PAINT, Substance.CERAMIC, Substance.GLASS, Substance.PLASTIC, Substance.LIGHT}
    assert near >= far
    if substance not in plain:
        assert near > 0.003
    assert far < 0.02


def test_stripes_run_across_the_longer_side() -> None:
    code = PATTERN_CODE[Pattern.STRIPED]
    along = [pattern_share(code, s, 0.01, PERIOD_M, NEAR_PX_M) for s in (0.0, 0.025, 0.05)]
    assert along == pytest.approx([0.0, 1.0, 0.0])
    assert len({pattern_share(code, 0.0125, t, PERIOD_M, NEAR_PX_M) for t in (0.0, 0.02, 0.04)}) == 1


@pytest.mark.parametrize("shape", ["box", "cylinder", "ball"])
@pytest.mark.parametrize("pattern", PRINTED)
def test_a_small_thing_shows_its_pattern_in_the_picture(shape: str, pattern: Pattern) -> None:
    material = Material(substance=Substance.CERAMIC, colour="navy", pattern=pattern)
    centre = (0.0, 0.0, 0.0)
    part = {
        "box": box(centre, (0.1, 0.1, 0.12), material),
        "cylinder": cylinder(centre, 0.09, 0.12, material),
        "ball": ball(centre, 0.12, material),
    }[shape]
    seen = picture_of(part, distance_m=0.5)
    seen = seen[(seen != BACKGROUND_RGB).any(axis=2)].astype(int)
    light, dark = seen.sum(axis=1) > 420, seen[:, 2] - seen[:, 0] > 20
    assert light.mean() > 0.1
    assert dark.mean() > 0.1


def test_the_same_picture_twice_is_equal_bytes() -> None:
    part = box((0.0, 0.0, 0.0), (0.4, 0.3, 0.2), Material(substance=Substance.WOOD, colour="oak"))
    assert picture_of(part).tobytes() == picture_of(part).tobytes()


def test_lamps_glow_whatever_lights_them() -> None:
    glow = Material(substance=Substance.LIGHT, colour="glow")
    seen = picture_of(ball((0.0, 0.0, 0.0), 0.2, glow))
    seen = seen[(seen != BACKGROUND_RGB).any(axis=2)]
    assert len(seen) > 100
    assert len(np.unique(seen, axis=0)) == 1
    dull = picture_of(ball((0.0, 0.0, 0.0), 0.2, replace(glow, substance=Substance.PAINT)))
    assert len(np.unique(dull.reshape(-1, 3), axis=0)) > 20


def test_faces_of_one_material_differ() -> None:
    seen = picture_of(
        box((0.0, 0.0, 0.0), (0.2, 0.2, 0.2), Material(substance=Substance.PLASTIC, colour="grey"))
    )
    levels = seen[60, 40:120].sum(axis=1).astype(int)
    assert np.ptp(levels[levels != sum(BACKGROUND_RGB)]) > 15


@pytest.mark.parametrize("item", CLASSES, ids=lambda item: item.label)
def test_no_two_substances_of_a_class_look_the_same(item: ObjectClass) -> None:
    """At a distance of 2 m and 320 x 240, where most grain has faded."""
    for colour in item.looks.colours:
        shown = {}
        for substance in item.looks.substances:
            part = cylinder((0.0, 0.0, 0.0), 0.10, 0.25, Material(substance=substance, colour=colour))
            shown[substance] = picture_of(part, distance_m=2.0, width=180).astype(float)
        for first, second in combinations(item.looks.substances, 2):
            apart = np.abs(shown[first] - shown[second]).max(axis=2)
            assert apart[apart > 0.0].mean() > 2.0, (colour, first, second)

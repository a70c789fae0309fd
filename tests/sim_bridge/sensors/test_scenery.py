"""Triangles are what the parts say, and every thing in sight has a number."""

import math

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Home
from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder
from sim_bridge.sensors.hulls import GLOBE, MANTLE
from sim_bridge.sensors.scenery import FIRST_OTHER, Item, Scenery, scenery_of, second_colour

PAINT = material("red paint")
PARTS = [
    box((0.3, -0.2, 0.5), (0.4, 0.6, 1.0), PAINT),
    *(cylinder((0.3, -0.2, 0.5), 0.3, 0.8, PAINT, axis) for axis in Axis),
    cylinder((0.0, 0.0, 0.0), 0.02, 0.1, PAINT),
    ball((0.3, -0.2, 0.5), 0.4, PAINT),
]


def lone(part: Part) -> Scenery:
    return Scenery([Item(number=1, name="it", parts=(part,), light_m=(0.0, 0.0, 2.3))])


@pytest.mark.parametrize("part", PARTS, ids=lambda part: f"{part.shape}-{part.axis.name}")
def test_triangles_close_and_look_outwards(part: Part) -> None:
    mesh = lone(part).mesh
    a, b, c = (mesh.vertex_m[mesh.triangle[:, corner]] - part.centre_m for corner in range(3))
    # Each edge is there once in each direction (corners of a box are told by place, not by number).
    places = {tuple(row): at for at, row in enumerate(np.round(mesh.vertex_m, 9).tolist())}
    number = np.array([places[tuple(row)] for row in np.round(mesh.vertex_m, 9).tolist()])
    corners = number[mesh.triangle]
    edges = {(int(row[k]), int(row[(k + 1) % 3])) for row in corners for k in range(3)}
    assert len(edges) == 3 * len(corners)
    assert all((j, i) in edges for i, j in edges)
    middle = (a + b + c) / 3.0
    assert ((mesh.triangle_plane[:, :3] * middle).sum(axis=1) > 0.0).all()
    # The volume that the triangles enclose is the part's, but for the polygons.
    volume = (a * np.cross(b, c)).sum() / 6.0
    x, y, z = part.size_m
    true = {"box": x * y * z, "cylinder": math.pi / 4.0 * x * y * z, "ball": math.pi / 6.0 * x * y * z}
    across = part.size_m[part.axis] * part.size_m[part.axis.others[0]] ** 2
    true["cylinder"] = math.pi / 4.0 * across
    assert volume == pytest.approx(true[part.shape], rel=0.07)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: f"{part.shape}-{part.axis.name}")
def test_flat_faces_are_named_by_where_they_look(part: Part) -> None:
    mesh = lone(part).mesh
    flat = mesh.triangle_face < MANTLE
    for face, plane in zip(mesh.triangle_face[flat], mesh.triangle_plane[flat], strict=True):
        expected = np.zeros(3)
        expected[face // 2] = 2 * (face % 2) - 1
        np.testing.assert_allclose(plane[:3], expected, atol=1e-9)
    assert (mesh.triangle_face <= GLOBE).all()


def test_the_ball_around_an_item_holds_all_of_it(small_home: Home) -> None:
    mesh = scenery_of(small_home).mesh
    for item, sphere in enumerate(mesh.item_sphere_m):
        own = mesh.vertex_m[mesh.item_vertices[item] : mesh.item_vertices[item + 1]]
        assert np.linalg.norm(own - sphere[:3], axis=1).max() <= sphere[3]


def test_everything_in_a_home_has_a_number_of_its_own(small_home: Home) -> None:
    scenery = scenery_of(small_home)
    names = [item.name for item in scenery.items.values()]
    assert scenery.instance_of == {thing.instance: thing.instance for thing in small_home.objects}
    assert names.count("wall") == len(small_home.walls)
    assert {"table", "chest", "floor of kitchen", "window of bedroom"} <= set(names)
    assert len(names) == 2 + len(small_home.walls) + 1 + 2 + 3
    assert all(number >= FIRST_OTHER for number in scenery.items if number not in scenery.instance_of)


def test_each_thing_is_lit_by_the_lamp_of_its_room(small_home: Home) -> None:
    lamp_of = {item.name: item.light_m for item in scenery_of(small_home).items.values()}
    assert lamp_of["table"] == pytest.approx((2.0, 1.75, 2.3))
    assert lamp_of["window of bedroom"] == pytest.approx((6.0, 1.75, 2.3))


def test_moving_changes_the_pose_of_one_item(small_home: Home) -> None:
    scenery = scenery_of(small_home)
    before = scenery.mesh.item_pose.copy()
    scenery.move(1, 1.0, 2.0, 0.5, math.pi / 2.0)
    changed = (scenery.mesh.item_pose != before).any(axis=1)
    assert scenery.mesh.item_number[changed].tolist() == [1]
    np.testing.assert_allclose(scenery.mesh.item_pose[changed][0], (1.0, 2.0, 0.5, 0.0, 1.0), atol=1e-12)


def test_wrong_numbers_are_refused(small_home: Home) -> None:
    item = Item(number=3, name="one", parts=(PARTS[0],), light_m=(0.0, 0.0, 2.3))
    with pytest.raises(BadSceneError, match="two things in sight have the number 3"):
        Scenery([item, item])
    with pytest.raises(BadSceneError, match="nothing in sight has the number 99"):
        scenery_of(small_home).move(99, 0.0, 0.0, 0.0, 0.0)


def test_an_empty_scenery_has_no_triangles() -> None:
    assert Scenery([]).mesh.triangle.shape == (0, 3)


def test_patterns_stand_out_from_their_colour() -> None:
    assert sum(second_colour(material("navy fabric"))) > 2.0
    assert sum(second_colour(material("cream fabric"))) < 1.0

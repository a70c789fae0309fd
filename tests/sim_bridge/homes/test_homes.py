"""Generated homes hold together, whatever the seed."""

import numpy as np
import pytest
from scipy import ndimage

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.floor_plan import FREE, OCCUPIED, RESOLUTION_M, candidate_mask, floor_plan
from sim_bridge.homes.furniture import BUILDERS
from sim_bridge.homes.generator import generate_home
from sim_bridge.homes.home import Home
from sim_bridge.homes.objects import CLASSES, COLOURS, LABELS
from sim_bridge.homes.objects.arrangement import UNIQUE_CLASSES
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.shapes import Part, Shape, extent

PLANNERS_RADIUS_M = 0.18


def test_homes_have_rooms_furniture_and_objects(homes: list[Home]) -> None:
    for home in homes:
        kinds = {room.kind for room in home.rooms}
        labels = [thing.label for thing in home.objects]
        assert len(home.rooms) >= 3
        assert {"kitchen", "living room", "bedroom"} <= kinds
        assert len(labels) >= 12
        assert len(set(labels)) >= 8
        assert sum(labels.count(label) == 1 for label in set(labels)) >= UNIQUE_CLASSES
        assert len({room.name for room in home.rooms}) == len(home.rooms)


def test_seeds_give_homes_of_every_size(homes: list[Home]) -> None:
    assert {len(home.rooms) for home in homes} == {3, 4, 5, 6}


def test_the_whole_free_floor_is_reached_from_the_start(homes: list[Home]) -> None:
    for home in homes:
        plan = floor_plan(home)
        # From the middle of a cell to the edge of the nearest one that is not free, at most a little less.
        clearance = ndimage.distance_transform_edt(plan.cells == FREE) * RESOLUTION_M - RESOLUTION_M / 2
        parts, _ = ndimage.label(clearance >= PLANNERS_RADIUS_M)
        row = int((home.start.y_m - plan.origin.y_m) / RESOLUTION_M)
        column = int((home.start.x_m - plan.origin.x_m) / RESOLUTION_M)
        assert parts[row, column] > 0
        reached = parts == parts[row, column]
        assert reached.sum() >= 0.995 * (parts > 0).sum()
        rows, columns = np.nonzero(reached)
        x_m = plan.origin.x_m + (columns + 0.5) * RESOLUTION_M
        y_m = plan.origin.y_m + (rows + 0.5) * RESOLUTION_M
        for room in home.rooms:
            inside = room.inside
            in_x = (x_m > inside.x_min_m) & (x_m < inside.x_max_m)
            assert (in_x & (y_m > inside.y_min_m) & (y_m < inside.y_max_m)).sum() > 100
        for piece in home.furniture:
            if piece.carries:
                near = piece.footprint.grown(0.5)
                in_x = (x_m > near.x_min_m) & (x_m < near.x_max_m)
                assert (in_x & (y_m > near.y_min_m) & (y_m < near.y_max_m)).any(), piece.name


def test_nothing_overlaps(homes: list[Home]) -> None:
    for home in homes:
        blocks = [*(wall.base for wall in home.walls if wall.z_min_m == 0.0)]
        footprints = [piece.footprint for piece in home.furniture]
        for at, footprint in enumerate(footprints):
            others = footprints[:at] + blocks
            assert not any(footprint.overlaps(other) for other in others), home.furniture[at].name
        for at, thing in enumerate(home.objects):
            for other in home.objects[:at]:
                same_height = abs(thing.z_m - other.z_m) < 0.3
                assert not (same_height and thing.footprint.overlaps(other.footprint))


def test_walls_do_not_overlap_and_leave_the_doors_open(homes: list[Home]) -> None:
    for home in homes:
        low = [wall.base for wall in home.walls if wall.z_min_m == 0.0]
        for at, wall in enumerate(low):
            assert not any(wall.overlaps(other) for other in low[:at])
        for door in home.doors:
            assert door.width_m >= 0.9 - 1e-9
            assert not any(door.opening.overlaps(wall) for wall in low)
            assert not any(door.opening.overlaps(piece.footprint) for piece in home.furniture)


def test_every_object_stands_on_furniture_of_its_room_in_a_candidate_cell(homes: list[Home]) -> None:
    for home in homes:
        mask = candidate_mask(home)
        pieces = {piece.name: piece for piece in home.furniture}
        for thing in home.objects:
            piece = pieces[thing.furniture]
            assert piece.room == thing.room
            assert thing.z_m == piece.surfaces[0].height_m
            # What the object stands on is there: some part of the furniture ends at that height.
            tops = [part.centre_m[2] + part.size_m[2] / 2 for part in piece.parts]
            assert min(abs(top - thing.z_m) for top in tops) < 0.002, (thing.label, piece.name)
            x_m, y_m, _ = thing.centre_m
            row = int((y_m - mask.origin.y_m) / mask.resolution_m)
            column = int((x_m - mask.origin.x_m) / mask.resolution_m)
            assert mask.cells[row, column] == OCCUPIED


def test_tall_furniture_hides_and_holds_nothing(homes: list[Home]) -> None:
    for home in homes:
        mask = candidate_mask(home)
        plan = floor_plan(home)
        assert mask.cells.shape == plan.cells.shape
        assert not ((mask.cells == OCCUPIED) & (plan.cells != OCCUPIED)).any()
        for piece in home.furniture:
            row = int((piece.y_m - mask.origin.y_m) / mask.resolution_m)
            column = int((piece.x_m - mask.origin.x_m) / mask.resolution_m)
            assert plan.cells[row, column] == OCCUPIED
            assert (mask.cells[row, column] == OCCUPIED) == (not piece.tall), piece.name


def test_the_plan_shows_walls_where_they_are_and_nothing_outside(homes: list[Home]) -> None:
    for home in homes:
        plan = floor_plan(home)
        rows, columns = np.nonzero(plan.cells != -1)
        known = Rect(
            x_min_m=plan.origin.x_m + columns.min() * RESOLUTION_M,
            y_min_m=plan.origin.y_m + rows.min() * RESOLUTION_M,
            x_max_m=plan.origin.x_m + (columns.max() + 1) * RESOLUTION_M,
            y_max_m=plan.origin.y_m + (rows.max() + 1) * RESOLUTION_M,
        )
        assert known.contains(home.bounds, 1e-6)
        assert home.bounds.contains(known, 1e-6)
        occupied_m2 = (plan.cells == OCCUPIED).sum() * RESOLUTION_M**2
        assert occupied_m2 == pytest.approx(sum(rect.area_m2 for rect in home.obstacles()), rel=1e-6)


def test_same_seed_same_home() -> None:
    assert generate_home(11) == generate_home(11)
    assert generate_home(11) != generate_home(12)


def test_numbers_are_kept_and_bad_ones_refused() -> None:
    home = generate_home(5, rooms=4, objects=24)
    assert (len(home.rooms), len(home.objects)) == (4, 24)
    for wrong in ({"rooms": 2}, {"rooms": 9}, {"objects": 3}, {"objects": 1000}):
        with pytest.raises(BadSceneError, match=r"a home h.* not \d+"):
            generate_home(5, **wrong)
    with pytest.raises(BadSceneError, match="must not be negative, not -1"):
        generate_home(-1)


def test_every_class_differs_from_the_others_in_colour_or_shape() -> None:
    looks = set()
    for item in CLASSES:
        parts = item.build(COLOURS[item.colours[0]])
        low, high = extent(parts)
        assert abs(low[2]) < 1e-9, f"a {item.label} would float or sink"
        assert 0.05 < high[2] - low[2] < 0.7
        looks.add(tuple(sorted((part.shape, part.size_m) for part in parts)))
        assert set(item.belongs_on) <= set(BUILDERS)
    assert len(looks) == len(CLASSES) == len(set(LABELS))


def test_furniture_stays_within_its_footprint_and_stands_on_the_floor() -> None:
    rng = np.random.default_rng(0)
    for kind, build in BUILDERS.items():
        for _ in range(5):
            design = build(rng)
            low, high = extent(design.parts)
            assert design.kind == kind
            assert abs(low[2]) < 1e-9, kind
            assert -low[0] <= design.depth_m / 2 + 0.02, kind
            assert high[0] <= design.depth_m / 2 + 0.02, kind
            assert max(-low[1], high[1]) <= design.width_m / 2 + 1e-9, kind
            for length_m in (design.depth_m, design.width_m):
                assert length_m / RESOLUTION_M == pytest.approx(round(length_m / RESOLUTION_M))


def flickering(parts: tuple[Part, ...]) -> list[tuple[Part, Part]]:
    """Boxes of different colours with faces that lie in one plane, look the same way and overlap."""
    found = []
    boxes = [part for part in parts if part.shape is Shape.BOX]
    for at, one in enumerate(boxes):
        for other in boxes[:at]:
            centre, size = np.array([one.centre_m, other.centre_m]), np.array([one.size_m, other.size_m])
            low, high = centre - size / 2, centre + size / 2
            overlap = np.minimum(high[0], high[1]) - np.maximum(low[0], low[1])
            for axis in range(3):
                aside = [other_axis for other_axis in range(3) if other_axis != axis]
                # What faces the floor, or the wall behind, is never seen.
                faces = [high] if axis in (0, 2) else [low, high]
                if (overlap[aside] > 1e-6).all() and any(abs(np.diff(f[:, axis])) < 2e-4 for f in faces):
                    found.append((one, other))
    return [(one, other) for one, other in found if one.colour != other.colour]


def test_no_two_colours_share_a_face() -> None:
    """The renderer would show a random mixture of the two."""
    rng = np.random.default_rng(1)
    for kind, build in BUILDERS.items():
        for _ in range(5):
            assert not flickering(build(rng).parts), kind
    for item in CLASSES:
        assert not flickering(item.build(COLOURS[item.colours[0]])), item.label

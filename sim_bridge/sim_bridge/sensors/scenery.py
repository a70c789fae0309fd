"""A home as triangles: what the camera's rasteriser reads.

Every thing in sight is an `Item` with a number, which the picture of numbers shows. Objects have the number
of their instance; everything else is numbered from FIRST_OTHER.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Float64
from sim_bridge.homes.home import WALL_THICKNESS_M, Home, Room, Wall, Window
from sim_bridge.homes.materials import COLOURS, Colour, Material, Pattern, Substance
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.shapes import Part, Shape, Vector3, box, extent
from sim_bridge.sensors.finishes import finish_of, shown_rgb
from sim_bridge.sensors.hulls import BOTTOM, EAST, NORTH, SOUTH, WEST, Int32, hull_of

FLOOR_THICKNESS_M = 0.05
LAMP_HEIGHT_M = 2.3
# Numbers below this are instances of objects.
FIRST_OTHER = 1 << 20

_FACE_OF_SIDE = {Side.WEST: WEST, Side.EAST: EAST, Side.SOUTH: SOUTH, Side.NORTH: NORTH}

SHAPE_CODE = {shape: code for code, shape in enumerate(Shape)}
SUBSTANCE_CODE = {substance: code for code, substance in enumerate(Substance)}
PATTERN_CODE = {pattern: code for code, pattern in enumerate(Pattern)}

# A pattern shows this many periods over the part's largest extent, and none shorter than that.
PERIODS = 5.0
SHORTEST_PERIOD_M = 0.012
# What is lighter than this gets its pattern in charcoal, all else in cream.
LIGHT_COLOUR = 0.62
LUMINANCE = (0.30, 0.59, 0.11)

# How wide the soft border of a shadow is, half of it outside of the thing: more for what is higher.
SHADOW_PER_HEIGHT, SHORTEST_SHADOW_M, LONGEST_SHADOW_M = 0.5, 0.03, 0.22

FRAME_WIDTH_M = 0.05
# Frame and glass stand out of the wall this far, wherever in it the pane lies.
FRAME_RISE_M, GLASS_RISE_M = 0.025, 0.010
FRAME = Material(substance=Substance.PAINT, colour="white")
SKY = Material(substance=Substance.LIGHT, colour="sky")


@dataclass(frozen=True, slots=True, kw_only=True)
class Item:
    """One thing in sight, at a pose in `map`. `light_m` is where the lamp of its room hangs (`map`).

    `unseen` are the faces of its boxes that nobody can ever see.
    """

    number: int
    name: str
    parts: tuple[Part, ...]
    light_m: Vector3
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0
    unseen: tuple[int, ...] = ()


class Mesh(NamedTuple):
    """All items as arrays, for compiled code. Lengths are metres in the frame of the item, but for poses.

    Item i has the vertices `item_vertices[i]:item_vertices[i + 1]`, and its triangles likewise; corners run
    counter-clockwise as seen from outside. Positions are float64: faces that touch must not part by a pixel.
    """

    vertex_m: Float64  # [vertices, 3]
    triangle: Int32  # [triangles, 3], counted from the item's first vertex
    triangle_plane: Float64  # [triangles, 4]: outward unit normal n and d, where n . p = d
    triangle_face: Int32  # [triangles]
    triangle_part: Int32  # [triangles]
    part_item: Int32  # [parts]
    part_shape: Int32  # [parts]
    part_half_m: Float64  # [parts, 3]: its half extents
    part_look: Int32  # [parts, 5]: substance, pattern, longest axis, axis of a cylinder, variant 0..255
    part_colour: Float64  # [parts, 6]: red, green, blue, and those of the pattern
    part_finish: Float64  # [parts, 4]: gloss, sharpness, mirror, tinted (0 or 1), as Finish says
    part_frame: Float64  # [parts, 4]: its centre, and the period of its pattern
    item_vertices: Int32  # [items + 1]
    item_triangles: Int32  # [items + 1]
    item_sphere_m: Float64  # [items, 4]: centre and radius of a ball around it
    item_foot_m: Float64  # [items, 6]: of its shadow middle x, y, half extents, height, reach (0: none)
    item_pose: Float64  # [items, 5]: x, y, z in `map`, cos yaw, sin yaw
    item_light_m: Float64  # [items, 3], `map`
    item_number: Int32  # [items]
    item_first: Int32  # [items]: 1 for what hides much and costs little: walls and floors


class Scenery:
    """Everything in sight. Items can be moved; to add or remove some, build another. One thread at a time."""

    def __init__(self, items: Iterable[Item]) -> None:
        """Make the triangles (some 30 ms for 250 items). Raises BadSceneError where two share a number."""
        self.items: dict[int, Item] = {}
        for item in items:
            if item.number in self.items:
                raise BadSceneError(
                    f"two things in sight have the number {item.number!r}: "
                    f"{self.items[item.number].name!r} and {item.name!r}; give each one of its own"
                )
            self.items[item.number] = item
        self._row = {number: row for row, number in enumerate(self.items)}
        self.mesh = _mesh(tuple(self.items.values()))

    @property
    def instance_of(self) -> dict[int, int]:
        """For the number of each object its instance; what is not an object is not in it."""
        return {number: number for number in self.items if number < FIRST_OTHER}

    def move(self, number: int, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> None:
        """Put an item elsewhere (`map`); it keeps its lamp, and `items` keeps it as it was given.

        Raises BadSceneError where there is none of that number.
        """
        if number not in self._row:
            raise BadSceneError(f"nothing in sight has the number {number!r}, so it cannot be moved")
        self.mesh.item_pose[self._row[number]] = (x_m, y_m, z_m, math.cos(yaw_rad), math.sin(yaw_rad))


def scenery_of(home: Home) -> Scenery:
    """All that is to be seen in a home: floors, walls, windows, furniture, objects."""
    fixed: list[Item] = []

    def add(name: str, parts: tuple[Part, ...], light_m: Vector3, unseen: tuple[int, ...]) -> None:
        number = FIRST_OTHER + len(fixed)
        fixed.append(Item(number=number, name=name, parts=parts, light_m=light_m, unseen=unseen))

    for room in home.rooms:
        add(f"floor of {room.name}", (floor_part(room),), _lamp(room), (WEST, EAST, SOUTH, NORTH, BOTTOM))
    for wall in home.walls:
        unseen = (_FACE_OF_SIDE[wall.hidden], *(() if wall.z_min_m > 0.0 else (BOTTOM,)))
        add("wall", (wall_part(wall),), _nearest_lamp(home, wall.base), unseen)
    for window in home.windows:
        add(f"window of {window.room}", window_parts(window), _nearest_lamp(home, window.pane), ())
    furniture = [
        Item(
            number=FIRST_OTHER + len(fixed) + at,
            name=piece.name,
            parts=piece.parts,
            light_m=_nearest_lamp(home, piece.footprint),
            x_m=piece.x_m,
            y_m=piece.y_m,
            yaw_rad=piece.yaw_rad,
        )
        for at, piece in enumerate(home.furniture)
    ]
    objects = [
        Item(
            number=thing.instance,
            name=thing.label,
            parts=thing.parts,
            light_m=_nearest_lamp(home, thing.footprint),
            x_m=thing.x_m,
            y_m=thing.y_m,
            z_m=thing.z_m,
            yaw_rad=thing.yaw_rad,
        )
        for thing in home.objects
    ]
    return Scenery([*fixed, *furniture, *objects])


def floor_part(room: Room) -> Part:
    """A slab below z = 0 (`map`) that reaches half-way under the walls, so that doorways have a floor."""
    area = room.inside.grown(WALL_THICKNESS_M / 2.0)
    centre = (*area.centre_m, -FLOOR_THICKNESS_M / 2.0)
    return box(centre, (area.width_m, area.depth_m, FLOOR_THICKNESS_M), room.floor)


def wall_part(wall: Wall) -> Part:
    """A piece of wall as a box (`map`)."""
    return box(
        (*wall.base.centre_m, (wall.z_min_m + wall.z_max_m) / 2.0),
        (wall.base.width_m, wall.base.depth_m, wall.z_max_m - wall.z_min_m),
        wall.material,
    )


def window_parts(window: Window) -> tuple[Part, ...]:
    """The sky in a white frame with one upright bar (`map`)."""
    x_m, y_m = window.pane.centre_m
    along_x = window.side in (Side.SOUTH, Side.NORTH)
    width_m = window.pane.width_m if along_x else window.pane.depth_m
    deep_m = window.pane.depth_m if along_x else window.pane.width_m
    height_m = window.z_max_m - window.z_min_m
    middle_m = (window.z_min_m + window.z_max_m) / 2.0

    def piece(along_m: float, z_m: float, wide_m: float, high_m: float, rise_m: float, of: Material) -> Part:
        thick_m = deep_m + 2.0 * rise_m
        if along_x:
            return box((x_m + along_m, y_m, z_m), (wide_m, thick_m, high_m), of)
        return box((x_m, y_m + along_m, z_m), (thick_m, wide_m, high_m), of)

    edge_m, rail_m = (width_m - FRAME_WIDTH_M) / 2.0, (height_m - FRAME_WIDTH_M) / 2.0
    return (
        piece(0.0, middle_m, width_m, height_m, GLASS_RISE_M, SKY),
        piece(0.0, middle_m + rail_m, width_m, FRAME_WIDTH_M, FRAME_RISE_M, FRAME),
        piece(0.0, middle_m - rail_m, width_m, FRAME_WIDTH_M, FRAME_RISE_M, FRAME),
        *(
            piece(at_m, middle_m, FRAME_WIDTH_M, height_m - 2.0 * FRAME_WIDTH_M, FRAME_RISE_M, FRAME)
            for at_m in (-edge_m, 0.0, edge_m)
        ),
    )


def _lamp(room: Room) -> Vector3:
    return (*room.inside.centre_m, LAMP_HEIGHT_M)


def _nearest_lamp(home: Home, place: Rect) -> Vector3:
    """The lamp of the room that is nearest; a home without rooms has one over its middle."""
    if not home.rooms:
        return (*home.bounds.centre_m, LAMP_HEIGHT_M)
    return _lamp(min(home.rooms, key=lambda room: _gap_m(room.inside, place)))


def _gap_m(first: Rect, second: Rect) -> float:
    """How far two rectangles are apart; 0 where they touch."""
    dx = max(0.0, first.x_min_m - second.x_max_m, second.x_min_m - first.x_max_m)
    dy = max(0.0, first.y_min_m - second.y_max_m, second.y_min_m - first.y_max_m)
    return math.hypot(dx, dy)


def _mesh(items: tuple[Item, ...]) -> Mesh:
    vertices, triangles, firsts, faces = [], [], [], []
    part_item, part_triangles, looks, colours, finishes, frames = [], [], [], [], [], []
    shapes, halves = [], []
    item_vertices, item_triangles = [0], [0]
    for row, item in enumerate(items):
        count, triangle_count = 0, 0
        for at, part in enumerate(item.parts):
            hull = hull_of(part)
            seen = ~np.isin(hull.faces, item.unseen) if item.unseen else slice(None)
            corners = hull.triangles[seen]
            half = np.array(part.size_m) / 2.0
            vertices.append(hull.vertices * half + part.centre_m)
            triangles.append(corners + count)
            faces.append(hull.faces[seen])
            part_item.append(row)
            shapes.append(SHAPE_CODE[part.shape])
            halves.append(half)
            part_triangles.append(len(corners))
            looks.append(_look(part, at + 7 * row))
            finish = finish_of(part.material.substance)
            own, second = part.material.rgb, second_colour(part.material)
            colours.append((*shown_rgb(own, finish), *shown_rgb(second, finish)))
            finishes.append((finish.gloss, finish.sharpness, finish.mirror, finish.tinted))
            frames.append((*part.centre_m, max(SHORTEST_PERIOD_M, max(part.size_m) / PERIODS)))
            count += len(hull.vertices)
            triangle_count += len(corners)
        firsts.append(np.full(triangle_count, item_vertices[-1]))
        item_vertices.append(item_vertices[-1] + count)
        item_triangles.append(item_triangles[-1] + triangle_count)
    vertex_m = np.concatenate([np.zeros((0, 3)), *vertices])
    triangle = np.concatenate([np.zeros((0, 3), dtype=np.int32), *triangles]).astype(np.int32)
    first = np.concatenate([np.zeros(0, dtype=np.int64), *firsts])
    poses = [(i.x_m, i.y_m, i.z_m, math.cos(i.yaw_rad), math.sin(i.yaw_rad)) for i in items]
    return Mesh(
        vertex_m=vertex_m,
        triangle=triangle,
        triangle_plane=_planes(vertex_m, triangle + first[:, None]),
        triangle_face=np.concatenate([np.zeros(0, dtype=np.int32), *faces]).astype(np.int32),
        triangle_part=np.repeat(np.arange(len(part_item), dtype=np.int32), part_triangles),
        part_item=np.array(part_item, dtype=np.int32),
        part_shape=np.array(shapes, dtype=np.int32),
        part_half_m=np.array(halves, dtype=np.float64).reshape(-1, 3),
        part_look=np.array(looks, dtype=np.int32).reshape(-1, 5),
        part_colour=np.array(colours, dtype=np.float64).reshape(-1, 6),
        part_finish=np.array(finishes, dtype=np.float64).reshape(-1, 4),
        part_frame=np.array(frames, dtype=np.float64).reshape(-1, 4),
        item_vertices=np.array(item_vertices, dtype=np.int32),
        item_triangles=np.array(item_triangles, dtype=np.int32),
        item_sphere_m=np.array([_sphere(item.parts) for item in items], dtype=np.float64).reshape(-1, 4),
        item_foot_m=np.array([_foot(item) for item in items], dtype=np.float64).reshape(-1, 6),
        item_pose=np.array(poses, dtype=np.float64).reshape(-1, 5),
        item_light_m=np.array([item.light_m for item in items], dtype=np.float64).reshape(-1, 3),
        item_number=np.array([item.number for item in items], dtype=np.int32),
        item_first=np.array([bool(item.unseen) for item in items], dtype=np.int32),
    )


def _sphere(parts: tuple[Part, ...]) -> tuple[float, float, float, float]:
    low, high = (np.array(corner) for corner in extent(parts))
    x, y, z = ((low + high) / 2.0).tolist()
    # Round parts are polygons that reach out of the true ones a little.
    return x, y, z, float(np.linalg.norm(high - low)) * 0.51


def _foot(item: Item) -> tuple[float, float, float, float, float, float]:
    """What the item's shadow is made of, as Mesh says; the building throws none."""
    if item.unseen:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    low, high = extent(item.parts)
    reach_m = min(LONGEST_SHADOW_M, max(SHORTEST_SHADOW_M, SHADOW_PER_HEIGHT * (high[2] - low[2])))
    x_m, y_m = (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0
    x_half_m, y_half_m = (max(0.0, (high[at] - low[at] - reach_m) / 2.0) for at in (0, 1))
    return x_m, y_m, x_half_m, y_half_m, low[2], reach_m


def _planes(vertex_m: Float64, triangles: NDArray[np.int64]) -> Float64:
    """Outward unit normal and distance from the origin of each triangle, [n, 4]."""
    a, b, c = (vertex_m[triangles[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.concatenate([normals, (normals * a).sum(axis=1, keepdims=True)], axis=1)


def _look(part: Part, variant: int) -> tuple[int, int, int, int, int]:
    size_m = part.size_m
    longest = int(part.axis) if part.shape is Shape.CYLINDER else size_m.index(max(size_m))
    return (
        SUBSTANCE_CODE[part.material.substance],
        PATTERN_CODE[part.material.pattern],
        longest,
        int(part.axis),
        variant * 37 % 256,
    )


def second_colour(material: Material) -> Colour:
    """The colour of a material's pattern: one that stands out from its own."""
    light = sum(share * channel for share, channel in zip(LUMINANCE, material.rgb, strict=True))
    return COLOURS["charcoal" if light > LIGHT_COLOUR else "cream"]

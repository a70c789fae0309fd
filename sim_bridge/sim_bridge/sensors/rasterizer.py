"""Which triangle each pixel shows, and how far away it is: exact samples of a pinhole camera, on one core.

Pixel (u, v) is a sample of the ray through (u, v): column u, row v, the centre of the first at (0, 0), as ROS
counts. Triangles are filled row by row between their edges; a buffer of 1 / depth keeps the nearest. Floors
and walls come first, and then only those things that are not wholly behind what is already there.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32, Float64
from sim_bridge.sensors.compiled import compiled
from sim_bridge.sensors.hulls import Int32
from sim_bridge.sensors.scenery import Mesh

NOTHING = -1
NEAR_M = 0.05
# Of two surfaces in one place the first stays, unless the second is nearer by this share of the distance.
NEARER = np.float32(1.00001)
# A face whose plane is this near to the eye is seen edge-on.
EDGE_ON_M = 1e-9
# Taken from the distance of walls and floors, so that they come before all else.
FIRST_M = 1e6
# A thing with fewer triangles is drawn faster than it is found to be hidden.
WORTH_A_LOOK = 24


class View(NamedTuple):
    """A pinhole camera in `map`: rows of `turn` are its right, down and forward."""

    turn: Float64  # [3, 3], optical frame from map
    eye_m: Float64  # [3], map
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


class Samples(NamedTuple):
    """What the pixels show: 1 / depth (1/m, 0: nothing) and triangle (NOTHING: none), [height, width]."""

    nearness: Float32
    triangle: Int32


@compiled
def rasterise(mesh: Mesh, view: View) -> Samples:
    """Sample the scenery at every pixel."""
    nearness = np.zeros((view.height, view.width), dtype=np.float32)
    triangles = np.full((view.height, view.width), NOTHING, dtype=np.int32)
    vertex_counts = mesh.item_vertices[1:] - mesh.item_vertices[:-1]
    if len(vertex_counts) == 0:
        return Samples(nearness, triangles)
    points = np.empty((vertex_counts.max(), 5))
    turn = np.empty((3, 3))
    eye = np.empty(3)
    order = _front_to_back(mesh, view)
    for item in order:
        first, last = mesh.item_triangles[item], mesh.item_triangles[item + 1]
        if last - first >= WORTH_A_LOOK and _is_hidden(mesh, view, item, nearness):
            continue
        _into_item(mesh, view, item, turn, eye)
        _project(mesh, view, item, turn, eye, points)
        _draw(mesh, view, item, turn, eye, points, nearness, triangles)
    return Samples(nearness, triangles)


@compiled
def depth_and_numbers(mesh: Mesh, samples: Samples, range_m: float) -> tuple[Float32, Int32]:
    """Depth along the optical axis (m, +Inf: none or beyond `range_m`) and the item's number (or NOTHING)."""
    height, width = samples.nearness.shape
    depth = np.empty((height, width), dtype=np.float32)
    numbers = np.empty((height, width), dtype=np.int32)
    before, number = NOTHING, NOTHING
    for v in range(height):
        for u in range(width):
            triangle = samples.triangle[v, u]
            if triangle != before:
                before = triangle
                number = NOTHING
                if triangle != NOTHING:
                    number = mesh.item_number[mesh.part_item[mesh.triangle_part[triangle]]]
            numbers[v, u] = number
            depth_m = np.float32(1.0) / samples.nearness[v, u]
            depth[v, u] = depth_m if depth_m <= range_m else np.float32(np.inf)
    return depth, numbers


@compiled
def _into_item(mesh: Mesh, view: View, item: int, turn: Float64, eye: Float64) -> None:
    """Fill in the rotation from the item's frame to the optical one, and the eye in the item's frame."""
    x, y, z, cos, sin = mesh.item_pose[item]
    for row in range(3):
        right, left = view.turn[row, 0], view.turn[row, 1]
        turn[row, 0] = right * cos + left * sin
        turn[row, 1] = left * cos - right * sin
        turn[row, 2] = view.turn[row, 2]
    dx, dy = view.eye_m[0] - x, view.eye_m[1] - y
    eye[0] = cos * dx + sin * dy
    eye[1] = cos * dy - sin * dx
    eye[2] = view.eye_m[2] - z


@compiled
def _centre(mesh: Mesh, view: View, item: int) -> tuple[float, float, float]:
    """The middle of the item's sphere in the optical frame."""
    x, y, z, cos, sin = mesh.item_pose[item]
    a, b, c, _ = mesh.item_sphere_m[item]
    dx = x + cos * a - sin * b - view.eye_m[0]
    dy = y + sin * a + cos * b - view.eye_m[1]
    dz = z + c - view.eye_m[2]
    t = view.turn
    return (
        t[0, 0] * dx + t[0, 1] * dy + t[0, 2] * dz,
        t[1, 0] * dx + t[1, 1] * dy + t[1, 2] * dz,
        t[2, 0] * dx + t[2, 1] * dy + t[2, 2] * dz,
    )


@compiled
def _front_to_back(mesh: Mesh, view: View) -> NDArray[np.int64]:
    """The items that may be in the picture: walls and floors first, of each kind the nearest first."""
    # Half the picture's extent as seen from 1 m away, to each side, and the slant of its borders.
    left, right = view.cx / view.fx, (view.width - 1 - view.cx) / view.fx
    top, bottom = view.cy / view.fy, (view.height - 1 - view.cy) / view.fy
    count = len(mesh.item_number)
    found = np.empty(count, dtype=np.int64)
    keys = np.empty(count)
    kept = 0
    for item in range(count):
        x, y, z = _centre(mesh, view, item)
        radius = mesh.item_sphere_m[item, 3]
        if (
            z + radius < NEAR_M
            or -x - left * z > radius * math.hypot(1.0, left)
            or x - right * z > radius * math.hypot(1.0, right)
            or -y - top * z > radius * math.hypot(1.0, top)
            or y - bottom * z > radius * math.hypot(1.0, bottom)
        ):
            continue
        distance = math.sqrt(x * x + y * y + z * z)
        key = distance if mesh.item_first[item] == 0 else distance - FIRST_M
        # Insertion keeps them sorted: they are few, and numpy's sort takes a second to compile.
        place = kept
        while place > 0 and keys[place - 1] > key:
            keys[place], found[place] = keys[place - 1], found[place - 1]
            place -= 1
        keys[place], found[place] = key, item
        kept += 1
    return found[:kept]


@compiled
def _is_hidden(mesh: Mesh, view: View, item: int, nearness: Float32) -> bool:
    """Whether the whole ball around the item lies behind what is already in the picture."""
    x, y, z = _centre(mesh, view, item)
    radius = mesh.item_sphere_m[item, 3]
    front = z - radius
    if front <= NEAR_M:
        return False
    # The cube around the ball covers at least as much of the picture as the ball; its corners tell how much.
    back = z + radius
    u_low = max(0, int(math.floor(view.cx + view.fx * min((x - radius) / front, (x - radius) / back))))
    v_low = max(0, int(math.floor(view.cy + view.fy * min((y - radius) / front, (y - radius) / back))))
    u_high = int(math.ceil(view.cx + view.fx * max((x + radius) / front, (x + radius) / back)))
    v_high = int(math.ceil(view.cy + view.fy * max((y + radius) / front, (y + radius) / back)))
    u_high, v_high = min(view.width - 1, u_high), min(view.height - 1, v_high)
    nearest = np.float32(1.0 / front)
    for v in range(v_low, v_high + 1):
        for u in range(u_low, u_high + 1):
            if nearness[v, u] < nearest:
                return False
    return True


@compiled
def _project(mesh: Mesh, view: View, item: int, turn: Float64, eye: Float64, points: Float64) -> None:
    """Fill in each vertex of the item: x, y, z in the optical frame, then u, v where it is not too near."""
    first = mesh.item_vertices[item]
    for at in range(mesh.item_vertices[item + 1] - first):
        a = mesh.vertex_m[first + at, 0] - eye[0]
        b = mesh.vertex_m[first + at, 1] - eye[1]
        c = mesh.vertex_m[first + at, 2] - eye[2]
        x = turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c
        y = turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c
        z = turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c
        points[at, 0] = x
        points[at, 1] = y
        points[at, 2] = z
        if z >= NEAR_M:
            points[at, 3] = view.cx + view.fx * x / z
            points[at, 4] = view.cy + view.fy * y / z


@compiled
def _draw(
    mesh: Mesh,
    view: View,
    item: int,
    turn: Float64,
    eye: Float64,
    points: Float64,
    nearness: Float32,
    triangles: Int32,
) -> None:
    """Draw the triangles of an item that show their fronts; what is nearer than NEAR_M is cut off.

    One call for all of them: each call would count references to every array of the mesh.
    """
    for at in range(mesh.item_triangles[item], mesh.item_triangles[item + 1]):
        a, b, c = mesh.triangle_plane[at, 0], mesh.triangle_plane[at, 1], mesh.triangle_plane[at, 2]
        height_m = a * eye[0] + b * eye[1] + c * eye[2] - mesh.triangle_plane[at, 3]
        if height_m <= EDGE_ON_M:
            continue
        i, j, k = mesh.triangle[at, 0], mesh.triangle[at, 1], mesh.triangle[at, 2]
        near = int(points[i, 2] < NEAR_M) + int(points[j, 2] < NEAR_M) + int(points[k, 2] < NEAR_M)
        if near == 3:
            continue
        # On the plane of the triangle, 1 / depth is linear in u and v.
        scale = -1.0 / height_m
        du = (turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c) * scale / view.fx
        dv = (turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c) * scale / view.fy
        at_zero = (turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c) * scale - du * view.cx - dv * view.cy
        plane = (at_zero, du, dv)
        if near == 0:
            ends = (points[i, 3], points[i, 4], points[j, 3], points[j, 4], points[k, 3], points[k, 4])
            _fill(ends, plane, at, nearness, triangles)
            continue
        # Turn the corners so that the first is the odd one out: the only near one, or the only far one.
        odd_is_near = near == 1
        while (points[i, 2] < NEAR_M) != odd_is_near:
            i, j, k = j, k, i
        if odd_is_near:
            uj, vj = _cut(view, points, j, i)
            uk, vk = _cut(view, points, k, i)
            _fill(
                (uj, vj, points[j, 3], points[j, 4], points[k, 3], points[k, 4]),
                plane,
                at,
                nearness,
                triangles,
            )
            _fill((uj, vj, points[k, 3], points[k, 4], uk, vk), plane, at, nearness, triangles)
        else:
            uj, vj = _cut(view, points, i, j)
            uk, vk = _cut(view, points, i, k)
            _fill((points[i, 3], points[i, 4], uj, vj, uk, vk), plane, at, nearness, triangles)


@compiled
def _cut(view: View, points: Float64, far: int, near: int) -> tuple[float, float]:
    """Where (u, v) the edge from a far corner to a near one meets the near plane."""
    share = (points[far, 2] - NEAR_M) / (points[far, 2] - points[near, 2])
    x = points[far, 0] + share * (points[near, 0] - points[far, 0])
    y = points[far, 1] + share * (points[near, 1] - points[far, 1])
    return view.cx + view.fx * x / NEAR_M, view.cy + view.fy * y / NEAR_M


@compiled
def _fill(
    ends: tuple[float, float, float, float, float, float],
    plane: tuple[float, float, float],
    at: int,
    nearness: Float32,
    triangles: Int32,
) -> None:
    """Paint the pixels whose centres lie in the triangle; of an edge that two share, each pixel goes to one.

    Every edge is followed from its upper end, so that both its triangles find the same pixels beside it.
    """
    u0, v0, u1, v1, u2, v2 = ends
    if v1 < v0:
        u0, v0, u1, v1 = u1, v1, u0, v0
    if v2 < v0:
        u0, v0, u2, v2 = u2, v2, u0, v0
    if v2 < v1:
        u1, v1, u2, v2 = u2, v2, u1, v1
    height, width = nearness.shape
    if v2 <= 0.0 - 1.0 or v0 > height - 1.0 or max(u0, u1, u2) < 0.0 or min(u0, u1, u2) > width - 1.0:
        return
    first = int(max(0.0, math.ceil(v0)))
    last = int(min(float(height), math.ceil(v2)))
    if first >= last:
        return
    long_slope = (u2 - u0) / (v2 - v0)
    upper_slope = (u1 - u0) / (v1 - v0) if v1 > v0 else 0.0
    lower_slope = (u2 - u1) / (v2 - v1) if v2 > v1 else 0.0
    step = np.float32(plane[1])
    for v in range(first, last):
        long_u = u0 + (v - v0) * long_slope
        short_u = u0 + (v - v0) * upper_slope if v < v1 else u1 + (v - v1) * lower_slope
        left = int(math.ceil(min(max(0.0, min(long_u, short_u)), float(width))))
        right = int(math.ceil(min(max(0.0, max(long_u, short_u)), float(width))))
        start = np.float32(plane[0] + plane[1] * left + plane[2] * v)
        for u in range(left, right):
            here = start + step * np.float32(u - left)
            held = nearness[v, u]
            nearer = here > held * NEARER
            nearness[v, u] = here if nearer else held
            triangles[v, u] = at if nearer else triangles[v, u]

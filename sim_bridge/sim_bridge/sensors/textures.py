"""How surfaces look: the grain of what they are made of, the pattern on them, and the light of the room.

A texture is a function of the place on a part, in metres: nothing is stored but two tables of noise. What is
finer than a pixel at its distance fades out, so that pictures do not sparkle as the robot moves.
"""

import math

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32, Float64
from sim_bridge.homes.materials import Pattern, Substance
from sim_bridge.sensors.compiled import compiled_loosely
from sim_bridge.sensors.hulls import GLOBE, MANTLE
from sim_bridge.sensors.rasterizer import NOTHING, Samples, View
from sim_bridge.sensors.scenery import PATTERN_CODE, SUBSTANCE_CODE, Mesh

# What is seen where there is no surface: a light ceiling.
BACKGROUND_RGB = (226, 224, 219)

PAINT = SUBSTANCE_CODE[Substance.PAINT]
WOOD = SUBSTANCE_CODE[Substance.WOOD]
BOARDS = SUBSTANCE_CODE[Substance.BOARDS]
FABRIC = SUBSTANCE_CODE[Substance.FABRIC]
CARPET = SUBSTANCE_CODE[Substance.CARPET]
LEATHER = SUBSTANCE_CODE[Substance.LEATHER]
METAL = SUBSTANCE_CODE[Substance.METAL]
CERAMIC = SUBSTANCE_CODE[Substance.CERAMIC]
GLASS = SUBSTANCE_CODE[Substance.GLASS]
PLASTIC = SUBSTANCE_CODE[Substance.PLASTIC]
PAPER = SUBSTANCE_CODE[Substance.PAPER]
STONE = SUBSTANCE_CODE[Substance.STONE]
TILES = SUBSTANCE_CODE[Substance.TILES]
LIGHT = SUBSTANCE_CODE[Substance.LIGHT]
STRIPED = PATTERN_CODE[Pattern.STRIPED]
CHECKED = PATTERN_CODE[Pattern.CHECKED]
DOTTED = PATTERN_CODE[Pattern.DOTTED]

# Sizes of what is on the surfaces, in metres.
BOARD_WIDTH_M, BOARD_LENGTH_M, BOARD_JOINT_M = 0.12, 1.3, 0.003
TILE_M, GROUT_M = 0.20, 0.006
WEAVE_M, CARPET_M, SPECKLE_M, RULING_M, PORE_M = 0.006, 0.012, 0.012, 0.010, 0.012
RING_M, STREAK_M, FIBRE_M, CLOUD_M = 0.035, 0.008, 0.25, 0.6
# Dots cover this share of their period, stripes half of it.
DOT_RADIUS = 0.30

# Light: a share from everywhere, a share from the lamp, which fades with distance, and a share from aside.
AMBIENT, LAMP, FILL = 0.46, 0.50, 0.16
LAMP_REACH_M = 5.0
FILL_DIRECTION = (0.48, 0.64, 0.60)
FILL_LEVEL = math.hypot(FILL_DIRECTION[0], FILL_DIRECTION[1])
WARM_RGB = (1.03, 1.0, 0.94)
# What shines mirrors a room like any other: dark floor, light walls, bright ceiling, windows on two sides.
FLOOR, HORIZON, CEILING, WINDOW = 0.20, 0.50, 1.05, 0.80
WINDOW_SHARPNESS = 4  # a window's brightness is the cosine to the power of 2 ** WINDOW_SHARPNESS
# At a grazing angle a pixel covers a longer piece of the surface, but never longer than this many times.
LONGEST_FOOTPRINT = 8.0

# The tables are part of the compiled code: handed over, each look-up would count references to them.
_CELLS = 128
_LAST = _CELLS - 1


def _hashed(seed: int) -> Float64:
    """White noise [_CELLS, _CELLS] in -1..1 that is the same on every machine."""
    state = np.arange(_CELLS * _CELLS, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(seed)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        state = (state ^ (state >> np.uint64(shift))) * np.uint64(factor)
    state ^= state >> np.uint64(31)
    return (state >> np.uint64(11)).astype(np.float64).reshape(_CELLS, _CELLS) / 2.0**52 - 1.0


def _clouds() -> Float32:
    """Smooth noise [_CELLS, _CELLS] in -1..1, seamless; its waves are 4 to 32 cells long."""
    total = np.zeros((_CELLS, _CELLS))
    at = np.arange(_CELLS)
    for octave, cells in enumerate((4, 8, 16, 32)):
        coarse = _hashed(octave + 1)[:cells, :cells]
        place = at * cells / _CELLS
        low = place.astype(int)
        share = place - low
        ease = share * share * (3.0 - 2.0 * share)
        high = (low + 1) % cells
        rows = coarse[low] * (1.0 - ease)[:, None] + coarse[high] * ease[:, None]
        total += (rows[:, low] * (1.0 - ease) + rows[:, high] * ease) / 2.0**octave
    return np.asarray(total / np.abs(total).max(), dtype=np.float32)


WHITE: Float32 = _hashed(0).astype(np.float32)
CLOUDS: Float32 = _clouds()


@compiled_loosely
def _white(x: float, y: float) -> float:
    """The noise of the cell that holds (x, y)."""
    return float(WHITE[int(math.floor(y)) & _LAST, int(math.floor(x)) & _LAST])


@compiled_loosely
def _smooth(x: float, y: float) -> float:
    """Noise between four cells."""
    i, j = math.floor(x), math.floor(y)
    p, q = x - i, y - j
    a, b = int(i) & _LAST, int(j) & _LAST
    c, d = (a + 1) & _LAST, (b + 1) & _LAST
    low = CLOUDS[b, a] + (CLOUDS[b, c] - CLOUDS[b, a]) * p
    high = CLOUDS[d, a] + (CLOUDS[d, c] - CLOUDS[d, a]) * p
    return float(low + (high - low) * q)


@compiled_loosely
def _share(waves_m: float, footprint_m: float) -> float:
    """How much of a detail is left: all while a pixel covers a quarter of it, none from a half on."""
    return min(1.0, max(0.0, 2.0 - 4.0 * footprint_m / waves_m))


@compiled_loosely
def _line(offset_m: float, width_m: float, footprint_m: float) -> float:
    """How much of a pixel a line covers whose middle is `offset_m` away from the pixel's."""
    reach = (width_m + footprint_m) / 2.0 - abs(offset_m)
    return min(1.0, max(0.0, reach / footprint_m)) * min(1.0, width_m / footprint_m)


@compiled_loosely
def _half(at_m: float, period_m: float, footprint_m: float) -> float:
    """1 in the middle half of every period, 0 around it; soft where a pixel covers both."""
    place = at_m / period_m
    place -= math.floor(place)
    edge = (0.25 - abs(place - 0.5)) * period_m
    sharp = min(1.0, max(0.0, 0.5 + edge / footprint_m))
    left = _share(period_m, footprint_m)
    return 0.5 + (sharp - 0.5) * left


@compiled_loosely
def _wood(s: float, t: float, footprint_m: float) -> float:
    """Wood as a factor of brightness: rings that wander, with fine streaks along the grain."""
    wander = _smooth(s * 40.0, t * 160.0)
    ring = t / RING_M + 1.6 * wander + 0.4 * s
    ring -= math.floor(ring)
    # Each ring darkens slowly and ends at once, as late wood does.
    ring = ring * ring * min(1.0, 6.0 * (1.0 - ring))
    streak = _smooth(s * 4.0 / FIBRE_M, t * 4.0 / STREAK_M)
    return (
        1.0
        + 0.05 * wander
        - 0.28 * (ring - 0.25) * _share(RING_M, footprint_m)
        + 0.17 * streak * _share(4.0 * STREAK_M, footprint_m)
    )


@compiled_loosely
def _grain(substance: int, s: float, t: float, footprint_m: float) -> float:
    """What a substance does to the brightness at (s, t) (m; s along the longer side): a factor near 1."""
    if substance == PAINT:
        return 1.0 + 0.018 * _smooth(s * 32.0 / CLOUD_M, t * 32.0 / CLOUD_M)
    if substance == WOOD:
        return _wood(s, t, footprint_m)
    if substance == BOARDS:
        row = math.floor(t / BOARD_WIDTH_M)
        along = s + BOARD_LENGTH_M * _white(row, 11.5)
        board = math.floor(along / BOARD_LENGTH_M)
        tone = _white(row, board) * _share(2.0 * BOARD_WIDTH_M, footprint_m)
        joint = max(
            _line(t - BOARD_WIDTH_M * math.floor(t / BOARD_WIDTH_M + 0.5), BOARD_JOINT_M, footprint_m),
            _line(
                along - BOARD_LENGTH_M * math.floor(along / BOARD_LENGTH_M + 0.5), BOARD_JOINT_M, footprint_m
            ),
        )
        wood = _wood(s + 1.7 * board, t + 2.3 * board, footprint_m)
        return wood * (1.0 + 0.07 * tone) * (1.0 - 0.45 * joint)
    if substance == FABRIC:
        over = _half(s, WEAVE_M, footprint_m) - _half(t, WEAVE_M, footprint_m)
        thread = _white(s / WEAVE_M * 2.0, t / WEAVE_M * 2.0) * _share(WEAVE_M, footprint_m)
        slub = _smooth(s * 300.0, t * 300.0) * _share(0.02, footprint_m)
        return 1.0 + 0.07 * over + 0.05 * thread + 0.05 * slub + 0.02 * _smooth(s * 60.0, t * 60.0)
    if substance == CARPET:
        tuft = _white(s / CARPET_M * 2.0, t / CARPET_M * 2.0) * _share(CARPET_M, footprint_m)
        return 1.0 + 0.13 * tuft + 0.03 * _smooth(s * 160.0, t * 160.0)
    if substance == LEATHER:
        pore = _smooth(s * 8.0 / PORE_M, t * 8.0 / PORE_M)
        return 1.0 - 0.20 * max(0.0, pore) * _share(PORE_M, footprint_m) + 0.10 * _smooth(s * 50.0, t * 50.0)
    if substance == METAL:
        brushed = _smooth(s * 12.0, t * 700.0) * _share(0.02, footprint_m)
        return 1.0 + 0.07 * brushed + 0.03 * _smooth(s * 8.0, t * 60.0)
    if substance == PAPER:
        place = t - RULING_M * math.floor(t / RULING_M + 0.5)
        return 1.0 - 0.16 * _line(place, 0.0012, footprint_m)
    if substance == STONE:
        speckle = _white(s / SPECKLE_M * 3.0, t / SPECKLE_M * 3.0) * _share(SPECKLE_M, footprint_m)
        blot = _smooth(s * 400.0, t * 400.0) * _share(0.03, footprint_m)
        return 1.0 + 0.12 * speckle + 0.14 * blot + 0.05 * _smooth(s * 60.0, t * 60.0)
    if substance == TILES:
        tone = _white(s / TILE_M, t / TILE_M) * _share(2.0 * TILE_M, footprint_m)
        grout = max(
            _line(s - TILE_M * math.floor(s / TILE_M + 0.5), GROUT_M, footprint_m),
            _line(t - TILE_M * math.floor(t / TILE_M + 0.5), GROUT_M, footprint_m),
        )
        return (1.0 + 0.025 * tone + 0.03 * _smooth(s * 120.0, t * 120.0)) * (1.0 - 0.28 * grout)
    return 1.0


@compiled_loosely
def pattern_share(pattern: int, s: float, t: float, period_m: float, footprint_m: float) -> float:
    """How much of the pattern's colour is at (s, t): 0..1; stripes run across s."""
    if pattern == STRIPED:
        return _half(s, period_m, footprint_m)
    if pattern == CHECKED:
        one, two = _half(s, period_m, footprint_m), _half(t, period_m, footprint_m)
        return one + two - 2.0 * one * two
    if pattern == DOTTED:
        row = math.floor(t / period_m)
        x = s / period_m + 0.5 * (row - 2.0 * math.floor(row / 2.0))
        x -= math.floor(x) + 0.5
        y = t / period_m - row - 0.5
        edge = (DOT_RADIUS - math.sqrt(x * x + y * y)) * period_m
        mean = math.pi * DOT_RADIUS * DOT_RADIUS
        dot = min(1.0, max(0.0, 0.5 + edge / footprint_m))
        return mean + (dot - mean) * _share(period_m, footprint_m)
    return 0.0


@compiled_loosely
def albedo(
    look: tuple[int, int],
    colours: tuple[float, float, float, float, float, float],
    place: tuple[float, float, float, float],
    period_m: float,
    footprint_m: float,
) -> tuple[float, float, float]:
    """Red, green and blue in 0..1 of a surface.

    `look` is the codes of substance and pattern, `colours` are the material's and its pattern's. `place` (m)
    is (s, t) where the pattern is looked up, from the middle of the part, and (s, t) where the substance is.
    """
    share = pattern_share(look[1], place[0], place[1], period_m, footprint_m)
    tone = _grain(look[0], place[2], place[3], footprint_m) - 1.0
    # What is darker is a little redder, as in wood and cloth.
    red = (colours[0] + (colours[3] - colours[0]) * share) * (1.0 + 0.85 * tone)
    green = (colours[1] + (colours[4] - colours[1]) * share) * (1.0 + tone)
    blue = (colours[2] + (colours[5] - colours[2]) * share) * (1.0 + 1.1 * tone)
    return min(1.0, max(0.0, red)), min(1.0, max(0.0, green)), min(1.0, max(0.0, blue))


@compiled_loosely
def _surroundings(up: float, to_window: float) -> float:
    """How bright a room is in a direction, given its cosines to straight up and to where a window is."""
    sky = HORIZON + up * (CEILING - HORIZON if up > 0.0 else HORIZON - FLOOR)
    window = to_window
    for _ in range(WINDOW_SHARPNESS):
        window *= window
    return sky + WINDOW * window


@compiled_loosely
def _angle(x: float, y: float) -> float:
    """The angle of (x, y) to within 0.005 rad, which is finer than anything drawn with it."""
    a, b = abs(x), abs(y)
    ratio = min(a, b) / max(a, b, 1e-12)
    angle = ratio * (0.785398 + 0.273 * (1.0 - ratio))
    if b > a:
        angle = 1.570796 - angle
    if x < 0.0:
        angle = 3.141593 - angle
    return -angle if y < 0.0 else angle


@compiled_loosely
def paint(mesh: Mesh, view: View, samples: Samples, shares: Float32) -> NDArray[np.uint8]:
    """The picture, uint8 [height, width, 3], of what `rasterise` found; `shares` is its lightness."""
    height, width = samples.triangle.shape
    picture = np.empty((height, width, 3), dtype=np.uint8)
    before, item_before, part_before = NOTHING, NOTHING, NOTHING
    turn = view.turn
    cos, sin = 1.0, 0.0
    eye = (0.0, 0.0, 0.0)
    lamp = (0.0, 0.0, 0.0)
    fill = (0.0, 0.0, 0.0)
    face, substance, pattern, longest, axis = 0, 0, 0, 0, 0
    shift, period_m = 0.0, 1.0
    gloss, sharpness, mirror, tint = 0.0, 0, 0.0, 0.0
    centre = (0.0, 0.0, 0.0)
    colours = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    nx, ny, nz = 0.0, 0.0, 0.0
    for v in range(height):
        y_ray = (v - view.cy) / view.fy
        for u in range(width):
            triangle = samples.triangle[v, u]
            if triangle == NOTHING:
                picture[v, u, 0] = BACKGROUND_RGB[0]
                picture[v, u, 1] = BACKGROUND_RGB[1]
                picture[v, u, 2] = BACKGROUND_RGB[2]
                continue
            if triangle != before:
                # Neighbours mostly show the same triangle: what belongs to it is looked up once.
                before = triangle
                part = mesh.triangle_part[triangle]
                face = mesh.triangle_face[triangle]
                nx, ny, nz = (
                    mesh.triangle_plane[triangle, 0],
                    mesh.triangle_plane[triangle, 1],
                    mesh.triangle_plane[triangle, 2],
                )
                if part != part_before:
                    part_before = part
                    substance, pattern, longest, axis, variant = mesh.part_look[part]
                    shift = variant * 0.173
                    finish = mesh.part_finish[part]
                    gloss, sharpness, mirror, tint = finish[0], int(finish[1]), finish[2], finish[3]
                    c = mesh.part_colour[part]
                    colours = (c[0], c[1], c[2], c[3], c[4], c[5])
                    frame = mesh.part_frame[part]
                    centre = (frame[0], frame[1], frame[2])
                    period_m = frame[3]
                item = mesh.part_item[part]
                if item != item_before:
                    item_before = item
                    x, y, z, cos, sin = mesh.item_pose[item]
                    dx, dy = view.eye_m[0] - x, view.eye_m[1] - y
                    eye = (cos * dx + sin * dy, cos * dy - sin * dx, view.eye_m[2] - z)
                    dx, dy = mesh.item_light_m[item, 0] - x, mesh.item_light_m[item, 1] - y
                    lamp = (cos * dx + sin * dy, cos * dy - sin * dx, mesh.item_light_m[item, 2] - z)
                    fill = (
                        cos * FILL_DIRECTION[0] + sin * FILL_DIRECTION[1],
                        cos * FILL_DIRECTION[1] - sin * FILL_DIRECTION[0],
                        FILL_DIRECTION[2],
                    )
            # The point in the item's frame, and the way from it to the eye.
            x_ray = (u - view.cx) / view.fx
            depth_m = 1.0 / samples.nearness[v, u]
            dx = (turn[0, 0] * x_ray + turn[1, 0] * y_ray + turn[2, 0]) * depth_m
            dy = (turn[0, 1] * x_ray + turn[1, 1] * y_ray + turn[2, 1]) * depth_m
            ez = -(turn[0, 2] * x_ray + turn[1, 2] * y_ray + turn[2, 2]) * depth_m
            ex, ey = -(cos * dx + sin * dy), -(cos * dy - sin * dx)
            px, py, pz = eye[0] - ex, eye[1] - ey, eye[2] - ez
            qx, qy, qz = px - centre[0], py - centre[1], pz - centre[2]
            # Where on the surface that is, (s, t), with s along the longer side; around a round one, the arc.
            if face < MANTLE:
                side = face // 2
                if side == 0:
                    s, t, other = qy, qz, longest == 2
                elif side == 1:
                    s, t, other = qx, qz, longest == 2
                else:
                    s, t, other = qx, qy, longest == 1
                if other:
                    s, t = t, s
            else:
                if face == GLOBE:
                    nx, ny, nz = qx, qy, qz
                elif axis == 0:
                    nx, ny, nz = 0.0, qy, qz
                elif axis == 1:
                    nx, ny, nz = qx, 0.0, qz
                else:
                    nx, ny, nz = qx, qy, 0.0
                radius = math.sqrt(nx * nx + ny * ny + nz * nz)
                nx, ny, nz = nx / radius, ny / radius, nz / radius
                if face == GLOBE or axis == 2:
                    s, t = qz, radius * _angle(nx, ny)
                elif axis == 0:
                    s, t = qx, radius * _angle(ny, nz)
                else:
                    s, t = qy, radius * _angle(nx, nz)
            away = 1.0 / math.sqrt(ex * ex + ey * ey + ez * ez)
            facing = max(0.0, (nx * ex + ny * ey + nz * ez) * away)
            stretch = min(LONGEST_FOOTPRINT, 1.0 / max(0.01, facing))
            red, green, blue = albedo(
                (substance, pattern),
                colours,
                (s, t, s + shift, t + shift),
                period_m,
                depth_m / view.fx * stretch,
            )
            light, shine, mirrored = 1.0, 0.0, 0.0
            if substance != LIGHT:
                lx, ly, lz = lamp[0] - px, lamp[1] - py, lamp[2] - pz
                square = lx * lx + ly * ly + lz * lz
                near = 1.0 / math.sqrt(square)
                lit = max(0.0, (nx * lx + ny * ly + nz * lz) * near)
                # Half-way between Lambert's law and none: walls close to the lamp's foot stay readable.
                lit = lit * (0.6 + 0.4 * lit) * 1.15 / (1.0 + square / (LAMP_REACH_M * LAMP_REACH_M))
                aside = 0.5 + 0.5 * (nx * fill[0] + ny * fill[1] + nz * fill[2])
                light = (AMBIENT + LAMP * lit + FILL * aside) * shares[v, u]
                if gloss > 0.0:
                    hx, hy, hz = lx * near + ex * away, ly * near + ey * away, lz * near + ez * away
                    gleam = (nx * hx + ny * hy + nz * hz) / math.sqrt(hx * hx + hy * hy + hz * hz)
                    gleam = max(0.0, gleam)
                    for _ in range(sharpness):
                        gleam *= gleam
                    shine = gloss * gleam
                if mirror > 0.0:
                    rest = (1.0 - facing) * (1.0 - facing)
                    share = mirror + (1.0 - mirror) * rest * rest * (1.0 - facing)
                    rx, ry, rz = (
                        2.0 * facing * nx - ex * away,
                        2.0 * facing * ny - ey * away,
                        2.0 * facing * nz - ez * away,
                    )
                    to_window = (rx * fill[0] + ry * fill[1]) / FILL_LEVEL
                    mirrored = share * shares[v, u] * _surroundings(rz, to_window)
                    light *= 1.0 - share
            # A metal mirrors in its own colour, all else as it is.
            light += tint * mirrored
            shine += (1.0 - tint) * mirrored
            picture[v, u, 0] = np.uint8(min(255.0, 255.0 * (red * light * WARM_RGB[0] + shine)))
            picture[v, u, 1] = np.uint8(min(255.0, 255.0 * (green * light * WARM_RGB[1] + shine)))
            picture[v, u, 2] = np.uint8(min(255.0, 255.0 * (blue * light * WARM_RGB[2] + shine)))
    return picture

"""How much light from all around reaches a surface: less in corners, and beside what stands there.

Judged from the depths in the picture alone, at every STEP_PX-th pixel: how far do the neighbours rise above
the surface? That is what puts things on the floor rather than before it.
"""

import math

import numpy as np

from robustnav_msgs_py.values import Float32
from sim_bridge.sensors.compiled import compiled_loosely
from sim_bridge.sensors.rasterizer import NOTHING, Samples, View
from sim_bridge.sensors.scenery import Mesh

STEP_PX = 4
# Neighbours at these distances count, in this many directions.
RADII_M = (0.06, 0.20)
DIRECTIONS = 8
# What rises less than this (sine of the angle) is the surface itself.
FLAT = 0.12
# Where neighbours rise all around, this share of the light is gone.
STRENGTH = 1.1
DARKEST = 0.45
# In pixels: nearer neighbours are the surface itself, farther ones cost more than they tell.
LEAST_PX, MOST_PX = 1.5, 90.0


@compiled_loosely
def openness(mesh: Mesh, view: View, samples: Samples) -> Float32:
    """The share of light that reaches the surface at the pixels (STEP_PX j, STEP_PX i), DARKEST..1, [i, j].

    The last row and column stand for the last pixels of the picture.
    """
    rows = (view.height + STEP_PX - 2) // STEP_PX + 1
    columns = (view.width + STEP_PX - 2) // STEP_PX + 1
    shares = np.ones((rows, columns), dtype=np.float32)
    cosines, sines = np.empty(DIRECTIONS), np.empty(DIRECTIONS)
    for at in range(DIRECTIONS):
        cosines[at] = math.cos((at + 0.5) * math.tau / DIRECTIONS)
        sines[at] = math.sin((at + 0.5) * math.tau / DIRECTIONS)
    for i in range(rows):
        v = min(i * STEP_PX, view.height - 1)
        for j in range(columns):
            u = min(j * STEP_PX, view.width - 1)
            triangle = samples.triangle[v, u]
            if triangle == NOTHING:
                continue
            nx, ny, nz = _normal(mesh, view, triangle)
            z = 1.0 / samples.nearness[v, u]
            x, y = (u - view.cx) / view.fx * z, (v - view.cy) / view.fy * z
            risen = 0.0
            for radius_m in RADII_M:
                reach = min(MOST_PX, radius_m * view.fx / z)
                if reach < LEAST_PX:
                    continue
                for at in range(DIRECTIONS):
                    p = int(u + reach * cosines[at] + 0.5)
                    q = int(v + reach * sines[at] + 0.5)
                    if p < 0 or q < 0 or p >= view.width or q >= view.height:
                        continue
                    nearness = samples.nearness[q, p]
                    if nearness <= 0.0:
                        continue
                    far = 1.0 / nearness
                    dx = (p - view.cx) / view.fx * far - x
                    dy = (q - view.cy) / view.fy * far - y
                    dz = far - z
                    square = dx * dx + dy * dy + dz * dz + 1e-9
                    rise = (nx * dx + ny * dy + nz * dz) / math.sqrt(square) - FLAT
                    # What is much farther away than asked for shades less.
                    risen += max(0.0, rise) / (1.0 + square / (4.0 * radius_m * radius_m))
            shares[i, j] = max(DARKEST, 1.0 - STRENGTH * risen / (DIRECTIONS * len(RADII_M)))
    return shares


@compiled_loosely
def _normal(mesh: Mesh, view: View, triangle: int) -> tuple[float, float, float]:
    """The outward normal of a triangle in the optical frame."""
    item = mesh.part_item[mesh.triangle_part[triangle]]
    cos, sin = mesh.item_pose[item, 3], mesh.item_pose[item, 4]
    a, b, c = (
        mesh.triangle_plane[triangle, 0],
        mesh.triangle_plane[triangle, 1],
        mesh.triangle_plane[triangle, 2],
    )
    x, y = cos * a - sin * b, sin * a + cos * b
    t = view.turn
    return (
        t[0, 0] * x + t[0, 1] * y + t[0, 2] * c,
        t[1, 0] * x + t[1, 1] * y + t[1, 2] * c,
        t[2, 0] * x + t[2, 1] * y + t[2, 2] * c,
    )

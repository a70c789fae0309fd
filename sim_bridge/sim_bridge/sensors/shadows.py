"""The soft shadows that things throw on what they stand on: a table on the floor, a mug on the table.

Lamps hang above, so the shadow of a thing is its footprint, blurred. It belongs to the scenery, not to the
picture: it is the same from wherever it is seen.
"""

import math

import numpy as np

from robustnav_msgs_py.values import Float32
from sim_bridge.sensors.compiled import compiled_loosely
from sim_bridge.sensors.hulls import TOP
from sim_bridge.sensors.rasterizer import NEAR_M, NOTHING, Samples, View
from sim_bridge.sensors.scenery import Mesh

# This share of the light is gone in the middle of a shadow.
DARKNESS = 0.36
# What lies this far above or below a thing's lowest point is what it stands on.
CONTACT_M = 0.006


@compiled_loosely
def lightness(mesh: Mesh, view: View, samples: Samples) -> Float32:
    """How much of the light reaches each pixel's surface: [height, width], 1 where there is no shadow."""
    shares = np.ones(samples.nearness.shape, dtype=np.float32)
    for item in range(len(mesh.item_number)):
        if mesh.item_foot_m[item, 5] > 0.0:
            _darken(mesh, view, samples, item, shares)
    return shares


@compiled_loosely
def _darken(mesh: Mesh, view: View, samples: Samples, item: int, shares: Float32) -> None:
    """Lay the shadow of one item on what it stands on."""
    x, y, z, cos, sin = mesh.item_pose[item]
    x_mid, y_mid, x_half, y_half, bottom, reach = mesh.item_foot_m[item]
    turn, eye = view.turn, view.eye_m
    base = z + bottom
    if eye[2] <= base:
        return
    u_low, v_low, u_high, v_high = 1e9, 1e9, -1e9, -1e9
    # Around the corners of the shadow, from the last to the first and on; what is too near is cut off.
    x_from, y_from, z_from = 0.0, 0.0, 0.0
    for corner in range(5):
        a = x_mid + (x_half + reach) * (1.0 if corner % 4 in (0, 3) else -1.0)
        b = y_mid + (y_half + reach) * (1.0 if corner % 4 in (0, 1) else -1.0)
        dx = x + cos * a - sin * b - eye[0]
        dy = y + sin * a + cos * b - eye[1]
        dz = base - eye[2]
        x_to = turn[0, 0] * dx + turn[0, 1] * dy + turn[0, 2] * dz
        y_to = turn[1, 0] * dx + turn[1, 1] * dy + turn[1, 2] * dz
        z_to = turn[2, 0] * dx + turn[2, 1] * dy + turn[2, 2] * dz
        for end in range(2):
            x_at, y_at, z_at = x_to, y_to, z_to
            if end == 0:
                if corner == 0 or (z_from < NEAR_M) == (z_to < NEAR_M):
                    continue
                share = (NEAR_M - z_from) / (z_to - z_from)
                x_at, y_at = x_from + share * (x_to - x_from), y_from + share * (y_to - y_from)
                z_at = NEAR_M
            elif z_to < NEAR_M:
                continue
            u, v = view.cx + view.fx * x_at / z_at, view.cy + view.fy * y_at / z_at
            u_low, u_high = min(u_low, u), max(u_high, u)
            v_low, v_high = min(v_low, v), max(v_high, v)
        x_from, y_from, z_from = x_to, y_to, z_to
    left, right = int(max(0.0, u_low)), int(max(-1.0, min(view.width - 1.0, u_high))) + 1
    first, last = int(max(0.0, v_low)), int(max(-1.0, min(view.height - 1.0, v_high))) + 1
    for v in range(first, last):
        y_ray = (v - view.cy) / view.fy
        for u in range(left, right):
            triangle = samples.triangle[v, u]
            if triangle == NOTHING or mesh.triangle_face[triangle] != TOP:
                continue
            x_ray = (u - view.cx) / view.fx
            depth = 1.0 / samples.nearness[v, u]
            dz = (turn[0, 2] * x_ray + turn[1, 2] * y_ray + turn[2, 2]) * depth
            if abs(eye[2] + dz - base) > CONTACT_M or mesh.part_item[mesh.triangle_part[triangle]] == item:
                continue
            dx = (turn[0, 0] * x_ray + turn[1, 0] * y_ray + turn[2, 0]) * depth + eye[0] - x
            dy = (turn[0, 1] * x_ray + turn[1, 1] * y_ray + turn[2, 1]) * depth + eye[1] - y
            out_x = max(0.0, abs(cos * dx + sin * dy - x_mid) - x_half)
            out_y = max(0.0, abs(cos * dy - sin * dx - y_mid) - y_half)
            near = max(0.0, 1.0 - math.sqrt(out_x * out_x + out_y * out_y) / reach)
            shares[v, u] *= np.float32(1.0 - DARKNESS * near * near * (3.0 - 2.0 * near))

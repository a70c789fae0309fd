"""The robot's laser: rays all around in one plane, which cuts all of the home into rectangles and discs.

Everything is built of upright boxes, cylinders and balls, so that no other shape comes of it. A thing is cut
anew in each scan, where it is then: there is nothing to keep in step with what moves.
"""

import math

import numpy as np

from robustnav_msgs_py.values import Float64, LaserScan, Pose2D
from sim_bridge.homes.shapes import Axis, Shape
from sim_bridge.sensors.compiled import compiled
from sim_bridge.sensors.scenery import SHAPE_CODE, Mesh, Scenery

LASER_FRAME = "laser"
LASER_HEIGHT_M = 0.20
RANGE_MIN_M = 0.05

BOX, CYLINDER, BALL = SHAPE_CODE[Shape.BOX], SHAPE_CODE[Shape.CYLINDER], SHAPE_CODE[Shape.BALL]
ALONG_X, ALONG_Y, UPRIGHT = (int(axis) for axis in Axis)
# The column of `part_look` that tells along which axis a cylinder stands.
AXIS = 3


class Laser:
    """Scans a scenery from the middle of the robot, 0.2 m above the floor.

    `scenery` can be replaced by another one. Same thread as whoever moves things in it.
    """

    def __init__(self, scenery: Scenery, rays: int, range_m: float) -> None:
        self.scenery = scenery
        self._rays = rays
        self._range_m = range_m

    def take(self, pose: Pose2D, stamp_ns: int) -> LaserScan:
        """Ranges around the robot at `pose`, from behind it counter-clockwise; some 0.1 ms for 360 rays.

        +Inf where nothing is met within the laser's range.
        """
        place = (pose.x_m, pose.y_m, LASER_HEIGHT_M)
        ranges = cast(self.scenery.mesh, place, pose.yaw_rad - math.pi, self._rays, self._range_m)
        return LaserScan(
            ranges_m=ranges.astype(np.float32),
            angle_min_rad=-math.pi,
            angle_step_rad=math.tau / self._rays,
            range_min_m=RANGE_MIN_M,
            range_max_m=self._range_m,
            stamp_ns=stamp_ns,
            frame_id=LASER_FRAME,
        )


@compiled
def cast(
    mesh: Mesh, place_m: tuple[float, float, float], first_rad: float, rays: int, range_m: float
) -> Float64:
    """How far level rays from `place_m` (`map`) go until they meet something: m [rays], inf beyond range.

    The first one heads for `first_rad` (`map`), the others follow counter-clockwise, all around. What holds
    the place itself is not met.
    """
    step_rad = math.tau / rays
    headings = first_rad + step_rad * np.arange(rays)
    east, north = np.cos(headings), np.sin(headings)
    ranges = np.full(rays, np.inf)
    for part in range(len(mesh.part_item)):
        x, y, z, cos, sin = mesh.item_pose[mesh.part_item[part]]
        centre, half = mesh.part_frame[part], mesh.part_half_m[part]
        half_x, half_y = half[0], half[1]
        above = (place_m[2] - z - centre[2]) / half[2]
        if abs(above) >= 1.0:
            continue
        shape, axis = mesh.part_shape[part], mesh.part_look[part, AXIS]
        lying = shape == CYLINDER and axis != UPRIGHT
        angular = lying or shape == BOX
        if lying or shape == BALL:
            # The cut is narrower than the part, but for along a lying cylinder's axis.
            share = math.sqrt(1.0 - above * above)
            half_x *= 1.0 if lying and axis == ALONG_X else share
            half_y *= 1.0 if lying and axis == ALONG_Y else share
        # From the laser to the middle of the part: in `map`, and then as the part has its axes.
        dx = x + cos * centre[0] - sin * centre[1] - place_m[0]
        dy = y + sin * centre[0] + cos * centre[1] - place_m[1]
        ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
        radius = math.hypot(half_x, half_y) if angular else half_x
        away = math.hypot(dx, dy)
        if away - radius > range_m:
            continue
        first, count = 0, rays
        if away > radius:
            # Only these rays can meet it, and one to either side for the sake of rounding.
            spread = math.asin(radius / away)
            first = math.floor((math.atan2(dy, dx) - spread - first_rad) / step_rad)
            count = min(rays, math.ceil(2.0 * spread / step_rad) + 2)
            first %= rays
        for at in range(first, first + count):
            ray = at if at < rays else at - rays
            ux = cos * east[ray] + sin * north[ray]
            uy = cos * north[ray] - sin * east[ray]
            if angular:
                met = _to_rectangle(ahead, aside, ux, uy, half_x, half_y)
            else:
                met = _to_disc(ahead, aside, ux, uy, radius)
            if 0.0 < met < ranges[ray]:
                ranges[ray] = met
    return np.where(ranges <= range_m, ranges, np.inf)


@compiled
def _to_rectangle(x: float, y: float, ux: float, uy: float, half_x: float, half_y: float) -> float:
    """Along (ux, uy) from 0 to a rectangle around (x, y): negative from inside or past it, inf if missed."""
    x_in, x_out = (x - half_x) / ux, (x + half_x) / ux
    y_in, y_out = (y - half_y) / uy, (y + half_y) / uy
    enter = max(min(x_in, x_out), min(y_in, y_out))
    leave = min(max(x_in, x_out), max(y_in, y_out))
    return enter if enter <= leave else math.inf


@compiled
def _to_disc(x: float, y: float, ux: float, uy: float, radius: float) -> float:
    """Along the unit vector (ux, uy) from 0 to a disc around (x, y): negative and inf as for a rectangle."""
    along = x * ux + y * uy
    square = radius * radius - (x * x + y * y - along * along)
    return along - math.sqrt(square) if square >= 0.0 else math.inf

"""The home as PyBullet bodies: what the camera renders and the rays meet."""

import weakref
from collections.abc import Sequence
from types import TracebackType

import numpy as np
import pybullet

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Float64
from sim_bridge.homes.home import WALL_THICKNESS_M, Home, Wall
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.shapes import Colour, Part, Shape, box

FLOOR_THICKNESS_M = 0.05
# PyBullet takes this many primitives in one body and this many rays in one call.
MAX_PARTS = 16
MAX_RAYS = 4096
NOTHING = -1

_GEOMETRY = {
    Shape.BOX: pybullet.GEOM_BOX,
    Shape.CYLINDER: pybullet.GEOM_CYLINDER,
    Shape.BALL: pybullet.GEOM_SPHERE,
}

# Outward normals of a box's faces, by the side of the wall that they lie on (top and bottom: none).
_NORMALS: tuple[tuple[Side | None, tuple[float, float, float]], ...] = (
    (Side.WEST, (-1.0, 0.0, 0.0)),
    (Side.EAST, (1.0, 0.0, 0.0)),
    (Side.SOUTH, (0.0, -1.0, 0.0)),
    (Side.NORTH, (0.0, 1.0, 0.0)),
    (None, (0.0, 0.0, -1.0)),
    (None, (0.0, 0.0, 1.0)),
)


class World:
    """A PyBullet world of its own for one home. Use it from one thread; close it when done.

    `instance_of` tells for a body's number which object of the home it is; other bodies are not in it.
    """

    def __init__(self, home: Home) -> None:
        """Build the bodies (some 100 ms). Raises BadSceneError where PyBullet has no world left."""
        self.client: int = pybullet.connect(pybullet.DIRECT)
        if self.client < 0:
            raise BadSceneError("PyBullet opens no more worlds in this process: close one first")
        self._finalizer = weakref.finalize(self, pybullet.disconnect, self.client)
        self.instance_of: dict[int, int] = {}
        for room in home.rooms:
            self._add_floor(room.inside, room.floor_colour)
        for wall in home.walls:
            self._add_wall(wall)
        for piece in home.furniture:
            self._add(piece.parts, (piece.x_m, piece.y_m, 0.0), piece.yaw_rad)
        for thing in home.objects:
            for body in self._add(thing.parts, (thing.x_m, thing.y_m, thing.z_m), thing.yaw_rad):
                self.instance_of[body] = thing.instance

    def close(self) -> None:
        """Give the world back; a second call does nothing."""
        self._finalizer()

    def __enter__(self) -> "World":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def cast(self, starts_m: Float64, ends_m: Float64) -> tuple[Float64, np.ndarray]:
        """Send rays from `starts_m` [n, 3] to `ends_m` [n, 3] (`map`).

        Gives the share of the way to the first hit (float64 [n], 1 where nothing is met) and the body
        that was met (int64 [n], NOTHING where none).
        """
        shares, bodies = [], []
        for at in range(0, len(starts_m), MAX_RAYS):
            hits = pybullet.rayTestBatch(
                starts_m[at : at + MAX_RAYS].tolist(),
                ends_m[at : at + MAX_RAYS].tolist(),
                numThreads=1,
                physicsClientId=self.client,
            )
            bodies += [hit[0] for hit in hits]
            shares += [hit[2] for hit in hits]
        return np.array(shares, dtype=np.float64), np.array(bodies, dtype=np.int64)

    def _add_floor(self, inside: Rect, colour: Colour) -> None:
        """A slab below z = 0 that reaches half-way under the walls, so that doorways have a floor."""
        area = inside.grown(WALL_THICKNESS_M / 2.0)
        x_m, y_m = area.centre_m
        size = (area.width_m, area.depth_m, FLOOR_THICKNESS_M)
        self._add((box((0.0, 0.0, -FLOOR_THICKNESS_M / 2.0), size, colour),), (x_m, y_m, 0.0), 0.0)

    def _add_wall(self, wall: Wall) -> None:
        """A box to touch, but only the faces that are ever seen to look at.

        The renderer's time goes with the pixels it paints, also those it paints over later: hidden faces
        would double it.
        """
        x_m, y_m = wall.base.centre_m
        half = (wall.base.width_m / 2.0, wall.base.depth_m / 2.0, (wall.z_max_m - wall.z_min_m) / 2.0)
        vertices, normals, indices = _faces(half, wall.hidden)
        pybullet.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=pybullet.createCollisionShape(
                pybullet.GEOM_BOX, halfExtents=half, physicsClientId=self.client
            ),
            baseVisualShapeIndex=pybullet.createVisualShape(
                pybullet.GEOM_MESH,
                vertices=vertices,
                normals=normals,
                indices=indices,
                rgbaColor=(*wall.colour, 1.0),
                physicsClientId=self.client,
            ),
            basePosition=(x_m, y_m, (wall.z_min_m + wall.z_max_m) / 2.0),
            physicsClientId=self.client,
        )

    def _add(self, parts: Sequence[Part], origin_m: tuple[float, float, float], yaw_rad: float) -> list[int]:
        turn = pybullet.getQuaternionFromEuler((0.0, 0.0, yaw_rad))
        firsts = range(0, len(parts), MAX_PARTS)
        return [self._add_body(parts[at : at + MAX_PARTS], origin_m, turn) for at in firsts]

    def _add_body(
        self,
        parts: Sequence[Part],
        origin_m: tuple[float, float, float],
        turn: tuple[float, float, float, float],
    ) -> int:
        halves = [[length / 2.0 for length in part.size_m] for part in parts]
        shape = {
            "shapeTypes": [_GEOMETRY[part.shape] for part in parts],
            "halfExtents": halves,
            "radii": [half[0] for half in halves],
            "lengths": [part.size_m[2] for part in parts],
            "physicsClientId": self.client,
        }
        centres = [list(part.centre_m) for part in parts]
        body: int = pybullet.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=pybullet.createCollisionShapeArray(
                collisionFramePositions=centres, **shape
            ),
            baseVisualShapeIndex=pybullet.createVisualShapeArray(
                visualFramePositions=centres,
                rgbaColors=[[*part.colour, 1.0] for part in parts],
                **shape,
            ),
            basePosition=origin_m,
            baseOrientation=turn,
            physicsClientId=self.client,
        )
        return body


def _faces(
    half_m: tuple[float, float, float], hidden: Side
) -> tuple[list[list[float]], list[list[float]], list[int]]:
    """Vertices, normals and triangles of a box without its hidden side; each face is seen from outside."""
    vertices: list[list[float]] = []
    normals: list[list[float]] = []
    indices: list[int] = []
    for side, normal in _NORMALS:
        if side is hidden:
            continue
        out = np.array(normal)
        # Two edge directions whose cross product points outwards: the corners then run counter-clockwise.
        first = np.roll(out, 1)
        second = np.cross(out, first)
        corners = [out + a * first + b * second for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        at = len(vertices)
        vertices += [(corner * half_m).tolist() for corner in corners]
        normals += [list(normal)] * 4
        indices += [at, at + 1, at + 2, at, at + 2, at + 3]
    return vertices, normals, indices

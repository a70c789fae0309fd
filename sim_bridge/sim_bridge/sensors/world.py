"""The home as PyBullet bodies: what rays meet. Nothing is rendered with it, so bodies have no look."""

import math
import weakref
from collections.abc import Sequence
from types import TracebackType

import numpy as np
import pybullet

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Float64
from sim_bridge.homes.home import Home
from sim_bridge.homes.shapes import Axis, Part, Shape, Vector3
from sim_bridge.sensors.scenery import floor_part, wall_part, window_parts

# PyBullet takes this many primitives in one body and this many rays in one call.
MAX_PARTS = 16
MAX_RAYS = 4096
NOTHING = -1
ORIGIN_M: Vector3 = (0.0, 0.0, 0.0)

_GEOMETRY = {
    Shape.BOX: pybullet.GEOM_BOX,
    Shape.CYLINDER: pybullet.GEOM_CYLINDER,
    Shape.BALL: pybullet.GEOM_SPHERE,
}
# PyBullet's cylinders stand upright: these turns (roll, pitch, yaw) lay them along an axis.
_TURN_RAD: dict[Axis, Vector3] = {
    Axis.X: (0.0, math.pi / 2.0, 0.0),
    Axis.Y: (math.pi / 2.0, 0.0, 0.0),
    Axis.Z: (0.0, 0.0, 0.0),
}


class World:
    """A PyBullet world of its own for one home. Use it from one thread; close it when done.

    `instance_of` tells for a body's number which object of the home it is; other bodies are not in it.
    """

    def __init__(self, home: Home) -> None:
        """Build the bodies (some 50 ms). Raises BadSceneError where PyBullet has no world left."""
        self.client: int = pybullet.connect(pybullet.DIRECT)
        if self.client < 0:
            raise BadSceneError("PyBullet opens no more worlds in this process: close one first")
        self._finalizer = weakref.finalize(self, pybullet.disconnect, self.client)
        self.instance_of: dict[int, int] = {}
        self._bodies_of: dict[int, list[int]] = {}
        for room in home.rooms:
            self._add((floor_part(room),), ORIGIN_M, 0.0)
        for wall in home.walls:
            self._add((wall_part(wall),), ORIGIN_M, 0.0)
        for window in home.windows:
            self._add(window_parts(window), ORIGIN_M, 0.0)
        for piece in home.furniture:
            self._add(piece.parts, (piece.x_m, piece.y_m, 0.0), piece.yaw_rad)
        for thing in home.objects:
            bodies = self._add(thing.parts, (thing.x_m, thing.y_m, thing.z_m), thing.yaw_rad)
            self._bodies_of[thing.instance] = bodies
            self.instance_of |= dict.fromkeys(bodies, thing.instance)

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

    def move(self, instance: int, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> None:
        """Put an object elsewhere (`map`). Raises BadSceneError where there is none of that instance."""
        if instance not in self._bodies_of:
            raise BadSceneError(f"the home has no object {instance!r}, so it cannot be moved")
        for body in self._bodies_of[instance]:
            pybullet.resetBasePositionAndOrientation(
                body, (x_m, y_m, z_m), _quaternion(yaw_rad), physicsClientId=self.client
            )

    def add_box(self, centre_m: Vector3, size_m: Vector3) -> int:
        """Put a box in the way (`map`), and give the number of its body."""
        halves = [length / 2.0 for length in size_m]
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=halves, physicsClientId=self.client
        )
        body: int = pybullet.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=shape,
            basePosition=centre_m,
            physicsClientId=self.client,
        )
        return body

    def remove(self, body: int) -> None:
        """Take a box away that `add_box` made."""
        pybullet.removeBody(body, physicsClientId=self.client)

    def _add(self, parts: Sequence[Part], origin_m: Vector3, yaw_rad: float) -> list[int]:
        firsts = range(0, len(parts), MAX_PARTS)
        return [self._add_body(parts[at : at + MAX_PARTS], origin_m, yaw_rad) for at in firsts]

    def _add_body(self, parts: Sequence[Part], origin_m: Vector3, yaw_rad: float) -> int:
        across = [part.size_m[part.axis.others[0]] for part in parts]
        shape = pybullet.createCollisionShapeArray(
            shapeTypes=[_GEOMETRY[part.shape] for part in parts],
            halfExtents=[[length / 2.0 for length in part.size_m] for part in parts],
            radii=[diameter / 2.0 for diameter in across],
            lengths=[part.size_m[part.axis] for part in parts],
            collisionFramePositions=[list(part.centre_m) for part in parts],
            collisionFrameOrientations=[
                pybullet.getQuaternionFromEuler(
                    _TURN_RAD[part.axis if part.shape is Shape.CYLINDER else Axis.Z]
                )
                for part in parts
            ],
            physicsClientId=self.client,
        )
        body: int = pybullet.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=shape,
            basePosition=origin_m,
            baseOrientation=_quaternion(yaw_rad),
            physicsClientId=self.client,
        )
        return body


def _quaternion(yaw_rad: float) -> tuple[float, float, float, float]:
    quaternion: tuple[float, float, float, float] = pybullet.getQuaternionFromEuler((0.0, 0.0, yaw_rad))
    return quaternion

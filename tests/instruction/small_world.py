"""Walks that are drawn by a seed and told truly: enough to learn what is wrong, in a second."""

import dataclasses
import math

import numpy as np

from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.scene import Scene
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, SeenObject, Trajectory, Viewpoint

ROOMS = {"kitchen": "kitchen", "bedroom": "bedroom", "bathroom": "bathroom", "hallway": "hallway"}
OBJECTS = ("bed", "sink", "couch", "table", "plant", "piano")
STEP_M = 2.0
FRAMES = (
    "start from the {room} and turn {side} at the {thing} . go into the {last} and stop by the {end} .",
    "leave the {room} . make a {side} turn when you see the {thing} then wait in the {last} near the {end} .",
    "start in the {room} , pass the {thing} and go {side} . enter the {last} . stop next to the {end} .",
)


def in_mirror(scene: Scene) -> Scene:
    """What is to the left is to the right, and the other way round."""
    return dataclasses.replace(
        scene,
        xyz_m=scene.xyz_m * (1.0, -1.0, 1.0),
        yaw_in_rad=-scene.yaw_in_rad,
        turn_rad=-scene.turn_rad,
        bearing_rad=-scene.bearing_rad,
        things={
            name: dataclasses.replace(seen, bearing_rad=-seen.bearing_rad)
            for name, seen in scene.things.items()
        },
    )


def said_walks(homes: int, walks: int, seed: int) -> list[Instruction]:
    """`walks` of each home, each told by all frames: out of a room, one turn at a thing, into a room."""
    rng = np.random.default_rng(seed)
    return [
        instruction
        for home in range(homes)
        for walk in range(walks)
        for instruction in _told(f"home {seed} {home}", f"{seed}{home:03d}{walk:03d}", walk % 2 == 0, rng)
    ]


def _told(home: str, key: str, to_left: bool, rng: np.random.Generator) -> list[Instruction]:
    side = "left" if to_left else "right"  # as often this way as that: words tell nothing
    first, last = rng.choice(list(ROOMS), size=2, replace=False)
    thing, end = rng.choice(OBJECTS, size=2, replace=False)
    trajectory = _walked(side, str(first), str(last), str(thing), str(end))
    words = {"room": first, "side": side, "thing": thing, "last": last, "end": end}
    return [
        Instruction(
            key=f"{key}_{k}", group=home, tokens=tokenized(frame.format(**words)), trajectory=trajectory
        )
        for k, frame in enumerate(FRAMES)
    ]


def _walked(side: str, first: str, last: str, thing: str, end: str) -> Trajectory:
    turn = math.pi / 2.0 if side == "left" else -math.pi / 2.0
    rooms, things = (first, first, "hallway", last), ("", thing, "", end)
    found, x, y, yaw = [], 0.0, 0.0, 0.0
    for room, name in zip(rooms, things, strict=True):
        out = yaw + (turn if name == thing else 0.0)
        found.append(
            Viewpoint(
                x_m=x,
                y_m=y,
                z_m=1.5,
                yaw_in_rad=yaw,
                yaw_out_rad=out,
                rooms=tuple(0.78 if room == one else 0.02 for one in ROOM_TYPES),
                objects=(SeenObject(name=name, bearing_rad=0.2, range_m=1.0),) if name else (),
            )
        )
        yaw = out
        x, y = x + STEP_M * math.cos(yaw), y + STEP_M * math.sin(yaw)
    return Trajectory(viewpoints=tuple(found))

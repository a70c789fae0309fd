"""A short walk that is known by heart: out of a bedroom, left along a hallway, into a kitchen."""

import math

import pytest

from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, SeenObject, Trajectory, Viewpoint


def in_room(room: str) -> tuple[float, ...]:
    return tuple(0.89 if name == room else 0.01 for name in ROOM_TYPES)


@pytest.fixture(scope="session")
def walk() -> Trajectory:
    quarter = math.pi / 2.0
    return Trajectory(
        viewpoints=(
            Viewpoint(
                x_m=0.0,
                y_m=0.0,
                z_m=1.5,
                yaw_in_rad=0.0,
                yaw_out_rad=0.0,
                rooms=in_room("bedroom"),
                objects=(SeenObject(name="bed", bearing_rad=quarter, elevation_rad=-0.3, range_m=1.5),),
            ),
            Viewpoint(
                x_m=3.0,
                y_m=0.0,
                z_m=1.5,
                yaw_in_rad=0.0,
                yaw_out_rad=quarter,
                rooms=in_room("hallway"),
                objects=(SeenObject(name="picture", bearing_rad=-quarter, elevation_rad=0.1, range_m=1.0),),
            ),
            Viewpoint(
                x_m=3.0,
                y_m=4.0,
                z_m=1.5,
                yaw_in_rad=quarter,
                yaw_out_rad=quarter,
                rooms=in_room("kitchen"),
                objects=(SeenObject(name="refrigerator", bearing_rad=0.1, elevation_rad=0.0, range_m=2.0),),
            ),
        )
    )


@pytest.fixture(scope="session")
def instruction(walk: Trajectory) -> Instruction:
    text = (
        "Walk out of the bedroom. Turn left at the painting and stop in the kitchen next to the refrigerator."
    )
    return Instruction(key="1_0", group="home", tokens=tokenized(text), trajectory=walk)

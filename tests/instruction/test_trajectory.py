"""Trajectories check themselves."""

import math

import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.trajectory import SeenObject, Viewpoint, wrapped


def test_turns_are_wrapped() -> None:
    assert wrapped(1.5 * math.pi) == pytest.approx(-0.5 * math.pi)


@pytest.mark.parametrize("rooms", [(), (1.0,), (2.0,) * 12])
def test_wrong_room_evidence_is_refused(rooms: tuple[float, ...]) -> None:
    with pytest.raises(BadParameterError, match="room evidence"):
        Viewpoint(x_m=0.0, y_m=0.0, z_m=0.0, yaw_in_rad=0.0, yaw_out_rad=0.0, rooms=rooms)


def test_nan_is_refused() -> None:
    with pytest.raises(BadParameterError, match="range_m"):
        SeenObject(name="bed", range_m=math.nan)
    with pytest.raises(BadParameterError, match="x_m"):
        Viewpoint(x_m=math.inf, y_m=0.0, z_m=0.0, yaw_in_rad=0.0, yaw_out_rad=0.0)

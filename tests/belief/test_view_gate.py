import math

import pytest

from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.view_gate import Verdict, ViewGate

PARAMETERS = BeliefParameters(
    min_translation_m=0.15, min_rotation_rad=math.radians(15), max_speed_m_s=0.05, max_turn_rad_s=0.05
)
HERE = Pose2D(x_m=1.0, y_m=2.0, yaw_rad=math.pi - 0.01)


@pytest.mark.parametrize(
    ("pose", "verdict"),
    [
        (HERE, Verdict.SEEN_BEFORE),
        (Pose2D(x_m=1.1, y_m=2.1, yaw_rad=math.pi), Verdict.SEEN_BEFORE),
        (Pose2D(x_m=1.0, y_m=2.0, yaw_rad=-math.pi + 0.01), Verdict.SEEN_BEFORE),
        (Pose2D(x_m=1.2, y_m=2.0, yaw_rad=math.pi), Verdict.COUNTED),
        (Pose2D(x_m=1.0, y_m=2.0, yaw_rad=math.pi - 0.3), Verdict.COUNTED),
    ],
)
def test_one_view_counts_once(pose, verdict):
    gate = ViewGate(PARAMETERS)
    assert gate.judge(HERE, 0.0, 0.0) is Verdict.COUNTED
    assert gate.judge(pose, 0.0, 0.0) is verdict


def test_coming_back_to_an_earlier_view_does_not_count():
    gate = ViewGate(PARAMETERS)
    away = Pose2D(x_m=3.0, y_m=2.0)
    assert [gate.judge(pose, 0.0, 0.0) for pose in (HERE, away, HERE, away)] == [
        Verdict.COUNTED,
        Verdict.COUNTED,
        Verdict.SEEN_BEFORE,
        Verdict.SEEN_BEFORE,
    ]


@pytest.mark.parametrize(("linear_m_s", "angular_rad_s"), [(0.2, 0.0), (-0.2, 0.0), (0.0, 0.3), (0.0, -0.3)])
def test_a_view_while_moving_does_not_count_and_is_not_remembered(linear_m_s, angular_rad_s):
    gate = ViewGate(PARAMETERS)
    assert gate.judge(HERE, linear_m_s, angular_rad_s) is Verdict.MOVING
    assert gate.judge(HERE, 0.0, 0.0) is Verdict.COUNTED

"""The bumper is pressed as long as the robot is driven against something."""

import pytest

from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.bumper import RELEASE_S, Bumper
from sim_bridge.robot.drive import Drive, DriveLimits

DT_S = 0.02
LIMITS = DriveLimits(
    speed_m_s=0.5, turn_rad_s=1.2, acceleration_m_s2=1.0, turn_acceleration_rad_s2=4.0, braking=2.5
)


def test_it_is_pressed_at_once_and_released_after_its_time() -> None:
    bumper = Bumper()
    assert not bumper.update(False, DT_S)
    assert bumper.update(True, DT_S)
    assert bumper.pressed
    steps = round(RELEASE_S / DT_S)
    assert [bumper.update(False, DT_S) for _ in range(steps + 5)] == [False] * (steps - 1) + [True] + [
        False
    ] * 5
    assert not bumper.pressed


def test_single_free_steps_do_not_release_it() -> None:
    bumper = Bumper()
    edges = [bumper.update(step % 9 == 0, DT_S) for step in range(200)]
    assert edges == [True] + [False] * 199


@pytest.mark.parametrize("stop_m", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("back", [False, True])
def test_a_robot_that_is_driven_against_a_wall_presses_it_once(stop_m: float, back: bool) -> None:
    wall = Rect(x_min_m=1.0, y_min_m=-2.0, x_max_m=1.1, y_max_m=2.0)
    hall = Rect(x_min_m=-5.0, y_min_m=-5.0, x_max_m=5.0, y_max_m=5.0)
    drive = Drive(Obstacles([wall], hall), LIMITS, 0.15, stop_m)
    drive.place(Pose2D(x_m=0.0, y_m=0.0))
    bumper = Bumper()

    def drive_on(linear: float, seconds: float) -> list[bool]:
        edges = []
        for _ in range(round(seconds / DT_S)):
            drive.step(Velocity(linear_m_s=linear, angular_rad_s=0.0), DT_S)
            if bumper.update(drive.blocked, DT_S):
                edges.append(bumper.pressed)
        return edges

    assert drive_on(0.5, 5.0) == [True]
    assert 0.0 <= 1.0 - drive.pose.x_m - drive.keep_m < 2e-4
    assert drive_on(-0.3 if back else 0.0, 0.5) == [False]
    assert drive_on(0.0, 1.0) == []

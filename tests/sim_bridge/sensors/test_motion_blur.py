"""The picture smears where the robot moves, and only then."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import ColorImage, Pose2D, Velocity
from sim_bridge.robot.drive import STANDSTILL
from sim_bridge.sensors.camera import camera_model
from sim_bridge.sensors.degradations import ImageDegradation
from sim_bridge.sensors.degraded_camera import DegradedCamera
from sim_bridge.sensors.motion_blur import MOST_PICTURES, blur_poses, image_motion_px, mean_image
from sim_bridge.simulation import Simulation

MODEL = camera_model(320, 240, math.radians(60.0))
POSE = Pose2D(x_m=1.0, y_m=-2.0, yaw_rad=0.7)


def image(level: int, height: int = 3, width: int = 4, stamp_ns: int = 0) -> ColorImage:
    return ColorImage(
        pixels=np.full((height, width, 3), level, dtype=np.uint8), stamp_ns=stamp_ns, frame_id="camera"
    )


@pytest.mark.parametrize("seed", range(100))
def test_poses_are_few_even_in_time_and_around_the_middle_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    velocity = Velocity(linear_m_s=float(rng.uniform(-1, 1)), angular_rad_s=float(rng.uniform(-2, 2)))
    exposure_s = float(rng.uniform(0.0, 0.1))
    poses = blur_poses(POSE, velocity, exposure_s, MODEL)
    assert len(poses) % 2 == 1
    assert len(poses) <= MOST_PICTURES
    assert poses[len(poses) // 2] == POSE
    assert (len(poses) == 1) == (image_motion_px(velocity, exposure_s, MODEL) < 0.5)
    turns = [one.turn_rad(other) for one, other in itertools.pairwise(poses)]
    steps = [one.distance_m(other) for one, other in itertools.pairwise(poses)]
    assert turns == pytest.approx([velocity.angular_rad_s * exposure_s / len(poses)] * len(turns))
    assert steps == pytest.approx([steps[0]] * len(steps) if steps else [])


def test_a_robot_that_stands_takes_one_picture() -> None:
    assert blur_poses(POSE, STANDSTILL, 0.1, MODEL) == (POSE,)
    assert blur_poses(POSE, Velocity(linear_m_s=0.5, angular_rad_s=1.2), 0.0, MODEL) == (POSE,)


def test_an_arc_by_hand() -> None:
    """1 m/s and 1 rad/s: a circle of 1 m; the five moments are -0.04, -0.02, 0, 0.02 and 0.04 s."""
    poses = blur_poses(Pose2D(x_m=0.0, y_m=0.0), Velocity(linear_m_s=1.0, angular_rad_s=1.0), 0.1, MODEL)
    for pose, angle in zip(poses, (-0.04, -0.02, 0.0, 0.02, 0.04), strict=True):
        assert pose.yaw_rad == pytest.approx(angle)
        assert pose.x_m == pytest.approx(math.sin(angle))
        assert pose.y_m == pytest.approx(1.0 - math.cos(angle))


def test_the_mean_is_rounded_and_takes_the_middle_stamp() -> None:
    mean = mean_image([image(10, stamp_ns=1), image(20, stamp_ns=2), image(32, stamp_ns=3)])
    assert (mean.pixels == 21).all()
    assert mean.stamp_ns == 2
    assert (mean_image([image(255)] * MOST_PICTURES).pixels == 255).all()
    alone = image(7)
    assert mean_image([alone]) is alone


def test_pictures_that_have_no_mean_are_refused() -> None:
    with pytest.raises(BadMessageError, match="at least one"):
        mean_image([])
    with pytest.raises(BadMessageError, match="one camera"):
        mean_image([image(1), image(1, width=5)])


def contrast(pixels: np.ndarray) -> np.ndarray:
    """Mean square of the difference between neighbours, across and down: sharp edges have large ones."""
    levels = pixels.astype(float)
    return np.array([np.square(np.diff(levels, axis=axis)).mean() for axis in (1, 0)])


def test_a_turn_smears_across_and_not_down(simulation: Simulation) -> None:
    turning = Velocity(linear_m_s=0.0, angular_rad_s=1.2)
    camera = DegradedCamera(simulation._camera, ImageDegradation(exposure_s=0.03), seed=1)
    still, blurred = np.zeros(2), np.zeros(2)
    for heading in range(4):
        pose = dataclasses.replace(simulation.home.start, yaw_rad=heading * 1.5)
        still += contrast(camera.take(pose, STANDSTILL, 0, 0).color.pixels)
        blurred += contrast(camera.take(pose, turning, 0, 0).color.pixels)
    across, down = blurred / still
    assert across < 0.35
    assert down > 2.0 * across

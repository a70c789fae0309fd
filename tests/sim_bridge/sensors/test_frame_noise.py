"""Chance belongs to a frame, not to the order in which frames are drawn."""

import numpy as np
import pytest

from sim_bridge.sensors.frame_noise import frame_rng, normals


def test_normals_are_standard_normal() -> None:
    drawn = normals(frame_rng(1, 2, 3), (1000, 1000))
    assert drawn.dtype == np.float32
    assert drawn.mean() == pytest.approx(0.0, abs=4e-3)
    assert drawn.std() == pytest.approx(1.0, abs=3e-3)
    # By hand: 68.27 % within one, 95.45 % within two, 99.73 % within three standard deviations.
    for reach, share in ((1.0, 0.6827), (2.0, 0.9545), (3.0, 0.9973)):
        assert (np.abs(drawn) < reach).mean() == pytest.approx(share, abs=2e-3)


def test_seed_frame_and_stream_each_decide_the_draw() -> None:
    first = normals(frame_rng(1, 2, 3), (5, 7))
    assert (normals(frame_rng(1, 2, 3), (5, 7)) == first).all()
    for other in ((2, 2, 3), (1, 3, 3), (1, 2, 4)):
        assert (normals(frame_rng(*other), (5, 7)) != first).any()


def test_neighbouring_pixels_and_frames_are_independent() -> None:
    now, later = (normals(frame_rng(4, frame, 1), (400, 400)) for frame in (10, 11))
    assert np.corrcoef(now.ravel(), later.ravel())[0, 1] == pytest.approx(0.0, abs=0.01)
    assert np.corrcoef(now[:, 1:].ravel(), now[:, :-1].ravel())[0, 1] == pytest.approx(0.0, abs=0.01)

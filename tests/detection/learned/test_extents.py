"""How large a thing is comes from its box and its depth, and from nothing where depth is not known."""

import numpy as np

from robustnav_nodes.detection.learned.extents import EXTENTS, extents

ROWS, COLUMNS = 240, 320


def test_the_same_thing_from_twice_as_far_has_the_same_size_in_metres() -> None:
    boxes = np.array([[100, 100, 140, 160], [10, 10, 30, 40]], dtype=np.float32)
    near, far = extents(boxes, np.array([0.004, 0.008], dtype=np.float32), ROWS, COLUMNS)
    assert np.allclose(near[:2] - far[:2], np.log(2.0))
    assert np.allclose(near[2:], far[2:])


def test_an_unknown_depth_says_nothing_of_metres() -> None:
    box = np.array([[100, 100, 140, 160]], dtype=np.float32)
    unknown = extents(box, np.array([np.nan], dtype=np.float32), ROWS, COLUMNS)[0]
    known = extents(box, np.array([0.004], dtype=np.float32), ROWS, COLUMNS)[0]
    assert unknown.shape == (EXTENTS,)
    assert np.isfinite(unknown).all()
    assert (unknown != known).sum() >= 3  # both sides, and that they are known
    assert unknown[:2].tolist() == known[:2].tolist()


def test_a_box_tells_at_which_edges_it_is_cut() -> None:
    inside = [100, 100, 140, 160]
    boxes = np.array(
        [inside, [100, 0, 140, 160], [100, 100, 140, 240], [0, 100, 140, 160], [100, 100, 320, 160]],
        dtype=np.float32,
    )
    cut = extents(boxes, np.full(5, np.nan, dtype=np.float32), ROWS, COLUMNS)[:, -3:]
    assert cut.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]]

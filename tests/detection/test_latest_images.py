"""Parts of an image are put together by their stamp; older images are dropped."""

import numpy as np

from robustnav_msgs_py.values import DepthImage, VisibleObjects
from robustnav_nodes.detection.latest_images import LatestImages

S = 1_000_000_000


def depth(stamp_ns: int) -> DepthImage:
    return DepthImage(depth_m=np.ones((1, 1), np.float32), stamp_ns=stamp_ns, frame_id="c")


def nothing_seen(stamp_ns: int) -> VisibleObjects:
    none = np.zeros(0, np.uint32)
    return VisibleObjects(
        position_m=np.zeros((0, 3), np.float32), label=none, instance=none,
        visible_fraction=np.zeros(0, np.float32), box_px=np.zeros((0, 4), np.float32), stamp_ns=stamp_ns,
    )  # fmt: skip


def test_parts_of_one_stamp_make_one_image_even_where_nothing_is_seen() -> None:
    images = LatestImages(keep=3)
    assert images.add(S, seen=nothing_seen(S)) is None
    assert images.add(2 * S, depth=depth(2 * S)) is None
    whole = images.add(S, depth=depth(S))
    assert whole is not None
    assert (whole.stamp_ns, len(whole.seen or ())) == (S, 0)


def test_an_older_image_is_not_completed_any_more() -> None:
    images = LatestImages(keep=3)
    images.add(S, depth=depth(S))
    images.add(2 * S, depth=depth(2 * S))
    assert images.add(2 * S, seen=nothing_seen(2 * S)) is not None
    assert images.add(S, seen=nothing_seen(S)) is None


def test_few_are_kept() -> None:
    images = LatestImages(keep=2)
    for stamp in range(1, 6):
        images.add(stamp * S, depth=depth(stamp * S))
    assert images.add(S, seen=nothing_seen(S)) is None
    assert images.add(5 * S, seen=nothing_seen(5 * S)) is not None


def test_time_that_begins_anew_forgets_the_past() -> None:
    images = LatestImages(keep=2)
    images.add(100 * S, depth=depth(100 * S))
    assert images.add(100 * S, seen=nothing_seen(100 * S)) is not None
    images.add(S, depth=depth(S))
    assert images.add(S, seen=nothing_seen(S)) is not None

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.search_space.buckets import bucketed

PLACE = st.floats(-50.0, 50.0)


@given(points=st.lists(st.tuples(PLACE, PLACE), min_size=1, max_size=50), side_m=st.floats(10.0, 200.0))
@settings(max_examples=100, deadline=None)
def test_every_point_lies_in_the_one_bucket_that_covers_it(points, side_m):
    x_m, y_m = np.array(points).T
    buckets = bucketed(x_m, y_m, side_m)
    assert buckets.side_m >= side_m
    assert sorted(buckets.member) == list(range(len(points)))
    for row in range(buckets.rows):
        for column in range(buckets.columns):
            i = row * buckets.columns + column
            inside = buckets.member[buckets.start[i] : buckets.start[i + 1]]
            assert (np.diff(inside) > 0).all()
            for points_at, low, at in ((x_m, buckets.x_m, column), (y_m, buckets.y_m, row)):
                place = (points_at[inside] - low) / buckets.side_m
                assert ((at <= place) & (place < at + 1)).all()


def test_a_vast_floor_gets_wider_buckets_not_more():
    far = np.array([0.0, 1e7])
    buckets = bucketed(far, far, 0.2)
    assert (buckets.rows, buckets.columns) == (512, 512)
    assert buckets.side_m == pytest.approx(1e7 / 511)

from dataclasses import replace

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_nodes.search_space.camera_view import build_camera_view
from robustnav_nodes.search_space.observability import Observability, build_observability
from robustnav_nodes.search_space.pose_graph import build_pose_graph


def test_the_number_of_threads_does_not_change_the_table(two_rooms, parameters):
    parameters = replace(parameters, spacing_m=0.1)
    view = build_camera_view(*two_rooms, parameters)
    graph = build_pose_graph(view.grid, parameters)
    alone, together = (build_observability(view, graph, parameters, threads=threads) for threads in (1, 7))
    assert len(graph) > 1024  # more than one turn
    for name in ("seen_start", "seen", "seers_start", "seers"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(together, name))


def test_a_table_of_rows_by_hand():
    """Pose 0 sees 1 and 2, pose 1 nothing, pose 2 sees 1; nobody sees 0."""
    table = Observability.of_rows(np.array([0, 2, 2, 3]), np.array([1, 2, 1], dtype=np.int32), 3)
    assert (table.poses, table.candidates) == (3, 3)
    assert [table.seers_of(candidate).tolist() for candidate in range(3)] == [[], [0, 2], [0]]
    assert table.seen_from_somewhere().tolist() == [False, True, True]


@pytest.mark.parametrize(
    ("seen_start", "seen", "sentence"),
    [
        ([], [], "must begin at 0"),
        ([1, 2], [0, 0], "must begin at 0"),
        ([0, 2], [0], r"end at 1"),
        ([0, 2, 1, 3], [0, 0, 0], "ascend"),
        ([0, 1], [3], r"of 3 candidate locations names candidates 3 \.\. 3"),
        ([0, 1], [-1], r"names candidates -1"),
    ],
)
def test_rows_that_make_no_sense_are_refused(seen_start, seen, sentence):
    with pytest.raises(BadMessageError, match=sentence):
        Observability.of_rows(np.array(seen_start, dtype=np.int64), np.array(seen, dtype=np.int32), 3)

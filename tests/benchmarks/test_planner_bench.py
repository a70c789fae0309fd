import numpy as np
import pytest

from robustnav_nodes.benchmarks.planner_bench import (
    PlannerRow,
    draw_planner_rows,
    synthetic_floor,
)
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.space import SearchSpace


@pytest.mark.parametrize("size", [100, 1000, 3000])
def test_a_floor_is_about_as_large_as_asked_for_and_connected(size):
    floor_map, mask = synthetic_floor(size, np.random.default_rng(0))
    parameters = SearchSpaceParameters(candidate_size_m=0.1, camera_forward_m=0.0)
    space = SearchSpace.build(floor_map, mask, parameters)
    assert 0.5 * size < len(space.graph) < 2.0 * size
    assert 0.5 * size < len(space.candidates) < 2.0 * size
    assert np.isfinite(space.graph.steps_from(0)).all()


def test_a_floor_depends_on_its_seed_alone():
    floors = [synthetic_floor(1000, np.random.default_rng(seed))[0].cells for seed in (1, 1, 2)]
    np.testing.assert_array_equal(floors[0], floors[1])
    assert not np.array_equal(floors[0], floors[2])


def test_growth_is_drawn(tmp_path):
    row = {
        "simulations_per_s": 1.0,
        "simulated_steps_per_s": 1.0,
        "decision_ms_p50": 1.0,
        "decision_ms_p95": 2.0,
        "lookahead_ms_p50": 5.0,
        "belief_update_ms": 0.1,
        "search_space_s": 1.0,
        "rss_mb": 200.0,
    }
    png = tmp_path / "growth.png"
    draw_planner_rows([PlannerRow(poses=n, candidates=n, **row) for n in (100, 1000)], png)
    assert png.read_bytes().startswith(b"\x89PNG")

"""A search goes on when the map grows under it."""

import numpy as np
import pytest

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import BeliefCloud, Pose2D
from robustnav_nodes.planner.search_session import SearchSession

CELL_M = 0.3
HALF = ("##########", "#o.......#", "#o.......#", "##########")
WHOLE = ("####################", "#o................o#", "#o.................#", "####################")
HALF_ENDS_M = CELL_M * len(HALF[0])
START = Pose2D(x_m=1.5, y_m=0.75, yaw_rad=np.pi)


def cloud_on(space, *probability: float) -> BeliefCloud:
    return BeliefCloud(position_m=space.candidates.position_m, probability=np.array(probability), stamp_ns=1)


@pytest.mark.parametrize("variant", ["lookahead", "greedy", "pomp_be_pd"])
def test_steps_and_where_the_robot_has_been_are_kept(space_of, parameters_with, variant):
    half, whole = space_of(*HALF), space_of(*WHOLE)
    assert (len(half.candidates), len(whole.candidates)) == (2, 3)
    assert len(whole.graph) > len(half.graph)
    session = SearchSession(
        target="mug",
        space=half,
        parameters=parameters_with(variant=variant, simulations=64),
        rng=np.random.default_rng(0),
    )
    robot = START
    for _ in range(3):
        step = session.observe(robot, cloud_on(half, 0.5, 0.5))
        assert step.goal is not None
        robot = step.goal
    session.move_to(whole)
    step = session.observe(robot, cloud_on(whole, 0.15, 0.15, 0.7))
    assert step.state.phase is SearchPhase.SEARCHING
    assert step.state.step == 4
    assert step.state.path_length_m > 0.0
    while step.goal is not None and step.goal.x_m < HALF_ENDS_M:
        robot = step.goal
        step = session.observe(robot, cloud_on(whole, 0.15, 0.15, 0.7))
    assert step.goal is not None, "it never went to the part that is new"

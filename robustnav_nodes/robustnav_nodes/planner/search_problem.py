"""Looking for one object as a POMDP (thesis 3.2.1.1): the model that POMCP simulates."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.pomcp import Tree, simulate
from robustnav_nodes.planner.problem import Problem, State, implement
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph

POSE, SIMULATION = 0, 1  # entries of a state
NOT_SEEN, SEEN = 0, 1  # observations
ALWAYS, NEVER = -1, -2  # entries of the scratch arrays that are no simulation's number


class SearchModel(NamedTuple):
    """State: (pose, number of the simulation). Seeing the target ends it.

    successors: int32 [n, 4]; seers_start, seers: as in Observability; start: the robot's pose.
    last_seer: int32 [n], scratch: the last simulation whose target is seen from there. Marking the poses
    that see it once is cheaper than asking a table of n x k at every step.
    last_visit: int32 [n], scratch: ALWAYS where the robot has been, else the last simulation that was there.
    """

    successors: NDArray[np.int32]
    seers_start: NDArray[np.int64]
    seers: NDArray[np.int32]
    last_seer: NDArray[np.int32]
    last_visit: NDArray[np.int32]
    start: int
    reward_seen: float
    cost_step: float
    cost_revisit: float


def search_model(
    graph: PoseGraph,
    observability: Observability,
    start: int,
    visited: NDArray[np.bool_],
    parameters: PlannerParameters,
) -> SearchModel:
    """The model for one decision at pose `start`; `visited` (bool [n]): where the robot was before."""
    last_visit = np.where(visited, ALWAYS, NEVER).astype(np.int32)
    last_visit[start] = ALWAYS
    return SearchModel(
        successors=graph.successors,
        seers_start=observability.seers_start,
        seers=observability.seers,
        last_seer=np.full(len(graph), NEVER, dtype=np.int32),
        last_visit=last_visit,
        start=start,
        reward_seen=parameters.reward_seen,
        cost_step=parameters.cost_step,
        cost_revisit=parameters.cost_revisit,
    )


def _begin(model: SearchModel, particle: int, simulation: int, state: State) -> None:
    state[POSE] = model.start
    state[SIMULATION] = simulation
    for sight in range(model.seers_start[particle], model.seers_start[particle + 1]):
        model.last_seer[model.seers[sight]] = simulation


def _is_legal(model: SearchModel, state: State, action: int) -> bool:
    return bool(model.successors[state[POSE], action] != NOWHERE)


def _step(model: SearchModel, state: State, action: int, rng: np.random.Generator) -> tuple[int, float, bool]:
    pose = model.successors[state[POSE], action]
    state[POSE] = pose
    if model.last_seer[pose] == state[SIMULATION]:
        return SEEN, model.reward_seen, True
    last_visit = model.last_visit[pose]
    if last_visit == ALWAYS or last_visit == state[SIMULATION]:
        return NOT_SEEN, -model.cost_revisit, False
    model.last_visit[pose] = state[SIMULATION]
    return NOT_SEEN, -model.cost_step, False


implement(SearchModel, begin=_begin, is_legal=_is_legal, step=_step)


@compiled
def _simulate_search(
    model: SearchModel,
    tree: Tree,
    particles: NDArray[np.int64],
    first_simulation: int,
    last_simulation: int,
    rng: np.random.Generator,
) -> None:
    simulate(model, tree, particles, first_simulation, last_simulation, rng)


SEARCH = Problem(actions=len(Action), observations=2, state_size=2, simulate=_simulate_search)

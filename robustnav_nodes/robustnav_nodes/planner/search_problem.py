"""Looking for one object as a POMDP (thesis 3.2.1.1): the model that POMCP simulates."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.planner.guide import NO_GUIDE, Guide
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.pomcp import Tree, simulate
from robustnav_nodes.planner.problem import Particles, Problem, State, implement
from robustnav_nodes.planner.random_stream import Stream, below, uniform
from robustnav_nodes.search_space.compiled import compiled, compiled_into_callers
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph

POSE, SIMULATION = 0, 1  # entries of a state
NOT_SEEN, SEEN = 0, 1  # observations
# Entries of the scratch arrays that are no simulation's number: before all of them, and after.
NEVER, ALWAYS = np.int32(-1), np.int32(2**31 - 1)


class SearchModel(NamedTuple):
    """State: (pose, number of the simulation). Seeing the target ends it. A particle is a candidate's number.

    successors: int32 [n, 4]; ways: int32 [n, 4], those of them that lead somewhere, first; way_count: int8
    [n], how many; seers_start, seers: as in Observability; start: the robot's pose.
    last_seer: int32 [n], scratch: the last simulation whose target is seen from there. Marking the poses
    that see it once is cheaper than asking a table of n x k at every step.
    last_visit: int32 [n], scratch: the last simulation that was there, NEVER, or ALWAYS where the robot was.
    guide: the plan that a rollout's step follows with probability `guidance`; sees_again: whether a pose
    where the robot was before can still show the target.
    """

    successors: NDArray[np.int32]
    ways: NDArray[np.int32]
    way_count: NDArray[np.int8]
    seers_start: NDArray[np.int64]
    seers: NDArray[np.int32]
    last_seer: NDArray[np.int32]
    last_visit: NDArray[np.int32]
    guide: Guide
    guidance: float
    sees_again: bool
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
    guide: Guide | None = None,
    *,
    sees_again: bool = True,
) -> SearchModel:
    """The model for one decision at pose `start`; `visited` (bool [n]): where the robot was before.

    guide: followed by rollouts' steps with probability `parameters.guidance`; None: they go anywhere.
    """
    last_visit = np.where(visited, ALWAYS, NEVER)
    last_visit[start] = ALWAYS
    ways, way_count = _ways(graph.successors)
    return SearchModel(
        successors=graph.successors,
        ways=ways,
        way_count=way_count,
        seers_start=observability.seers_start,
        seers=observability.seers,
        last_seer=np.full(len(graph), NEVER),
        last_visit=last_visit,
        sees_again=sees_again,
        guide=NO_GUIDE if guide is None else guide,
        guidance=0.0 if guide is None else parameters.guidance,
        start=start,
        reward_seen=parameters.reward_seen,
        cost_step=parameters.cost_step,
        cost_revisit=parameters.cost_revisit,
    )


@compiled
def _ways(successors: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int8]]:
    ways = np.full_like(successors, NOWHERE)
    way_count = np.zeros(len(successors), dtype=np.int8)
    for pose in range(len(successors)):
        for action in range(successors.shape[1]):
            if successors[pose, action] != NOWHERE:
                ways[pose, way_count[pose]] = successors[pose, action]
                way_count[pose] += 1
    return ways, way_count


def _begin(model: SearchModel, particle: int, simulation: int, state: State) -> None:
    state[POSE] = model.start
    state[SIMULATION] = simulation
    for sight in range(model.seers_start[particle], model.seers_start[particle + 1]):
        seer = model.seers[sight]
        if model.sees_again or model.last_visit[seer] != ALWAYS:
            model.last_seer[seer] = simulation


def _is_legal(model: SearchModel, state: State, action: int) -> bool:
    return bool(model.successors[state[POSE], action] != NOWHERE)


def _step(model: SearchModel, state: State, action: int, rng: Stream) -> tuple[int, float, bool]:
    return _arrive(model, state, model.successors[state[POSE], action])


def _rollout_step(model: SearchModel, state: State, actions: int, rng: Stream) -> tuple[float, bool]:
    """Towards the first goal of the guide that the simulation has not been to yet, or any way out.

    Drawn from a list of ways: two loads, where asking every action whether it is legal takes eight.
    """
    pose = state[POSE]
    if model.way_count[pose] == 0:
        return 0.0, True
    if model.guidance > 0.0 and uniform(rng) < model.guidance:
        for number in range(len(model.guide.goals)):
            after = model.guide.towards[number, pose]
            if after != NOWHERE and model.last_visit[model.guide.goals[number]] != state[SIMULATION]:
                _, reward, ended = _arrive(model, state, after)
                return reward, ended
    _, reward, ended = _arrive(model, state, model.ways[pose, below(rng, model.way_count[pose])])
    return reward, ended


@compiled_into_callers
def _arrive(model: SearchModel, state: State, pose: int) -> tuple[int, float, bool]:
    """Observation, reward and end at `pose`. Written to need no branch that chance decides but the last."""
    state[POSE] = pose
    simulation = state[SIMULATION]
    last_visit = model.last_visit[pose]
    model.last_visit[pose] = max(last_visit, simulation)
    cost = model.cost_revisit if last_visit >= simulation else model.cost_step
    if model.last_seer[pose] == simulation:
        return SEEN, model.reward_seen, True
    return NOT_SEEN, -cost, False


implement(SearchModel, begin=_begin, is_legal=_is_legal, step=_step, rollout_step=_rollout_step)


@compiled
def _simulate_search(
    model: SearchModel,
    tree: Tree,
    particles: Particles,
    first_simulation: int,
    last_simulation: int,
    rng: Stream,
) -> None:
    simulate(model, tree, particles, first_simulation, last_simulation, rng)


SEARCH = Problem(actions=len(Action), observations=2, state_size=2, simulate=_simulate_search)

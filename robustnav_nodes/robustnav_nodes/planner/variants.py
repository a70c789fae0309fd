"""The planners by name: the baselines, the thesis' four variants, and ours."""

import time
from collections.abc import Callable

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.planner.baselines import Greedy, GreedyGain, RandomWalk
from robustnav_nodes.planner.lookahead import Lookahead
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.particles import BelievedCandidates, CandidatesNotRuledOut, ParticleFilter
from robustnav_nodes.planner.policy import Policy
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.pomp import Pomp
from robustnav_nodes.search_space.space import SearchSpace


def policy_of(space: SearchSpace, parameters: PlannerParameters, clock: Clock = time.monotonic) -> Policy:
    """The policy of `parameters.variant`, for one search. Raises BadParameterError for an unknown one."""

    def pomp_with_filter() -> Policy:
        particles = ParticleFilter(space.candidates, parameters.reinvigoration_radius_m)
        return Pomp(space, particles, parameters, clock)

    def pomp_with_pp() -> Policy:
        particles = CandidatesNotRuledOut(space.observability.seen_from_somewhere())
        return Pomp(space, particles, parameters, clock)

    def pomp_with_belief() -> Policy:
        particles = BelievedCandidates(space.observability.seen_from_somewhere())
        guided = parameters.variant == "pomp_guided"
        return Pomp(space, particles, parameters, clock, sees_again=False, guided=guided)

    makers: dict[str, Callable[[], Policy]] = {
        "random": RandomWalk,
        "greedy": lambda: Greedy(space),
        "greedy_gain": lambda: GreedyGain(space),
        "pomp": pomp_with_filter,
        "pomp_be": pomp_with_pp,
        "pomp_pd": pomp_with_filter,
        "pomp_be_pd": pomp_with_pp,
        "pomp_belief": pomp_with_belief,
        "pomp_guided": pomp_with_belief,
        "lookahead": lambda: Lookahead(space, parameters, clock),
    }
    if parameters.variant not in makers:
        raise BadParameterError(f"there is no planner {parameters.variant!r}, only {', '.join(makers)}")
    return makers[parameters.variant]()

"""The thesis' planner as a policy: POMCP on the search problem, with particles from one of three sources."""

import time

import numpy as np

from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.particles import ParticleSource
from robustnav_nodes.planner.policy import Choice, Sight, Situation
from robustnav_nodes.planner.pomcp import Clock, plan
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.search_space.space import SearchSpace


class Pomp:
    """Simulates searches for targets drawn from `particles`; a Policy."""

    def __init__(
        self,
        space: SearchSpace,
        particles: ParticleSource,
        parameters: PlannerParameters,
        clock: Clock = time.monotonic,
    ) -> None:
        self._observability = space.observability
        self._particles = particles
        self._parameters = parameters
        self._clock = clock

    def looked(self, sight: Sight) -> None:
        """See Policy."""
        self._particles.looked(sight.in_view, sight.rose, sight.probability)

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy."""
        parameters = self._parameters
        model = search_model(
            situation.graph, self._observability, situation.pose, situation.visited, parameters
        )
        particles = self._particles.draw(parameters.simulations, rng)
        plan_made = plan(SEARCH, model, particles, parameters, rng, self._clock)
        self._particles.decided(plan_made, particles)
        return Choice(
            action=plan_made.action,
            values=plan_made.values,
            visits=plan_made.visits,
            simulations=plan_made.simulations,
            elapsed_ms=plan_made.elapsed_ms,
            reason=f"worth {plan_made.values[plan_made.action]:.1f} over {plan_made.simulations} simulations",
        )

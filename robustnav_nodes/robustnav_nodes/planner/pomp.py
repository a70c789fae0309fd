"""The thesis' planner as a policy: POMCP on the search problem, with particles from one of three sources."""

import time

import numpy as np

from robustnav_nodes.planner.guide import Guide, guide_from
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.particles import ParticleSource
from robustnav_nodes.planner.policy import Choice, Sight, Situation
from robustnav_nodes.planner.pomcp import Clock, plan
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.planner.viewpoints import outlook_on, place_of
from robustnav_nodes.search_space.space import SearchSpace

_GOALS = 20  # of a guide; after so many viewpoints the discount leaves little


class Pomp:
    """Simulates searches for targets drawn from `particles`; a Policy.

    sees_again: whether a pose where the robot was before can still show the target, as in the thesis; a
    detector that missed it there will miss it again. guided: whether rollouts go where the belief is
    (parameter `guidance`), or anywhere.
    """

    def __init__(
        self,
        space: SearchSpace,
        particles: ParticleSource,
        parameters: PlannerParameters,
        clock: Clock = time.monotonic,
        *,
        sees_again: bool = True,
        guided: bool = False,
    ) -> None:
        self._observability = space.observability
        self._particles = particles
        self._parameters = parameters
        self._clock = clock
        self._sees_again = sees_again
        self._guided = guided

    def looked(self, sight: Sight) -> None:
        """See Policy."""
        self._particles.looked(sight.in_view, sight.rose, sight.probability)

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy."""
        parameters = self._parameters
        guide = self._guide(situation) if self._guided else None
        model = search_model(
            situation.graph,
            self._observability,
            situation.pose,
            situation.visited,
            parameters,
            guide,
            sees_again=self._sees_again,
        )
        particles = self._particles.draw(parameters.simulations, rng)
        plan_made = plan(SEARCH, model, particles, parameters, rng, self._clock)
        self._particles.decided(plan_made, particles)
        return Choice(
            action=plan_made.action,
            values=plan_made.values,
            visits=plan_made.visits,
            simulations=plan_made.simulations,
            reason=f"worth {plan_made.values[plan_made.action]:.1f} over {plan_made.simulations} simulations",
        )

    def _guide(self, situation: Situation) -> Guide:
        place = place_of(situation.graph, self._observability)
        outlook = outlook_on(place, situation.sight.probability.copy(), situation.visited.copy())
        return guide_from(place, outlook, situation.pose, _GOALS)

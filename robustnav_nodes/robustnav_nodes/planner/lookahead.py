"""Our planner: thinks each of the best viewpoints through to the end and takes the one that is worth most.

A rollout algorithm (Bertsekas and Castanon 1999): the greedy rule, most unseen belief per step, is followed
from each of several first viewpoints, and the best of these plans is begun. With the greedy rule's own first
choice among them and the plan of the last decision kept, the plan is never worth less than the rule's.

Where POMCP draws the target's location for each simulation and learns from one find or none, here a
simulation collects the whole belief along its way: its result is exact, and twenty do for one decision.
"""

import time

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Choice, Sight, Situation
from robustnav_nodes.planner.pomcp import Clock
from robustnav_nodes.planner.viewpoints import (
    Outlook,
    Place,
    empty_reach,
    first_sight_distance,
    outlook_on,
    place_of,
    walk_everywhere,
    way_to,
    worth_of_way,
)
from robustnav_nodes.search_space.pose_graph import Action
from robustnav_nodes.search_space.space import SearchSpace


class Lookahead:
    """See the module; a Policy.

    What a find is worth (parameter `worth`): "discount", the thesis' discount ^ steps; "ratio", the shortest
    way from the start to a view of the target over the way taken, the quantity that SPL averages: a target
    that is far anyway may be found late, one that is near may not.
    """

    def __init__(
        self, space: SearchSpace, parameters: PlannerParameters, clock: Clock = time.monotonic
    ) -> None:
        self._observability = space.observability
        self._parameters = parameters
        self._clock = clock
        self._reach = empty_reach(len(space.graph))
        self._weight: Float64 | None = None
        self._goal: int | None = None

    def looked(self, sight: Sight) -> None:
        """See Policy; nothing is remembered: it looked from wherever it has been, also to no effect."""

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy; None where every pose with anything in view has been looked from."""
        began = self._clock()
        here, parameters = situation.pose, self._parameters
        place = place_of(situation.graph, self._observability)
        if self._weight is None:
            self._weight = self._weigh(place, situation.start)
        reached = walk_everywhere(place, self._reach, here)
        mass = situation.sight.probability * self._weight
        outlook = outlook_on(place, mass, situation.visited.copy())
        goals = self._goals(outlook, reached)
        if len(goals) == 0:
            return None
        ways = [way_to(self._reach, goal) for goal in goals]
        worth = self._worth(situation.step)
        most = float(outlook.gain.max())

        values = np.full(len(Action), np.nan)
        visits = np.zeros(len(Action), dtype=np.int32)
        best_value, best_goal, best_action = -np.inf, int(goals[0]), 0
        tried = 0
        for goal, way in zip(goals, ways, strict=True):
            imagined = Outlook(outlook.mass.copy(), outlook.gain.copy(), outlook.looked.copy())
            value = worth_of_way(place, imagined, self._reach, way, parameters.recall, worth, most)
            action = int(np.argmax(situation.graph.successors[here] == way[0]))
            values[action] = np.fmax(values[action], value)
            visits[action] += 1
            if value > best_value:
                best_value, best_goal, best_action = value, int(goal), action
            tried += 1
            if self._clock() - began >= parameters.time_budget_s:
                break
        self._goal = best_goal
        in_view = situation.sight.probability[self._observability.seen_by(best_goal)].sum()
        return Choice(
            action=best_action,
            values=values,
            visits=visits,
            simulations=tried,
            reason=f"towards a view of {in_view:.1%} of the belief",
        )

    def _weigh(self, place: Place, start: int) -> Float64:
        """float64 [k]: what finding each candidate is worth, before the steps that it takes."""
        if self._parameters.worth == "discount":
            return np.ones(self._observability.candidates)
        reached = walk_everywhere(place, self._reach, start)
        steps = first_sight_distance(place, self._reach, reached)
        return np.where(np.isfinite(steps), np.maximum(steps, 1.0), 1.0)  # a closed way may cut off the start

    def _worth(self, step: int) -> Float64:
        ahead = np.arange(self._parameters.lookahead_steps + 1)
        if self._parameters.worth == "discount":
            return np.asarray(self._parameters.discount**ahead, dtype=np.float64)
        return 1.0 / np.maximum(step + ahead, 1.0)

    def _goals(self, outlook: Outlook, reached: int) -> list[int]:
        """The viewpoints to think through: the most gain per step, and that of the last decision."""
        poses = self._reach.queue[1:reached]
        gain = np.where(outlook.looked[poses], 0.0, outlook.gain[poses])
        ratio = gain / self._reach.distance[poses]
        count = min(self._parameters.goals, int(np.count_nonzero(ratio > 0.0)))
        order = np.argsort(-ratio, kind="stable")[:count]
        goals = [int(pose) for pose in poses[order]]
        kept = self._goal
        if kept is not None and kept not in goals and kept in poses and not outlook.looked[kept]:
            goals.append(kept)
        return goals

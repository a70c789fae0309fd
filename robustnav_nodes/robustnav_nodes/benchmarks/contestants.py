"""The planners that `robustnav bench search` compares: the rules, the thesis' four, and ours."""

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.planner.parameters import PlannerParameters

DEFAULT = PlannerParameters().variant
NO_TIME_LIMIT_S = 60.0  # a decision is made of simulations alone: the same on a slow machine

# C2: outside a detection the thesis' factor is 0, for ever; ours is this small.
THESIS_BELIEF = BeliefParameters(evidence="f1", detection_floor=1e-3)
# The thesis' planner does not look again where it docks.
THESIS_DOCKING: dict[str, Any] = {"confirm_at_dock": False}
# All dock at the nearest pose, as the thesis has it: this is the least that the parameter takes.
NEAREST_M = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Contestant:
    """A planner with its parameters and those of the belief that it plans on; `meaning`: in one line."""

    name: str
    meaning: str
    planner: PlannerParameters
    belief: BeliefParameters

    def planner_for(self, statistics: ClassStatistics) -> PlannerParameters:
        """Its parameters where the detector has these statistics: Lookahead plans with the recall."""
        recall = min(max(statistics.recall, self.belief.recall_min), self.belief.recall_max)
        return dataclasses.replace(self.planner, recall=recall)

    def settings(self) -> dict[str, Any]:
        """What differs from the defaults."""
        return {
            "meaning": self.meaning,
            "planner": _changed(self.planner),
            "belief": _changed(self.belief),
        }


def _of_the_thesis(name: str, meaning: str, **planner: Any) -> Contestant:
    parameters = PlannerParameters(**{"variant": name, **THESIS_DOCKING, **planner})
    return Contestant(name=name, meaning=meaning, planner=parameters, belief=THESIS_BELIEF)


def _of_ours(name: str, meaning: str, **planner: Any) -> Contestant:
    parameters = PlannerParameters(**{"variant": name, **planner})
    return Contestant(name=name, meaning=meaning, planner=parameters, belief=BeliefParameters())


ALL = (
    _of_the_thesis("random", "any action; the thesis' belief ends the search"),
    _of_the_thesis("greedy", "most unseen candidates per step; the thesis' belief ends the search"),
    _of_ours("greedy_gain", "most belief per step; our evidence and ending"),
    _of_the_thesis("pomp", "thesis: POMCP, ends at the first detection"),
    _of_the_thesis("pomp_be", "thesis: POMCP on the candidates not ruled out, ends at the first detection"),
    _of_the_thesis("pomp_pd", "thesis: POMCP, the belief ends the search"),
    _of_the_thesis("pomp_be_pd", "thesis: POMCP on the candidates not ruled out, the belief ends the search"),
    _of_ours("greedy_likelihood", "greedy, with our evidence and ending", variant="greedy", ending="view"),
    dataclasses.replace(
        _of_the_thesis(
            "pomp_be_pd_likelihood",
            "pomp_be_pd, with our evidence and ending",
            variant="pomp_be_pd",
            ending="view",
        ),
        belief=BeliefParameters(),
    ),
    _of_the_thesis(
        "pomp_be_pd_two_views",
        "pomp_be_pd, ends only where two views agree",
        variant="pomp_be_pd",
        views_to_commit=2,
    ),
    _of_ours("pomp_belief", "POMCP on the belief; our evidence and ending"),
    _of_ours("pomp_guided", "POMCP on the belief, rollouts go where it is; our evidence and ending"),
    _of_ours(
        "lookahead_discount",
        "lookahead, a find is worth 0.95 ^ steps",
        variant="lookahead",
        worth="discount",
        discount=0.95,
    ),
    _of_ours("lookahead", "the greedy rule thought through to the end from the best viewpoints"),
)
NAMES = tuple(contestant.name for contestant in ALL)


def contestants(names: Sequence[str], *, dock: bool, simulations: int) -> tuple[Contestant, ...]:
    """Those called `names`, in that order, each with this many simulations a decision and no limit of time.

    Raises BadParameterError for a name that is unknown or comes twice.
    """
    by_name = {contestant.name: contestant for contestant in ALL}
    for name in names:
        if name not in by_name:
            raise BadParameterError(f"there is no planner {name!r} to compare: choose of {', '.join(NAMES)}")
    if len(set(names)) < len(names) or not names:
        raise BadParameterError(f"the planners to compare are {', '.join(names)!r}: name each of them once")
    return tuple(
        dataclasses.replace(
            by_name[name],
            planner=dataclasses.replace(
                by_name[name].planner,
                dock=dock,
                docking_distance_m=NEAREST_M,
                simulations=simulations,
                time_budget_s=NO_TIME_LIMIT_S,
            ),
        )
        for name in names
    )


def _changed(parameters: PlannerParameters | BeliefParameters) -> dict[str, Any]:
    default = type(parameters)()
    values = {field.name: getattr(parameters, field.name) for field in dataclasses.fields(parameters)}
    return {name: value for name, value in values.items() if value != getattr(default, name)}

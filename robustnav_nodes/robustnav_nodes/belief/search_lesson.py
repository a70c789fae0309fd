"""What one search teaches about the detector: by what the dock showed, or by what the person says."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes.belief.online_statistics import NEAR, CountedLook, OnlineStatistics
from robustnav_nodes.search_space.candidates import Candidates

_UNDER_WAY = (SearchPhase.SEARCHING, SearchPhase.DOCKING)


@dataclass(slots=True)
class _Episode:
    """One search for the target, as the planner counts them. `found`: where it ended, if it found."""

    number: int
    looks: list[CountedLook] = field(default_factory=list)
    dock: int | None = None
    refuted_docks: list[int] = field(default_factory=list)
    found: int | None = None
    ended: bool = False


class SearchLesson:
    """Gathers the looks of a search for `label`, and draws the lesson once where the target is, or is not.

    The robot goes up to what it takes for the target and looks once more. Where it then ends the search
    (FOUND) with the target detected in that last look, the find counts as confirmed; where it goes on
    instead, what it had fired there counts as false. What the person says about the find replaces both. A
    search that ends without docking teaches only by the person.

    `before` is what is believed of the detector when the search begins. `hear` and `hear_person` return what
    is believed from then on, or None where nothing was learnt.
    """

    def __init__(self, label: str, before: OnlineStatistics, candidates: Candidates) -> None:
        self.label = label
        self._before = self._after = before
        self._candidates = candidates
        self._episode: _Episode | None = None
        self._early: list[CountedLook] = []  # before the planner's first word about the search

    def look(self, look: CountedLook) -> None:
        """A look that counted."""
        episode = self._episode
        if episode is None or episode.ended:
            self._early.append(look)
        else:
            episode.looks.append(look)

    def move_to(self, candidates: Candidates) -> None:
        """The map changed: looks and places counted by the old candidates are forgotten."""
        self._candidates = candidates
        self._early.clear()
        if self._episode is not None and not self._episode.ended:
            self._episode = _Episode(number=self._episode.number)

    def hear(self, state: SearchState) -> OnlineStatistics | None:
        """How the search stands."""
        if state.target != self.label:
            return None
        if state.phase in _UNDER_WAY and (self._episode is None or self._episode.number != state.episode):
            self._episode = _Episode(number=state.episode, looks=self._early)
            self._before, self._early = self._after, []
        episode = self._episode
        if episode is None or episode.ended or episode.number != state.episode:
            return None
        if state.phase is SearchPhase.DOCKING:
            episode.dock = self._nearest(state)
        elif state.phase is SearchPhase.SEARCHING and episode.dock is not None:
            episode.refuted_docks.append(episode.dock)
            episode.dock = None
        elif state.phase not in _UNDER_WAY:
            return self._ended(episode, state)
        return None

    def hear_person(self, *, confirmed: bool) -> OnlineStatistics | None:
        """The person has seen what was found, and says whether it is the target."""
        episode = self._episode
        if episode is None or episode.found is None:
            return None
        if confirmed:
            return self._learn(self._before.confirmed(episode.looks, episode.found))
        return self._learn(self._refuted(episode, [*episode.refuted_docks, episode.found]))

    def _ended(self, episode: _Episode, state: SearchState) -> OnlineStatistics | None:
        episode.ended = True
        if state.phase is not SearchPhase.FOUND:
            return self._learn(self._refuted(episode, episode.refuted_docks))
        episode.found = self._nearest(state)
        at_dock = episode.dock is not None and bool(episode.looks)
        if at_dock and _detected(episode.looks[-1], episode.found):
            return self._learn(self._before.confirmed(episode.looks, episode.found))
        return None

    def _refuted(self, episode: _Episode, places: Iterable[int]) -> OnlineStatistics:
        after = self._before
        for place in sorted(set(places)):
            after = after.refuted(episode.looks, place)
        return after

    def _learn(self, after: OnlineStatistics) -> OnlineStatistics | None:
        if after == self._after:
            return None
        self._after = after
        return after

    def _nearest(self, state: SearchState) -> int:
        away_m = np.hypot(self._candidates.x_m - state.best_x_m, self._candidates.y_m - state.best_y_m)
        return int(np.argmin(away_m))


def _detected(look: CountedLook, place: int) -> bool:
    hits = look.densities[:, place] >= NEAR
    return bool(look.in_view[place] and hits.any())

"""When each search of a bag began and ended, and how long what was said belongs to it."""

from dataclasses import dataclass

from bags.reader import Bag
from bags.recorded_values import recorded_values
from robustnav_msgs_py.records import SearchPhase

ACTIVE = (SearchPhase.SEARCHING, SearchPhase.DOCKING)
STATE = "search/state"


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeSpan:
    """One search of the robot in `namespace`, in log times.

    What is said from `from_ns`, the end of the search before, until before `until_ns`, the begin of the next,
    is about this one; None where there is none before or after.
    """

    namespace: str
    episode: int
    from_ns: int | None
    until_ns: int | None

    def holds(self, log_time_ns: int) -> bool:
        """Whether what was said at `log_time_ns` is about this search."""
        early = self.from_ns is not None and log_time_ns <= self.from_ns
        late = self.until_ns is not None and log_time_ns >= self.until_ns
        return not early and not late


def robots(bag: Bag) -> tuple[str, ...]:
    """Namespaces of the robots that told how their search stands, "" for none."""
    suffix = f"/{STATE}"
    return tuple(sorted({row.name.removesuffix(suffix) for row in bag.topics if row.name.endswith(suffix)}))


def episode_spans(bag: Bag, namespace: str = "") -> tuple[EpisodeSpan, ...]:
    """The searches that the robot in `namespace` began, in their order; none where it told of none."""
    bounds: dict[int, tuple[int, int]] = {}
    for heard in recorded_values(bag, [STATE], namespace=namespace):
        state, now_ns = heard.value, heard.log_time_ns
        if state.episode in bounds:
            begin_ns, end_ns = bounds[state.episode]
            bounds[state.episode] = (begin_ns, now_ns if state.phase in ACTIVE else min(end_ns, now_ns))
        elif state.phase in ACTIVE:
            bounds[state.episode] = (now_ns, 2**63 - 1)
    spans, numbers = [], sorted(bounds, key=lambda number: bounds[number][0])
    for place, number in enumerate(numbers):
        first, last = place == 0, place == len(numbers) - 1
        spans.append(
            EpisodeSpan(
                namespace=namespace,
                episode=number,
                from_ns=None if first else bounds[numbers[place - 1]][1],
                until_ns=None if last else bounds[numbers[place + 1]][0],
            )
        )
    return tuple(spans)

"""When each search of a bag began and ended, and how long what was said belongs to it."""

from dataclasses import dataclass

from bags.reader import Bag
from bags.recorded_values import recorded_values
from robustnav_msgs_py.records import SearchPhase

ACTIVE = (SearchPhase.SEARCHING, SearchPhase.DOCKING)
STATE = "search/state"
NEVER_NS = 2**63 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeSpan:
    """One search of the robot in `namespace`, in log times.

    It ended at `end_ns` (None: not before the bag did). What is said after `from_ns`, the end of the search
    before, and before `until_ns`, the begin of the next, is about this one; None where there is no other.
    """

    namespace: str
    episode: int
    end_ns: int | None
    from_ns: int | None
    until_ns: int | None

    def holds(self, log_time_ns: int) -> bool:
        """Whether what was said at `log_time_ns` is about this search."""
        early = self.from_ns is not None and log_time_ns <= self.from_ns
        late = self.until_ns is not None and log_time_ns >= self.until_ns
        return not early and not late

    def led_here(self, log_time_ns: int) -> bool:
        """Whether what was said at `log_time_ns` was on the way to the end of this search."""
        return self.holds(log_time_ns) and (self.end_ns is None or log_time_ns <= self.end_ns)


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
            bounds[state.episode] = (begin_ns, NEVER_NS if state.phase in ACTIVE else min(end_ns, now_ns))
        elif state.phase in ACTIVE:
            bounds[state.episode] = (now_ns, NEVER_NS)
    spans, numbers = [], sorted(bounds, key=lambda number: bounds[number][0])
    for place, number in enumerate(numbers):
        first, last = place == 0, place == len(numbers) - 1
        end_ns = bounds[number][1]
        spans.append(
            EpisodeSpan(
                namespace=namespace,
                episode=number,
                end_ns=None if end_ns == NEVER_NS else end_ns,
                from_ns=None if first else bounds[numbers[place - 1]][1],
                until_ns=None if last else bounds[numbers[place + 1]][0],
            )
        )
    return tuple(spans)

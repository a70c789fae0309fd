"""What came of a replay, for people: a line for each topic, and the first thing that is not as recorded."""

import re
from collections.abc import Iterator

from rich.console import Group
from rich.table import Table
from rich.text import Text

from bags.replay import Difference, Replay

NS_PER_S = 1_000_000_000
MOST_FIELDS = 12
# Records travel as DiagnosticStatus: the key says it all.
_OF_RECORD = re.compile(r"values\[(?P<key>\w+)\]\.value")


def render(replay: Replay, begin_ns: int) -> Group:
    """The table, and the verdict under it; `begin_ns` is the log time that counts as zero."""
    table = Table("topic", "recorded", "said now", "the same", "but for stamps")
    for topic in replay.topics:
        stamps = str(topic.same_but_stamps) if topic.same_but_stamps else ""
        style = "" if topic.first is None else "bold red"
        counts = (topic.recorded, topic.replayed, topic.same)
        table.add_row(Text(topic.topic, style), *(str(count) for count in counts), stamps)
    heading = Text(f"{replay.inputs} recorded messages through {', '.join(replay.nodes)}")
    verdict = Text("the same, message by message", "bold green")
    if replay.first is not None:
        told = [replay.first]
        decision = replay.first_decision
        if decision is not None and decision is not replay.first:
            told.append(decision)
        verdict = Text("\n".join(line for one in told for line in first_difference(one, begin_ns)))
    return Group(heading, table, verdict)


def first_difference(first: Difference, begin_ns: int) -> Iterator[str]:
    """Lines that name the first message that is not as recorded, and what differs in it."""
    when = f"{(first.time_ns - begin_ns) / NS_PER_S:.3f} s into the bag"
    yield f"first difference: message {first.number + 1} of {first.topic}, {when}, {first.what}"
    for difference in first.fields[:MOST_FIELDS]:
        field = _OF_RECORD.sub(r"\g<key>", difference.field)
        yield f"  {field}: {difference.first} was recorded, {difference.second} is said now"
    if len(first.fields) > MOST_FIELDS:
        yield f"  and {len(first.fields) - MOST_FIELDS} more fields"

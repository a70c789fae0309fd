"""The dialogue node: a line in, an answer and a target out, whatever the line holds."""

from typing import Any

import pytest

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.records import DialogueState, SearchPhase, SearchState
from robustnav_nodes.dialogue.node import Dialogue
from tests.bench import Bench


class Talk:
    """A person in front of the node."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.node: Dialogue = bench.add(Dialogue())
        self.node.trigger_configure()
        self.node.trigger_activate()
        self.answers = bench.hear("chat/to_user")
        self.targets = bench.hear("search/target")
        self.states = bench.hear("dialogue/state")
        self.search = bench.speaker("search/state")
        self.lines = bench.speaker("chat/from_user")
        labels = bench.speaker("detections/labels")
        labels.publish(wire.labels_to_message(("mug", "book")))
        bench.wait(lambda: "detections/labels" not in self.node._waiting_for, "the labels")

    def say(self, line: str) -> str:
        """Say a line, return the answer."""
        before = len(self.answers)
        self.lines.publish(wire.text_to_message(line))
        self.bench.wait(lambda: len(self.answers) > before, f"an answer to {line[:40]!r}")
        return str(self.answers[-1].data)


@pytest.fixture
def talk(bench: Bench) -> Talk:
    return Talk(bench)


def test_find_stop_and_the_end_of_a_search(talk: Talk) -> None:
    assert talk.say("find the mug") == "I am looking for the mug."
    talk.bench.wait(lambda: talk.targets and talk.targets[-1].data == "mug", "the target")
    talk.search.publish(wire.record_to_message(SearchState(phase=SearchPhase.FOUND, target="mug", episode=1)))
    talk.bench.wait(lambda: talk.answers[-1].data.startswith("I found the mug"), "the news")
    talk.bench.wait(lambda: talk.targets[-1].data == "", "the empty target")
    assert talk.say("stop") == "I have stopped."
    state: Any = wire.record_from_message(talk.states[-1], DialogueState)
    assert (state.target, state.lines_heard, state.last_heard) == ("", 2, "stop")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("find the unicorn", "'unicorn'"),
        ("", "no words"),
        ("x" * 1_000_000, "1,000,000 characters"),
        ("\x01\x02\x03\x04", "no words"),
        ("找到杯子", "did not understand"),
        ("{'target': 'mug'}; __import__('os')", "looking for the mug"),
    ],
)
def test_odd_lines_get_an_answer_and_the_next_line_is_heard(talk: Talk, line: str, words: str) -> None:
    assert words in talk.say(line)
    assert talk.say("where are you?").startswith("I do not know where I am")

"""The demo's last sentence claims no more than the robot said and the bag shows."""

import pytest
from rich.text import Text

from bags.demo_summary import verdict
from bags.metrics import SearchMetrics
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes.graph.demo import DemoEnd


def end_of(phase: SearchPhase, *, timed_out: bool = False, message: str = "") -> DemoEnd:
    return DemoEnd(
        search=SearchState(phase=phase, target="mug", message=message),
        timed_out=timed_out,
        interrupted=False,
        wall_s=1.0,
        restarts=0,
    )


def metrics_of(*, found: bool | None, success: bool | None) -> SearchMetrics:
    return SearchMetrics(
        target="mug",
        episode=1,
        phase=None,
        found=found,
        success=success,
        steps=None,
        path_length_m=None,
        shortest_path_m=None,
        spl=None,
        false_alarms=None,
        wall_duration_s=None,
        sim_duration_s=None,
    )


@pytest.mark.parametrize(
    ("found", "success", "end", "told"),
    [
        (True, True, end_of(SearchPhase.FOUND), "found the mug, and it is really there"),
        (
            True,
            False,
            end_of(SearchPhase.FOUND),
            "mistaken: the robot says it found the mug, but it is not there",
        ),
        (
            True,
            None,
            end_of(SearchPhase.FOUND),
            "found the mug, the robot says; the bag does not tell where it",
        ),
        (False, False, end_of(SearchPhase.FOUND), "found the mug, the robot says; the bag ends before that"),
        (None, None, end_of(SearchPhase.FOUND), "found the mug, the robot says; the bag ends before that"),
        (False, False, end_of(SearchPhase.SEARCHING, timed_out=True), "not found: the time was over"),
        (
            False,
            False,
            end_of(SearchPhase.NOT_FOUND, message="no step is left"),
            "not found: no step is left",
        ),
        (None, None, end_of(SearchPhase.SEARCHING), "not found: interrupted"),
        (False, False, end_of(SearchPhase.STOPPED, message="by [/bold] you"), "not found: by [/bold] you"),
    ],
)
def test_verdict(found: bool | None, success: bool | None, end: DemoEnd, told: str) -> None:
    assert Text.from_markup(verdict(metrics_of(found=found, success=success), end)).plain.startswith(told)

"""Simulated time follows wall time and never tries to catch up a long stall."""

import pytest

from sim_bridge.pace import Pace


def run(pace: Pace, times_s: list[float], factor: float) -> int:
    made = 0
    for now_s in times_s:
        for _ in range(pace.due(now_s, factor)):
            pace.done()
            made += 1
    return made


@pytest.mark.parametrize("factor", [0.5, 1.0, 3.0])
def test_steps_follow_wall_time(factor: float) -> None:
    times_s = [at * 0.005 for at in range(2001)]
    assert run(Pace(0.02, 0.2), times_s, factor) == pytest.approx(10.0 / 0.02 * factor, abs=1)


def test_a_timer_of_one_period_makes_one_step_each_time() -> None:
    pace = Pace(0.02, 0.2)
    pace.due(1.0, 1.0)
    for tick in range(1, 5000):
        assert run(pace, [(1_000_000_000 + tick * 20_000_000) / 1e9], 1.0) == 1


def test_a_stall_is_not_made_up_for() -> None:
    pace = Pace(0.02, 0.2)
    assert run(pace, [0.0, 0.02], 1.0) == 1
    assert run(pace, [60.0], 1.0) == 10
    assert run(pace, [60.02], 1.0) == 1


def test_a_pause_owes_nothing() -> None:
    pace = Pace(0.02, 0.2)
    assert run(pace, [0.0, 0.04], 1.0) == 2
    pace.restart()
    assert run(pace, [100.0], 1.0) == 0
    assert run(pace, [100.04], 1.0) == 2

"""Late frames come in order, once, and none before its time."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadParameterError
from sim_bridge.sensors.frame_delay import FrameDelay, FrameDropper

MS = 1_000_000


@pytest.mark.parametrize("seed", range(100))
def test_every_frame_arrives_once_in_order_and_in_time(seed: int) -> None:
    rng = np.random.default_rng(seed)
    delay_s, jitter_s = float(rng.uniform(0.0, 0.3)), float(rng.uniform(0.0, 0.5))
    line: FrameDelay[int] = FrameDelay(delay_s, jitter_s, seed)
    got: list[int] = []
    stamps = []
    for step in range(200):
        now_ns = step * 20 * MS
        if step % 5 == 0 and step < 150:
            line.add(len(stamps), len(stamps), now_ns)
            stamps.append(now_ns)
        for frame in line.due(now_ns):
            assert now_ns - stamps[frame] >= (delay_s - 1e-9) * 1e9
            # A step late at most. Frames before it were sent earlier, so waiting for them takes no longer.
            assert now_ns - stamps[frame] <= (delay_s + jitter_s + 1e-9) * 1e9 + 20 * MS
            got.append(frame)
    assert got == list(range(30))
    assert len(line) == line.lost == 0


def test_without_delay_a_frame_arrives_at_once() -> None:
    line: FrameDelay[str] = FrameDelay(0.0, 0.0, seed=1)
    line.add("first", 0, 5)
    assert line.due(4) == []
    assert line.due(5) == ["first"]
    assert line.due(6) == []


def test_jitter_belongs_to_the_frame_and_spreads_over_its_range() -> None:
    def arrival_ms(number: int) -> int:
        line: FrameDelay[int] = FrameDelay(0.1, 0.2, seed=3)
        line.add(number, number, 0)
        return next(ms for ms in range(400) if line.due(ms * MS))

    arrivals = [arrival_ms(number) for number in range(100)]
    assert arrivals == [arrival_ms(number) for number in range(100)]
    assert 100 <= min(arrivals) < 120
    assert 280 < max(arrivals) <= 300
    assert np.mean(arrivals) == pytest.approx(200.0, abs=20.0)


def test_a_full_line_loses_its_oldest_and_counts_them() -> None:
    line: FrameDelay[int] = FrameDelay(10.0, 0.0, seed=1, most=3)
    for number in range(5):
        line.add(number, number, number)
    assert line.lost == 2
    assert line.due(20_000 * MS) == [2, 3, 4]


def test_a_reset_forgets_what_is_under_way() -> None:
    line: FrameDelay[int] = FrameDelay(1.0, 0.0, seed=1, most=1)
    line.add(0, 0, 0)
    line.add(1, 1, 5_000 * MS)
    line.reset()
    assert len(line) == line.lost == 0
    line.add(2, 2, 0)
    assert line.due(1_000 * MS) == [2]


@pytest.mark.parametrize("p_drop", [0.0, 0.1, 0.5, 1.0])
def test_frames_are_dropped_with_the_asked_for_probability(p_drop: float) -> None:
    dropper = FrameDropper(p_drop, seed=4)
    drops = [dropper.drops(frame) for frame in range(3000)]
    assert np.mean(drops) == pytest.approx(p_drop, abs=0.03)
    assert [dropper.drops(frame) for frame in reversed(range(100))] == drops[99::-1]


@pytest.mark.parametrize(("delay_s", "jitter_s"), [(-0.1, 0.0), (0.0, -0.1), (np.nan, 0.0), (0.0, np.inf)])
def test_times_that_cannot_be_are_refused(delay_s: float, jitter_s: float) -> None:
    with pytest.raises(BadParameterError, match="late by"):
        FrameDelay(delay_s, jitter_s, seed=1)


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(BadParameterError, match=r"0\.\.1"):
        FrameDropper(1.1, seed=1)
    with pytest.raises(BadParameterError, match="loses all"):
        FrameDelay(0.0, 0.0, seed=1, most=0)

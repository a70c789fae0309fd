"""Rate and latency by hand."""

import pytest

from robustnav_nodes.detection.pace import KEEP, Pace


def test_nothing_is_told_before_the_first_image_and_no_rate_before_the_second() -> None:
    pace = Pace()
    assert pace.figures() == {}
    pace.add(1.0, 1.1)
    assert pace.figures() == pytest.approx({"latency ms, median": 100.0, "latency ms, 95 %": 100.0})


def test_rate_and_latency_are_those_of_the_last_images() -> None:
    pace = Pace()
    pace.add(-1000.0, 0.0)  # long ago: forgotten
    for number in range(1, KEEP + 1):
        pace.add(number * 0.5 - 0.02 - 0.1 * (number == KEEP), number * 0.5)
    found = pace.figures()
    assert found["images a second"] == pytest.approx(2.0)
    assert found["latency ms, median"] == pytest.approx(20.0)

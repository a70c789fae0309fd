from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bags.definitions import message_definition
from bags.manifest import Manifest
from bags.reader import open_bag
from bags.recorded_values import CONVERSIONS, namespace_of, recorded_values
from bags.writer import BagWriter
from robustnav_msgs_py import contract
from robustnav_msgs_py.errors import BadFileError, BadMessageError
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import OccupancyMap


def test_every_converted_topic_is_in_the_contract() -> None:
    assert set(CONVERSIONS) <= {row.name for row in contract.TOPICS}


def test_values_are_those_that_were_said(search_bag: Callable[..., Path], flat_map: OccupancyMap) -> None:
    with open_bag(search_bag()) as bag:
        values = list(recorded_values(bag, ["map", "search/state", "detections/labels"]))
    assert [value.log_time_ns for value in values] == sorted(value.log_time_ns for value in values)
    (told,) = [value.value for value in values if value.topic == "map"]
    assert np.array_equal(told.cells, flat_map.cells)
    assert told.resolution_m == flat_map.resolution_m
    phases = [value.value.phase for value in values if value.topic == "search/state"]
    assert phases[0] == SearchPhase.SEARCHING
    assert phases[-1] == SearchPhase.FOUND


def test_a_robot_in_a_namespace_is_found(search_bag: Callable[..., Path]) -> None:
    with open_bag(search_bag(namespace="/robot1")) as bag:
        assert namespace_of(bag, "search/state") == "/robot1"
        assert list(recorded_values(bag, ["search/state"])) == []
        assert len(list(recorded_values(bag, ["search/target"], namespace="robot1"))) == 1


def test_one_of_several_robots_must_be_chosen(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "two", manifest=manifest) as writer:
        for robot in ("a", "b"):
            writer.add_topic(f"/{robot}/odom", message_definition("nav_msgs/msg/Odometry", ()))
    with (
        open_bag(tmp_path / "two") as bag,
        pytest.raises(BadFileError, match=r"several robots; choose one of /a, /b"),
    ):
        namespace_of(bag, "odom")


def test_a_bad_message_is_refused_with_topic_and_time(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "bad", manifest=manifest) as writer:
        channel = writer.add_topic(
            "/search/state", message_definition("diagnostic_msgs/msg/DiagnosticStatus", ())
        )
        data = b"\0\1\0\0" + bytes(4) + 3 * b"\1\0\0\0\0\0\0\0" + bytes(4)
        writer.write(channel, log_time_ns=1_500_000_000, publish_time_ns=0, data=data)
    with (
        open_bag(tmp_path / "bad") as bag,
        pytest.raises(BadMessageError, match=r"/search/state at 1\.500 s: a status is named ''"),
    ):
        list(recorded_values(bag, ["search/state"]))


def test_a_topic_of_another_type_is_passed_over(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "other", manifest=manifest) as writer:
        channel = writer.add_topic("/map", message_definition("std_msgs/msg/UInt8", ()))
        writer.write(channel, log_time_ns=1, publish_time_ns=1, data=b"\0\1\0\0\7")
    with open_bag(tmp_path / "other") as bag:
        assert list(recorded_values(bag, ["map"])) == []

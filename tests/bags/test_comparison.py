"""Two messages differ where their fields do; stamps and wall time can be left out."""

import array
import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseStamped, Twist
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import OccupancyGrid, Path
from sensor_msgs.msg import LaserScan, PointCloud2
from std_msgs.msg import String

from bags.comparison import LEAST, LONGEST_TEXT, ROUNDING, WALL_TIME_KEYS, FieldDifference, differences
from robustnav_msgs_py.conversions import belief_to_message
from robustnav_msgs_py.values import BeliefCloud

any_float = st.floats(allow_nan=True, allow_infinity=True)


def pose(x_m: float, stamp_s: int = 0) -> PoseStamped:
    made = PoseStamped()
    made.header.stamp.sec = stamp_s
    made.pose.position.x = x_m
    return made


def record(**values: str) -> DiagnosticStatus:
    return DiagnosticStatus(values=[KeyValue(key=key, value=value) for key, value in values.items()])


@given(any_float, any_float)
def test_numbers_differ_by_more_than_rounding_and_nan_is_nan(one: float, other: float) -> None:
    same = math.isclose(one, other, rel_tol=ROUNDING, abs_tol=LEAST) or (one != one and other != other)
    first, second = Twist(), Twist()
    first.linear.x, second.linear.x = one, other
    assert (not list(differences(first, second))) == same
    assert not list(differences(first, first))


def test_another_processor_may_round_otherwise_in_numbers_and_in_records() -> None:
    assert not list(differences(pose(0.1 + 0.2), pose(0.3)))
    assert not list(differences(record(value="[0.30000000000000004, NaN]"), record(value="[0.3, NaN]")))
    (found,) = differences(record(value="0.30001 of 7"), record(value="0.3 of 7"))
    assert found.field == "values[value].value"
    assert list(differences(record(value="0.3 of 7"), record(value="0.3 of 8")))


def test_a_field_is_named_with_what_each_holds() -> None:
    (found,) = differences(pose(1.0), pose(2.5))
    assert found == FieldDifference(field="pose.position.x", first="1.0", second="2.5")


def test_stamps_count_only_where_they_are_asked_for() -> None:
    assert [found.field for found in differences(pose(1.0, 3), pose(1.0, 4))] == ["header.stamp.sec"]
    assert not list(differences(pose(1.0, 3), pose(1.0, 4), with_stamps=False))
    fields = [found.field for found in differences(pose(1.0, 3), pose(2.0, 4), with_stamps=False)]
    assert fields == ["pose.position.x"]


def test_stamps_within_lists_are_left_out_too() -> None:
    first, second = Path(poses=[pose(1.0, 3)]), Path(poses=[pose(1.0, 4)])
    assert [found.field for found in differences(first, second)] == ["poses[0].header.stamp.sec"]
    assert not list(differences(first, second, with_stamps=False))


def test_lists_of_different_lengths_are_told_and_compared_as_far_as_both_go() -> None:
    first, second = Path(poses=[pose(1.0), pose(2.0)]), Path(poses=[pose(1.5)])
    assert list(differences(first, second)) == [
        FieldDifference(field="length of poses", first="2", second="1"),
        FieldDifference(field="poses[0].pose.position.x", first="1.0", second="1.5"),
    ]


@pytest.mark.parametrize("empty_first", [True, False])
def test_an_empty_list_differs_from_a_full_one(empty_first: bool) -> None:
    first, second = Path(), Path(poses=[pose(1.0)])
    pair = (first, second) if empty_first else (second, first)
    assert len(list(differences(*pair))) == 1


def test_numbers_in_arrays_are_told_by_their_place() -> None:
    first = LaserScan(ranges=array.array("f", [1.0, 2.0, 3.0, float("nan")]))
    second = LaserScan(ranges=array.array("f", [1.0, 2.0, 3.5, float("nan")]))
    assert not list(differences(first, first))
    (found,) = differences(first, second)
    assert found.field == "ranges"
    assert (found.first, found.second) == ("3.0 at 2 of 4", "3.5 at 2 of 4")
    shorter = LaserScan(ranges=array.array("f", [1.0]))
    (found,) = differences(first, shorter)
    assert (found.first, found.second) == ("4 values", "1 values")


def test_maps_differ_by_their_cells() -> None:
    cells = np.zeros(12, dtype=np.int8)
    first = OccupancyGrid(data=array.array("b", cells.tobytes()))
    cells[7] = 100
    second = OccupancyGrid(data=array.array("b", cells.tobytes()))
    (found,) = differences(first, second)
    assert (found.first, found.second) == ("0 at 7 of 12", "100 at 7 of 12")


def belief(*probabilities: float) -> PointCloud2:
    places_m = np.zeros((len(probabilities), 3), dtype=np.float32)
    cloud = BeliefCloud(position_m=places_m, probability=np.array(probabilities), stamp_ns=0)
    return belief_to_message(cloud)


def test_clouds_differ_by_the_fields_of_their_points_and_by_more_than_rounding() -> None:
    first = belief(0.1 + 0.2, 0.7, 2e-9)
    assert not list(differences(first, belief(0.3, 0.7, 2e-9)))
    assert list(differences(first, belief(0.3, 0.7, 3e-9))) == [
        FieldDifference(field="data.probability", first="2e-09 at 2 of 3", second="3e-09 at 2 of 3")
    ]


def test_clouds_of_other_layouts_and_with_too_little_data_differ() -> None:
    first, other = belief(0.5, 0.5), belief(0.5, 0.5)
    other.fields[3].offset = 0
    assert [found.field for found in differences(first, other)] == ["fields[3].offset"]
    short = belief(0.5, 0.5)
    short.data = short.data[:-1]
    assert [found.field for found in differences(first, short)] == ["data"]
    assert not list(differences(short, short))


def test_what_took_how_long_is_no_difference() -> None:
    key = WALL_TIME_KEYS[0]
    assert not list(differences(record(**{key: "3", "step": "1"}), record(**{key: "5", "step": "1"})))
    (found,) = differences(record(**{key: "3", "step": "1"}), record(**{key: "5", "step": "2"}))
    assert found == FieldDifference(field="values[step].value", first="'1'", second="'2'")
    # Another key in its place is one.
    assert list(differences(record(**{key: "3"}), record(other="3")))


def test_long_texts_are_shortened() -> None:
    (found,) = differences(String(data="a" * 500), String(data="b"))
    assert len(found.first) == LONGEST_TEXT
    assert found.first.endswith("…")
    assert found.second == "'b'"

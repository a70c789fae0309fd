"""The belief node: bad maps and clouds give a sentence, good ones a belief; nothing ends the node."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.records import DetectorRecord, SearchPhase, SearchState
from robustnav_msgs_py.values import BeliefCloud, Detections, OccupancyMap, Odometry, Pose2D
from robustnav_nodes.belief.learnt_statistics import read_observed
from robustnav_nodes.belief.node import Belief
from tests.bench import Bench

S = 1_000_000_000


def room(cells: int = 60) -> OccupancyMap:
    """3 m x 3 m of floor, walls around it, at 0.05 m."""
    grid = np.zeros((cells, cells), np.int8)
    grid[0], grid[-1], grid[:, 0], grid[:, -1] = 100, 100, 100, 100
    return OccupancyMap(cells=grid, resolution_m=0.05, origin=Pose2D(x_m=0.0, y_m=0.0))


def table_in(floor: OccupancyMap) -> tuple[OccupancyMap, OccupancyMap]:
    """The floor with a table on it, and the mask that says so."""
    cells, mask = floor.cells.copy(), np.zeros_like(floor.cells)
    cells[30:42, 40:52], mask[30:42, 40:52] = 100, 100
    made = [
        OccupancyMap(cells=grid, resolution_m=floor.resolution_m, origin=floor.origin)
        for grid in (cells, mask)
    ]
    return made[0], made[1]


def nothing_detected(stamp_ns: int) -> Detections:
    empty = np.zeros(0, np.float32)
    return Detections(
        position_m=empty.reshape(0, 3),
        score=empty,
        label=np.zeros(0, np.uint32),
        box_px=empty.reshape(0, 4),
        stamp_ns=stamp_ns,
    )


@pytest.fixture
def node(bench: Bench) -> Belief:
    made = bench.add(Belief())
    made.trigger_configure()
    made.trigger_activate()
    return made


def problem(node: Belief, words: str) -> Callable[[], bool]:
    return lambda: any(words in value for value in node.health.status("n", []).values.values())


def of_unknown_cells(message: Any) -> None:
    message.data = b"\xff" * len(message.data)


def of_no_size(message: Any) -> None:
    message.info.width, message.info.height, message.data = 0, 0, b""


def of_another_size(message: Any) -> None:
    message.info.width = 7


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (of_unknown_cells, "free"),
        (of_no_size, "0 x 0"),
        (of_another_size, "7 x 60"),
    ],
)
def test_a_bad_map_is_a_sentence_and_the_next_good_one_is_used(
    bench: Bench, node: Belief, spoil: Callable[[Any], None], words: str
) -> None:
    maps, masks, targets = (bench.speaker(name) for name in ("map", "search/candidates", "search/target"))
    clouds = bench.hear("belief/cloud")
    floor, mask = table_in(room())
    message = wire.map_to_message(floor)
    spoil(message)
    masks.publish(wire.map_to_message(mask))
    maps.publish(message)
    bench.wait(problem(node, words), f"a problem that says {words!r}")
    targets.publish(wire.text_to_message("mug"))
    masks.publish(wire.map_to_message(mask))
    maps.publish(wire.map_to_message(floor))
    bench.wait(lambda: clouds, "a belief")
    belief = wire.belief_from_message(clouds[-1])
    assert belief.probability.sum() == pytest.approx(1.0)


def test_a_map_of_ten_million_cells_is_used(bench: Bench, node: Belief) -> None:
    _, mask = table_in(room())
    clouds = bench.hear("belief/cloud")
    wide = OccupancyMap(cells=np.zeros((2000, 5000), np.int8), resolution_m=0.05, origin=mask.origin)
    bench.speaker("search/candidates").publish(wire.map_to_message(mask))
    bench.speaker("search/target").publish(wire.text_to_message("mug"))
    bench.speaker("map").publish(wire.map_to_message(wide))
    bench.wait(lambda: clouds, "a belief")


def standing(stamp_ns: int) -> Odometry:
    """Where half of the table is in view."""
    pose = Pose2D(x_m=0.6, y_m=2.2, yaw_rad=0.25)
    return Odometry(pose=pose, linear_m_s=0.0, angular_rad_s=0.0, stamp_ns=stamp_ns)


class Search:
    """A search for a mug in the room, up to a first look at the table that finds nothing."""

    def __init__(self, bench: Bench, node: Belief) -> None:
        self.bench = bench
        self.clouds = bench.hear("belief/cloud")
        names = ("map", "search/candidates", "search/target", "odom", "detections", "detections/labels")
        self.speakers = {name: bench.speaker(name) for name in names}
        self.show(*table_in(room()))
        self.speakers["detections/labels"].publish(wire.labels_to_message(("mug",)))
        self.speakers["search/target"].publish(wire.text_to_message("mug"))
        bench.wait(lambda: self.clouds, "the first belief")
        self.first = self.belief
        self.speakers["odom"].publish(wire.odometry_to_message(standing(5 * S)))
        bench.wait(lambda: node._poses.latest, "the odometry")
        self.speakers["detections"].publish(wire.detections_to_message(nothing_detected(5 * S)))
        bench.wait(lambda: self.belief.stamp_ns == 5 * S, "the belief after the view")

    def show(self, floor: OccupancyMap, mask: OccupancyMap) -> None:
        self.speakers["search/candidates"].publish(wire.map_to_message(mask))
        self.speakers["map"].publish(wire.map_to_message(floor))

    @property
    def belief(self) -> BeliefCloud:
        """The latest that was said."""
        return wire.belief_from_message(self.clouds[-1])


def test_looking_without_success_moves_the_belief(bench: Bench, node: Belief) -> None:
    search = Search(bench, node)
    assert search.first.stamp_ns == 0
    assert np.ptp(search.first.probability) == 0.0
    assert np.ptp(search.belief.probability) > 0.0


def test_a_map_that_grows_keeps_what_is_known(bench: Bench, node: Belief) -> None:
    """The room turns out to be 4 m x 4 m, with a second table; what is known of the first one stays."""
    search = Search(bench, node)
    known = search.belief
    floor, mask = table_in(room(80))
    floor.cells[62:74, 60:72] = mask.cells[62:74, 60:72] = 100
    search.show(floor, mask)
    bench.wait(lambda: len(search.belief.probability) == 2 * len(known.probability), "the larger belief")
    grown = search.belief
    of_first_table = grown.probability[grown.position_m[:, 0] < 2.7]
    np.testing.assert_allclose(of_first_table / of_first_table.sum(), known.probability)
    assert grown.stamp_ns == 5 * S


def test_time_that_begins_anew_forgets_what_was_known(bench: Bench, node: Belief) -> None:
    search = Search(bench, node)
    search.speakers["odom"].publish(wire.odometry_to_message(standing(1 * S)))
    bench.wait(lambda: search.belief.stamp_ns == 0, "a new belief")
    assert np.ptp(search.belief.probability) == 0.0


def test_a_belief_without_a_target_is_an_empty_map(bench: Bench, node: Belief) -> None:
    from nav_msgs.srv import GetMap
    from std_srvs.srv import Trigger

    assert bench.call(GetMap, "belief/get_map", GetMap.Request()).map.info.width == 0
    assert "no target" in bench.call(Trigger, "belief/reset", Trigger.Request()).message


class Finding:
    """A search that docks at the table and finds the mug there, as the belief hears of it."""

    def __init__(self, bench: Bench, node: Belief) -> None:
        self.search = Search(bench, node)
        self.bench = bench
        self.node = node
        self.states = bench.speaker("search/state")
        self.facts = bench.speaker("search/facts")
        self.records = bench.hear("belief/detector")
        bench.wait(lambda: self.records, "what is assumed")

    def tell(self, phase: SearchPhase) -> None:
        place = self.search.first.position_m[np.argmin(self.search.belief.probability)]  # it was in view
        state = SearchState(
            phase=phase, target="mug", episode=1, best_x_m=float(place[0]), best_y_m=float(place[1])
        )
        self.states.publish(wire.record_to_message(state))
        self.bench.wait(lambda: self.node._search.phase is phase, f"the node to hear {phase}")

    @property
    def record(self) -> DetectorRecord:
        return wire.record_from_message(self.records[-1], DetectorRecord)


def test_what_the_person_says_of_a_find_is_learnt_and_kept(bench: Bench, tmp_path: Path) -> None:
    """The one look missed the mug that the person confirms; the next search believes less recall."""
    from rclpy.parameter import Parameter

    path = tmp_path / "learnt.json"
    node = bench.add(Belief(parameter_overrides=[Parameter("online_statistics_file", value=str(path))]))
    node.trigger_configure()
    node.trigger_activate()
    finding = Finding(bench, node)
    assert (finding.record.recall, finding.record.missed) == (finding.record.recall_assumed, 0)
    finding.tell(SearchPhase.SEARCHING)
    finding.tell(SearchPhase.FOUND)
    finding.search.speakers["search/target"].publish(wire.text_to_message(""))
    finding.facts.publish(wire.text_to_message("confirmed mug"))
    bench.wait(lambda: finding.record.missed == 1, "the lesson")
    assert finding.record.recall == pytest.approx(0.6 * 5 / 6)
    assert read_observed(path)["mug"].missed == 1
    assert node._learnt.of("mug").recall == finding.record.recall
    assert "after 1 looks" in node.health.status("n", []).values["detector, mug"]


def test_facts_that_cannot_be_read_are_a_sentence(bench: Bench, node: Belief) -> None:
    bench.speaker("search/facts").publish(wire.text_to_message("it is in the kitchen"))
    bench.wait(problem(node, "it is in the kitchen"), "a problem")

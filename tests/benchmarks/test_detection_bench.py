"""The benchmark of detectors, on few pictures, and what it tells the belief."""

import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from robustnav_msgs_py.detector_statistics import read_detector_statistics
from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.benchmarks.detection_command import detection_command
from robustnav_nodes.benchmarks.detection_scores import NONE
from robustnav_nodes.benchmarks.detection_statistics_file import statistics_content, write_statistics
from robustnav_nodes.benchmarks.detection_tally import ALL, Floors, Tally, TrueObjects
from robustnav_nodes.detection.boxes import Boxes

pytest.importorskip("pybullet")


def boxes(*rows: tuple[float, float, int]) -> Boxes:
    """Unit boxes as (u, score, label)."""
    return Boxes(
        box_px=np.array([(u, 0.0, u + 10.0, 10.0) for u, _, _ in rows], np.float32).reshape(-1, 4),
        score=np.array([score for _, score, _ in rows], np.float32),
        label=np.array([label for _, _, label in rows], np.uint32),
    )


def truth(*rows: tuple[float, int, float, float, float]) -> TrueObjects:
    """Unit boxes as (u, label, distance, visible, pixels)."""
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    return TrueObjects(
        box_px=np.array([(u, 0.0, u + 10.0, 10.0) for u in table[:, 0]], np.float32).reshape(-1, 4),
        label=table[:, 1].astype(np.uint32),
        distance_m=table[:, 2],
        visible=table[:, 3],
        pixels=table[:, 4],
    )


@pytest.fixture
def tally() -> Tally:
    """Two images. Mugs: one right, one missed, a false alarm; a hidden one that is found counts for nothing.
    Books: one right with a low score.
    """
    made = Tally(("mug", "book"), score_min=0.5, floors=Floors(pixels_min=100.0, visible_min=0.5))
    first = truth((0, 0, 1.2, 1.0, 200), (50, 0, 3.2, 0.9, 150), (100, 0, 2.2, 0.4, 200))
    chosen = made.add(first, boxes((0, 0.9, 0), (100, 0.8, 0), (200, 0.6, 0)))
    assert chosen.tolist() == [0, 2, NONE]
    made.add(truth((0, 1, 2.2, 1.0, 400)), boxes((0, 0.4, 1)))
    return made


def test_scores_by_hand(tally: Tally) -> None:
    overall, mug, book = tally.class_scores()
    assert (overall.label, mug.label, book.label) == (ALL, "mug", "book")
    assert (mug.objects, mug.detections, mug.precision, mug.recall, mug.f1) == (2, 2, 0.5, 0.5, 0.5)
    assert (book.objects, book.detections, book.precision, book.recall, book.f1) == (1, 0, None, 0.0, None)
    assert (mug.map50, book.map50, overall.map50) == (0.5, 1.0, 0.75)
    assert (overall.precision, overall.recall) == (0.5, pytest.approx(1 / 3))


def test_recall_by_distance_and_by_visible_part(tally: Tally) -> None:
    by_range = [(share.low, share.objects, share.recall) for share in tally.recall_by_range()]
    assert by_range == [(1.0, 1, 1.0), (2.0, 1, 0.0), (3.0, 1, 0.0)]
    by_part = [(share.low, share.objects, share.recall) for share in tally.recall_by_visible_part()]
    assert by_part == [(0.4, 1, 1.0), (0.8, 3, pytest.approx(1 / 3))]


def test_the_statistics_are_read_by_the_belief(tally: Tally, tmp_path) -> None:
    """Three mugs that one could see, two found; three firings, two right; five looks are borrowed."""
    path = tmp_path / "statistics.json"
    write_statistics(path, tally)
    mug = read_detector_statistics(path).of("mug")
    everything = statistics_content(tally)["unknown_class"]
    assert everything["recall"] == pytest.approx((2 + 2.5) / (4 + 5))
    assert mug.recall == pytest.approx((2 + 5 * everything["recall"]) / (3 + 5), abs=1e-4)
    assert mug.precision == pytest.approx((2 + 5 * everything["precision"]) / (3 + 5), abs=1e-4)
    assert mug.recall_by_range is not None
    near, far = mug.recall_by_range.at(np.array([1.25, 3.25]))
    assert near > mug.recall > far


def run(*arguments: object) -> object:
    app = typer.Typer()
    app.command()(detection_command)
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def test_the_report_is_as_written_down(tmp_path) -> None:
    """BENCHMARKS.md: scripts depend on these names."""
    report, statistics = tmp_path / "report.json", tmp_path / "statistics.json"
    run(
        "--back-end", "truth", "--homes", 2, "--poses", 8, "--degradation", "noise",
        "--json", report, "--statistics", statistics, "--plots", tmp_path,
    )  # fmt: skip
    content = json.loads(report.read_text())
    assert (content["bench"], content["seed"], content["settings"]["homes"]) == ("detection", 500_000, 2)
    overall = content["rows"][0]
    assert (overall["class"], overall["degradation"], overall["images"]) == ("all", "noise", 16)
    keys = {"map50", "precision", "recall", "f1", "instance_top1", "image_ms"}
    assert all(keys <= row.keys() for row in content["rows"])
    assert overall["reliability"]
    assert overall["recall_by_range"]
    assert overall["place_error_m_p90"] < 1.0
    assert read_detector_statistics(statistics).by_class
    assert (tmp_path / "reliability.png").stat().st_size > 1000
    assert (tmp_path / "recall_over_distance.png").stat().st_size > 1000


def test_an_unknown_degradation_is_a_sentence() -> None:
    with pytest.raises(BadParameterError, match="'fog'.*half resolution.*all"):
        run("--back-end", "truth", "--degradation", "fog")

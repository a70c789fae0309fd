"""The planner takes the recall of the target's class from the detector's statistics, where it has them."""

import json
from pathlib import Path
from typing import Any

from robustnav_nodes.planner.node import Planner
from tests.bench import Bench


def planner(bench: Bench, **values: Any) -> Planner:
    from rclpy.parameter import Parameter

    overrides = [Parameter(name, value=value) for name, value in values.items()]
    made: Planner = bench.add(Planner(parameter_overrides=overrides))
    made.trigger_configure()
    return made


def test_the_recall_is_that_of_the_class(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "statistics.json"
    classes = {"mug": {"precision": 0.9, "recall": 0.3}, "pen": {"precision": 0.9, "recall": 0}}
    path.write_text(json.dumps({"classes": classes, "unknown_class": {"precision": 0.5, "recall": 0.4}}))
    node = planner(bench, detector_statistics_file=str(path))
    recalls = [node._parameters_for(target).recall for target in ("mug", "pen", "unicorn")]
    assert recalls == [0.3, 0.01, 0.4]


def test_without_a_file_it_is_the_parameter(bench: Bench) -> None:
    node = planner(bench, recall=0.7)
    assert node._parameters_for("mug") is node.parameters

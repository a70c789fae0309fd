"""The layouts for RViz and Foxglove show topics that there are, as they are published."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from robustnav_msgs_py import contract

CONFIG = Path(__file__).parents[2] / "robustnav_nodes" / "config"
# What people click in the 3D view that no node of ours hears.
OF_OTHERS = {"/clicked_point"}


def test_rviz_shows_topics_of_the_contract_with_their_quality_of_service() -> None:
    content = yaml.safe_load((CONFIG / "robustnav.rviz").read_text(encoding="utf-8"))
    manager = content["Visualization Manager"]
    topics = [display["Topic"] for display in manager["Displays"] if "Topic" in display]
    assert len(topics) >= 10
    for topic in topics:
        row = contract.topic(topic["Value"])
        assert (topic["Durability Policy"] == "Transient Local") == row.qos.latched, row.name
        assert (topic["Reliability Policy"] == "Best Effort") == row.qos.hear_best_effort, row.name
    for tool in manager["Tools"]:
        if "Topic" in tool:
            assert contract.topic(tool["Topic"]["Value"]).listeners


def strings(content: Any) -> Iterator[str]:
    if isinstance(content, dict):
        yield from (key for key in content if key.startswith("/"))
        content = list(content.values())
    if isinstance(content, list):
        for item in content:
            yield from strings(item)
    elif isinstance(content, str) and content.startswith("/"):
        yield content


def test_foxglove_shows_topics_of_the_contract() -> None:
    layout = json.loads((CONFIG / "foxglove_layout.json").read_text(encoding="utf-8"))
    named = set(strings(layout["configById"])) - OF_OTHERS
    known = {f"/{row.name.lstrip('/')}" for row in contract.TOPICS}
    assert {name.partition(".")[0] for name in named} <= known
    assert len(named) >= 12


def test_every_foxglove_panel_has_its_place() -> None:
    layout = json.loads((CONFIG / "foxglove_layout.json").read_text(encoding="utf-8"))

    def leaves(node: Any) -> Iterator[str]:
        if isinstance(node, str):
            yield node
        else:
            yield from leaves(node["first"])
            yield from leaves(node["second"])

    assert sorted(leaves(layout["layout"])) == sorted(layout["configById"])

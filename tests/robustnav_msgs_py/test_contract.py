"""The contract holds together, and names only types that exist."""

import pytest

from robustnav_msgs_py import contract
from robustnav_msgs_py.errors import ContractError
from robustnav_nodes.graph.message_class import message_class

EXECUTABLES = {row.executable for row in contract.NODES}


def test_every_speaker_and_listener_is_a_node() -> None:
    named = {name for row in contract.TOPICS for name in (*row.speakers, *row.listeners)}
    assert named - {contract.EVERY_NODE} <= EXECUTABLES
    assert {row.server for row in contract.SERVICES} <= EXECUTABLES


def test_names_are_unique_and_relative_where_ros_does_not_fix_them() -> None:
    names = [row.name for row in contract.TOPICS]
    assert len(names) == len(set(names))
    assert {name for name in names if name.startswith("/")} == {"/clock", "/diagnostics", "/tf", "/tf_static"}


HERE = [row for row in contract.TOPICS if row.is_available]


@pytest.mark.parametrize("row", [*HERE, *contract.SERVICES], ids=lambda row: row.name)
def test_types_exist(row: contract.Topic | contract.Service) -> None:
    assert message_class(row.type) is not None


def test_listeners_never_ask_for_more_than_is_offered() -> None:
    for row in contract.TOPICS:
        assert row.qos.depth > 0
        assert row.qos.hear_depth is None or row.qos.hear_depth > 0


def test_unknown_names_are_refused() -> None:
    for call in (
        lambda: contract.topic("odometry"),
        lambda: contract.service("~/start", "belief"),
        lambda: contract.spoken_by("nobody"),
    ):
        with pytest.raises(ContractError):
            call()

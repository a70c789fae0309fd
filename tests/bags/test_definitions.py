import sys
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from bags.definitions import ament_prefixes, message_definition
from robustnav_msgs_py import contract

PREFIXES = (Path(sys.prefix),)
TYPES = sorted(
    {row.type for row in contract.TOPICS if row.is_available} | {"rcl_interfaces/msg/ParameterEvent"}
)


@pytest.mark.parametrize("message_type", TYPES)
def test_an_installed_definition_is_complete_and_hashes_to_what_is_installed(message_type: str) -> None:
    definition = message_definition(message_type, PREFIXES)
    types = get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg(definition.text, message_type))
    assert types.hash_rihs01(message_type) == definition.type_hash


@pytest.mark.parametrize("message_type", TYPES)
def test_without_an_installation_a_standard_type_comes_from_jazzy(message_type: str) -> None:
    installed = message_definition(message_type, PREFIXES)
    known = message_definition(message_type, ())
    assert known.text
    assert known.type_hash == installed.type_hash


@pytest.mark.parametrize(
    "message_type", ["my_msgs/msg/Custom", "my_msgs/action/Go_FeedbackMessage", "../../etc"]
)
def test_an_unknown_type_has_an_empty_definition(message_type: str) -> None:
    definition = message_definition(message_type, PREFIXES)
    assert (definition.text, definition.type_hash) == ("", "")


def test_a_users_own_type_is_found_with_what_it_uses(tmp_path: Path) -> None:
    folder = tmp_path / "share" / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Outer.msg").write_text("# comment std_msgs/Header\nInner[<=3] parts  # Comment\nuint8 KIND=1")
    (folder / "Inner.msg").write_text('std_msgs/Header header\nstring<=5 text "a # b"\n')
    definition = message_definition("my_msgs/msg/Outer", (tmp_path, *PREFIXES))
    sections = [line for line in definition.text.splitlines() if line.startswith("MSG: ")]
    assert sections == ["MSG: my_msgs/Inner", "MSG: std_msgs/Header", "MSG: builtin_interfaces/Time"]
    get_types_from_msg(definition.text, "my_msgs/msg/Outer")


def test_prefixes_come_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "/opt/a:/opt/b")
    assert ament_prefixes() == (Path("/opt/a"), Path("/opt/b"))
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    assert ament_prefixes() == PREFIXES

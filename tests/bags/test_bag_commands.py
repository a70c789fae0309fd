"""The commands write what they say, and answer bad input with one sentence."""

import contextlib
import json
import random
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bags.bag_commands import bag_app
from bags.definitions import MessageDefinition
from bags.manifest import Manifest
from bags.writer import BagWriter
from robustnav_msgs_py import conversions
from robustnav_msgs_py.errors import BadFileError, RobustnavError
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes import cli


def run(*arguments: object) -> None:
    bag_app([str(argument) for argument in arguments], standalone_mode=False)


def commands(bag: Path, scratch: Path) -> list[list[object]]:
    return [
        ["info", bag],
        ["metrics", bag],
        ["detection", bag],
        ["report", bag, "--out", scratch / "a.html"],
        ["redact", bag, "--out", scratch / "shared"],
        ["repair", bag, "--out", scratch / "whole"],
    ]


def test_metrics_are_written_as_a_report_of_a_bench(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    run("metrics", search_bag(), search_bag(), "--json", tmp_path / "a.json")
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert (told["bench"], told["episodes"], len(told["rows"])) == ("bag metrics", 2, 2)
    assert told["means"]["sr"] == 1.0


def test_a_bad_bag_does_not_keep_the_others_from_being_measured(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    with pytest.raises(BadFileError, match="there is no bag at"):
        run("metrics", tmp_path / "nowhere", search_bag(), "--json", tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["episodes"] == 1


def test_page_and_picture_are_written(
    search_bag: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = search_bag()
    run("report", bag, "--png", tmp_path / "a.png")
    assert bag.with_suffix(".html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert "wrote" in capsys.readouterr().out


def test_one_search_of_several_is_chosen(
    tmp_path: Path, manifest: Manifest, make_talk: Callable[..., Any]
) -> None:
    with BagWriter(tmp_path / "two", manifest=manifest) as writer:
        talk = make_talk(writer)
        for episode, target in ((1, "mug"), (2, "book")):
            talk.say("chat/from_user", conversions.text_to_message(f"find the {target}"))
            for phase in (SearchPhase.SEARCHING, SearchPhase.STOPPED):
                state = SearchState(phase=phase, target=target, episode=episode)
                talk.say("search/state", conversions.record_to_message(state))
    run("report", tmp_path / "two", "--episode", 1, "--out", tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert "Searching for “mug”: stopped" in page
    assert "find the mug" in page
    run("report", tmp_path / "two", "--out", tmp_path / "a.html")
    assert "find the mug" not in (tmp_path / "a.html").read_text(encoding="utf-8")


def test_bags_are_redacted_and_repaired(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    bag = search_bag()
    run("redact", bag, "--out", tmp_path / "shared", "--images", "blur")
    run("repair", tmp_path / "shared")
    run("info", tmp_path / "shared")


@pytest.mark.parametrize(
    "content", [b"", b"SQLite format 3\0", b"\x89MCA"], ids=["empty", "no MCAP file", "cut at once"]
)
@pytest.mark.parametrize("number", range(5))
def test_a_file_that_is_no_bag_is_answered_in_a_sentence(content: bytes, number: int, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    command = commands(path, tmp_path)[number]
    if (command[0], content) == ("repair", b"\x89MCA"):  # a recorder that was killed at once: an empty bag
        run(*command)
        return
    with pytest.raises(BadFileError, match=r"^\S.*a\.mcap"):
        run(*command)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [content]


@pytest.mark.parametrize("number", range(5))
def test_a_folder_without_a_bag_is_answered_in_a_sentence(number: int, tmp_path: Path) -> None:
    (tmp_path / "none").mkdir()
    with pytest.raises(BadFileError, match="is no bag"):
        run(*commands(tmp_path / "none", tmp_path)[number])


@pytest.mark.parametrize("number", range(4))
def test_two_bags_in_a_folder_are_not_guessed_at(
    number: int, search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    both = tmp_path / "both"
    both.mkdir()
    for folder in (search_bag(), search_bag()):
        (file,) = folder.glob("*.mcap")
        file.rename(both / file.name)
    with pytest.raises(BadFileError, match=r"has no metadata\.yaml"):
        run(*commands(both, tmp_path)[number])


def test_a_bag_cut_anywhere_is_handled_or_refused_in_a_sentence(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    (file,) = search_bag(chunk_bytes=20_000).glob("*.mcap")
    content, path = file.read_bytes(), tmp_path / "cut.mcap"
    for number, size in enumerate(random.Random(2).sample(range(8, len(content)), 2)):
        path.write_bytes(content[:size])
        scratch = tmp_path / str(number)
        scratch.mkdir()
        for command in commands(path, scratch):
            with contextlib.suppress(RobustnavError):
                run(*command)


def test_a_type_that_nothing_defines_does_not_hinder(
    tmp_path: Path, manifest: Manifest, capsys: pytest.CaptureFixture[str]
) -> None:
    with BagWriter(tmp_path / "odd", manifest=manifest) as writer:
        odd = MessageDefinition(type="odd_msgs/msg/Odd", text="", type_hash="")
        writer.write(writer.add_topic("/odd", odd), log_time_ns=1, publish_time_ns=1, data=b"\0\1\0\0odd")
    lacking = {"metrics": "holds no search", "detection": "can be measured only in a bag with ground truth"}
    for command in commands(tmp_path / "odd", tmp_path):
        if command[0] in lacking:
            with pytest.raises(BadFileError, match=lacking[command[0]]):
                run(*command)
        else:
            run(*command)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [(["info", "nowhere"], 1), (["redact", "x", "--out", "y", "--images", "keep", "--chat", "keep"], 2)],
)
def test_exit_codes(
    arguments: list[str], code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["robustnav", "bag", *arguments])
    monkeypatch.setattr("signal.signal", lambda *_: None)
    assert cli.main() == code
    assert capsys.readouterr().err.count("\n") == 1

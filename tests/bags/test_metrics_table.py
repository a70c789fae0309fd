"""Rows and means of several bags; what a bag does not tell is absent, never 0."""

import io
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from bags.episodes import episode_spans, robots
from bags.manifest import Manifest
from bags.metrics_table import MetricsRow, means, metrics_rows, render, report_content
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py import conversions
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import SearchPhase, SearchState


def rows_of(*paths: Path) -> list[MetricsRow]:
    rows: list[MetricsRow] = []
    for path in paths:
        with open_bag(path) as bag:
            rows += metrics_rows(bag)
    return rows


def shown(rows: list[MetricsRow]) -> str:
    text = io.StringIO()
    Console(file=text, width=120).print(render(rows))
    return text.getvalue()


def test_means_are_taken_over_those_that_tell(
    search_bag: Callable[..., Path], corridor: Any, talk_bag: Callable[..., Path]
) -> None:
    found = search_bag(corridor.flat, corridor.told)
    missed = search_bag(corridor.flat, replace(corridor.told, phase=SearchPhase.NOT_FOUND))
    rows = rows_of(found, missed)
    told = {mean.name: mean for mean in means(rows)}
    assert (told["sr"].value, told["sr"].count) == (0.5, 2)
    assert (told["apl"].value, told["apl"].count) == (pytest.approx(4.2), 1)
    assert told["spl"].value == pytest.approx(3.3 / 4.2 / 2)
    assert told["apl"].interval is None
    assert told["sr"].interval == (0.0, 1.0)
    assert "nq_all" not in told
    assert "not told by these bags: NQ (successes), NQ (all)" in shown(rows)


def test_bags_are_named_by_what_tells_them_apart(search_bag: Callable[..., Path]) -> None:
    (row,) = rows_of(search_bag())
    text = shown([replace(row, bag=f"/runs/{day}/search") for day in ("monday", "friday")])
    assert "monday/search" in text
    assert "/runs" not in text
    assert shown([replace(row, bag="/runs/monday/search")]).splitlines()[1].startswith("search ")


def test_what_is_not_told_is_absent_from_the_file(
    tmp_path: Path, talk_bag: Callable[..., Path], search_bag: Callable[..., Path], corridor: Any
) -> None:
    (row,) = report_content(rows_of(search_bag(corridor.flat, corridor.told)))["rows"]
    assert row["success"] is True
    assert "nq" not in row
    assert "robot" not in row
    json.dumps(row, allow_nan=False)


def test_each_search_and_robot_has_its_row_and_its_questions(
    tmp_path: Path, manifest: Manifest, make_talk: Callable[..., Any]
) -> None:
    with BagWriter(tmp_path / "two", manifest=manifest) as writer:
        talk = make_talk(writer, "/r1")
        for episode, questions in ((1, 2), (2, 0), (3, 1)):
            for _ in range(questions):
                talk.say("chat/to_user", conversions.text_to_message("which mug? "))
            talk.say("chat/to_user", conversions.text_to_message("I am looking."))
            for phase in (SearchPhase.SEARCHING, SearchPhase.DOCKING, SearchPhase.NOT_FOUND):
                state = SearchState(phase=phase, target="mug", episode=episode, step=episode)
                talk.say("search/state", conversions.record_to_message(state))
        other = make_talk(writer, "/r2")
        other.now_ns = talk.now_ns
        state = SearchState(phase=SearchPhase.SEARCHING, target="book", episode=1)
        other.say("search/state", conversions.record_to_message(state))
    rows = rows_of(tmp_path / "two")
    assert [(row.robot, row.metrics.episode, row.questions) for row in rows] == [
        ("/r1", 1, 2),
        ("/r1", 2, 0),
        ("/r1", 3, 1),
        ("/r2", 1, None),
    ]
    assert {mean.name: mean.count for mean in means(rows)}["nq_all"] == 3
    assert rows[0].as_mapping()["robot"] == "/r1"
    with open_bag(tmp_path / "two") as bag:
        assert robots(bag) == ("/r1", "/r2")
        first, second, third = episode_spans(bag, "/r1")
    assert (first.from_ns, third.until_ns) == (None, None)
    assert None not in (first.end_ns, first.until_ns)
    assert (first.end_ns, second.end_ns) == (second.from_ns, third.from_ns)
    assert not first.led_here(first.until_ns - 1)
    assert first.holds(first.until_ns - 1)


def test_how_a_search_went_that_had_not_ended_is_not_known(
    search_bag: Callable[..., Path], corridor: Any
) -> None:
    rows = rows_of(search_bag(corridor.flat, replace(corridor.told, phase=SearchPhase.SEARCHING)))
    assert (rows[0].metrics.success, rows[0].metrics.spl, rows[0].metrics.steps) == (None, None, 14)
    assert not {"sr", "spl", "apl"} & {mean.name for mean in means(rows)}


def test_a_bag_in_which_no_search_began_has_no_row(
    tmp_path: Path, manifest: Manifest, make_talk: Callable[..., Any]
) -> None:
    with BagWriter(tmp_path / "idle", manifest=manifest) as writer:
        make_talk(writer, "").say("search/state", conversions.record_to_message(SearchState()))
    with pytest.raises(BadFileError, match="none had begun"):
        rows_of(tmp_path / "idle")


def test_a_bag_in_which_nobody_tells_how_the_search_stands_is_one_row(
    tmp_path: Path, manifest: Manifest, make_talk: Callable[..., Any]
) -> None:
    with BagWriter(tmp_path / "little", manifest=manifest) as writer:
        make_talk(writer, "").say("search/target", conversions.text_to_message("[b]mug"))
    (row,) = rows_of(tmp_path / "little")
    assert row.metrics.success is None
    assert "[b]mug" in shown([row])
    assert report_content([row])["means"].keys() == {"wall_duration_s", "wall_duration_s_episodes"}
    shutil.rmtree(tmp_path / "little")

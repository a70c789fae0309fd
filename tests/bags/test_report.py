"""A report holds the figures of its bag, loads nothing, and shows what people said as text."""

import base64
import io
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from bags.changed_parameters import DECLARATIONS, changed_parameters
from bags.definitions import message_definition
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.metrics import search_metrics
from bags.reader import open_bag
from bags.report_belief import LARGEST_BYTES, belief_film
from bags.report_camera import MOST_PICTURES, WIDEST_GAP_S, Moment, chosen_moments
from bags.report_data import ReportData, read_report
from bags.report_file import report_page, write_report_page
from bags.search_run import Heard
from bags.writer import BagWriter
from robustnav_msgs_py import contract
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import BeliefCloud
from robustnav_nodes.graph.one_process import node_class

EVIL = "</script><img src=x onerror=alert(1)><!--&lt;"


def read(path: Path, episode: int | None = None) -> ReportData:
    with open_bag(path) as bag:
        return read_report(bag, episode=episode)


def data_in(page: str) -> dict[str, Any]:
    """What the page's script reads, found as a browser finds it: up to the first end of the element."""
    found = re.search(r'<script id="data" type="application/json">(.*?)</script', page, re.DOTALL)
    assert found is not None
    return dict(json.loads(found[1]))


def test_the_page_holds_the_figures_of_the_search(search_bag: Callable[..., Path]) -> None:
    path = search_bag()
    with open_bag(path) as bag:
        metrics = search_metrics(bag)
        told = data_in(report_page(read_report(bag)))
    facts = {fact["name"]: fact["text"] for fact in told["facts"]}
    assert told["verdict"] == "good"
    assert facts["steps"] == str(metrics.steps)
    assert facts["SPL"] == f"{metrics.spl:.2f}"
    assert facts["false alarms survived"] == str(metrics.false_alarms)
    assert len(told["decisions"]) == metrics.steps
    assert told["decisions"][0]["actions"] == [
        {"action": "forward", "value": 1.0, "visits": 700},
        {"action": "turn left", "value": 0.5, "visits": 324},
    ]
    assert told["end_s"] == pytest.approx(metrics.sim_duration_s, abs=0.6)
    assert [thing["label"] for thing in told["things"] if thing["wanted"]] == ["mug"]
    assert any(mark["is_false"] for mark in told["marks"])
    assert told["run"][1] == {"name": "version", "text": "0.1.0"}


def test_the_belief_of_each_moment_is_in_the_page(search_bag: Callable[..., Path]) -> None:
    path = search_bag()
    film = read(path).belief
    assert film is not None
    with open_bag(path) as bag:
        count = sum(1 for _ in bag.raw_messages(["/belief/cloud"]))
    assert len(film.frames) == film.told <= count
    levels = [np.frombuffer(base64.b64decode(frame.levels), dtype=np.uint8) for frame in film.frames]
    (layout,) = film.layouts
    places = np.frombuffer(base64.b64decode(layout.places), dtype="<u4")
    cells = np.frombuffer(base64.b64decode(layout.cells), dtype="<u4")
    assert len(places) == len(cells) == len(set(cells.tolist()))
    assert places.max() < len(levels[0])
    assert cells.max() < layout.rows * layout.columns
    assert levels[0].max() < 180 < levels[-1].max()


def test_beliefs_that_are_too_many_are_thinned_but_begin_and_end(flat_map: Any) -> None:
    places_m = np.zeros((50_000, 3), dtype=np.float32)
    places_m[:, 0] = np.linspace(0.0, 5.0, len(places_m))
    beliefs = []
    for step in range(60):
        weights = np.ones(len(places_m))
        weights[: 100 * (step + 1)] = 30.0
        cloud = BeliefCloud(position_m=places_m, probability=weights / weights.sum(), stamp_ns=step)
        beliefs.append(Heard(log_time_ns=step, value=cloud))
    film = belief_film(beliefs, [float(step) for step in range(60)], flat_map, None, 0.2)
    assert film.told == 60
    assert 2 <= len(film.frames) <= LARGEST_BYTES // len(places_m)
    assert (film.frames[0].t_s, film.frames[-1].t_s) == (0.0, 59.0)


def test_what_people_say_cannot_become_a_part_of_the_page(
    talk_bag: Callable[..., Path],
) -> None:
    page = report_page(read(talk_bag([EVIL])))
    assert "<img" not in page
    assert page.count("</script") == 2
    assert [line["text"] for line in data_in(page)["chat"]] == [EVIL]


def test_the_page_may_load_nothing(search_bag: Callable[..., Path]) -> None:
    page = report_page(read(search_bag()))
    (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', page)
    assert policy.startswith("default-src 'none'; img-src data:; style-src 'sha256-")
    assert "unsafe" not in policy
    assert not re.search(
        r"https?://|//[a-z]+\.|@import|url\(|fetch\(|XMLHttpRequest|WebSocket|innerHTML", page
    )
    assert not re.search(r'\s(?:src|href|on\w+)\s*=\s*["\']', page)


def test_the_parts_of_the_page_are_installed_and_the_script_is_short() -> None:
    folder = files("bags") / "report_page"
    assert {part.name for part in folder.iterdir()} == {"page.html", "style.css", "script.js"}
    assert len((folder / "script.js").read_text(encoding="utf-8").splitlines()) < 320


def test_a_bag_without_most_topics_says_what_is_missing(talk_bag: Callable[..., Path]) -> None:
    report = read(talk_bag(["hello"]))
    assert report.verdict == "open"
    assert [line.text for line in report.chat] == ["hello"]
    assert "no map" in " ".join(report.missing)
    assert data_in(report_page(report))["floor"] is None


def test_an_empty_bag_gives_a_page(tmp_path: Path, manifest: Manifest) -> None:
    BagWriter(tmp_path / "empty", manifest=manifest).close()
    assert "No search was recorded" in report_page(read(tmp_path / "empty"))


def test_a_bag_without_pictures_says_so(search_bag: Callable[..., Path]) -> None:
    assert "the camera's images" in " ".join(read(search_bag()).missing)


def test_a_cut_bag_gives_a_report_of_what_is_left(search_bag: Callable[..., Path]) -> None:
    folder = search_bag(chunk_bytes=4000)
    (file,) = folder.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    report = read(folder)
    assert report.missing[0].startswith("The recording was cut.")
    assert report.decisions
    report_page(report)


def test_numbers_that_are_not_finite_do_not_break_the_page(search_bag: Callable[..., Path]) -> None:
    report = read(search_bag())
    broken = replace(report.things[0], x_m=math.nan)
    told = data_in(report_page(replace(report, things=(broken,), half_view_rad=math.inf)))
    assert (told["things"][0]["x_m"], told["half_view_rad"]) == (None, None)


def test_a_line_that_is_no_text_ends_the_talk_but_not_the_report(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "bad", manifest=manifest) as writer:
        channel = writer.add_topic("/chat/from_user", message_definition("std_msgs/msg/String", ()))
        for number, text in enumerate((b"ok\0", b"\xff\xfe\0")):
            data = b"\0\1\0\0\3\0\0\0" + text
            writer.write(channel, log_time_ns=number, publish_time_ns=number, data=data)
    report = read(tmp_path / "bad")
    assert [line.text for line in report.chat] == ["ok"]
    assert "Of chat/from_user, only what came before a bad message is shown" in report.missing[-1]


def test_a_search_that_is_not_there_is_refused(search_bag: Callable[..., Path]) -> None:
    with pytest.raises(BadFileError, match="no search number 5"):
        read(search_bag(), episode=5)


def test_a_robot_in_a_namespace_is_reported_on(search_bag: Callable[..., Path]) -> None:
    report = read(search_bag(namespace="/robot1"))
    assert report.verdict == "good"
    assert report.floor is not None
    assert report.way


def test_pictures_are_small_few_and_carry_their_decision(picture_bag: Callable[..., Path]) -> None:
    report = read(picture_bag(640, 400))
    assert 1 < len(report.frames) <= MOST_PICTURES
    for frame in report.frames:
        with Image.open(io.BytesIO(base64.b64decode(frame.jpeg))) as picture:
            assert picture.size == (320, 200) == (frame.width, frame.height)
            assert picture.format == "JPEG"
    assert [frame.decision for frame in report.frames][:2] == [0, 1]
    assert report.frames[-1].decision is None
    times = [frame.t_s for frame in report.frames]
    assert times == sorted(times)


def test_pictures_keep_up_with_a_robot_that_drives_for_long_on_one_decision() -> None:
    decided = [Moment(log_time_ns=10**9 * t, t_s=float(t), decision=n) for n, t in enumerate((0, 3, 40))]
    chosen = chosen_moments([*decided, Moment(log_time_ns=10**9 * 42, t_s=42.0, decision=None)])
    times = [moment.t_s for moment in chosen]
    assert times == sorted(set(times))
    assert max(after - before for before, after in pairwise(times)) <= WIDEST_GAP_S
    assert [moment for moment in chosen if moment.decision is not None] == decided
    assert all(moment.log_time_ns == round(10**9 * moment.t_s) for moment in chosen[:3])
    hour = [Moment(log_time_ns=n * 10**12, t_s=1000.0 * n, decision=n) for n in range(5)]
    assert len(chosen_moments(hour)) <= MOST_PICTURES
    assert chosen_moments(hour[:1]) == tuple(hour[:1])


def test_a_page_that_cannot_be_written_is_said(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="cannot be written"):
        write_report_page(read(search_bag()), tmp_path / "nowhere" / "a.html")


def test_only_parameters_that_differ_are_told(manifest: Manifest) -> None:
    def node(name: str, **values: Any) -> NodeParameters:
        told = tuple(NamedParameter(name=key, value=value) for key, value in values.items())
        return NodeParameters(node=name, parameters=told)

    grown = manifest.with_node(node("/r/planner", variant="pomp", headings=12, qos_overrides=1))
    grown = grown.with_node(node("/r/somebody", variant="pomp"))
    changed = changed_parameters(grown)
    assert [(row.node, row.name, row.value, row.default) for row in changed] == [
        ("/r/planner", "variant", "pomp", "lookahead")
    ]


def test_every_node_of_a_run_but_the_manager_has_its_parameters_known() -> None:
    nodes = {
        row.executable: row.package for row in contract.NODES if row.in_graph and row.executable != "manager"
    }
    assert nodes.keys() == DECLARATIONS.keys()
    for executable, (module, name) in DECLARATIONS.items():
        declaration = node_class(nodes[executable], executable).declaration
        assert (declaration.__module__, declaration.__name__) == (module, name)

import io
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from bags.info import bag_info, qos_text, render
from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from bags.reader import open_bag
from bags.writer import BagWriter


def shown(path: Path, width: int = 200) -> str:
    text = io.StringIO()
    with open_bag(path) as bag:
        Console(file=text, width=width).print(render(bag_info(bag)))
    return text.getvalue()


def test_the_figures_are_those_of_the_messages(search_bag: Callable[..., Path]) -> None:
    with open_bag(search_bag()) as bag:
        info = bag_info(bag)
        times: dict[str, list[int]] = {}
        for raw in bag.raw_messages():
            times.setdefault(raw.topic, []).append(raw.log_time_ns)
    everything = [time for topic in times.values() for time in topic]
    assert info.message_count == len(everything)
    assert info.start_ns == min(everything)
    assert info.duration_s == (max(everything) - min(everything)) / 1e9
    assert {topic.name: topic.message_count for topic in info.topics} == {
        topic: len(told) for topic, told in times.items()
    }
    rates = {topic.name: topic.rate_hz for topic in info.topics}
    assert rates["/map"] is None
    assert rates["/odom"] == pytest.approx((len(times["/odom"]) - 1) / info.duration_s)


def test_the_table_says_what_a_person_asks(search_bag: Callable[..., Path], manifest: Manifest) -> None:
    text = shown(search_bag())
    for said in (
        "closed properly  yes",
        f"robustnav 0.1.0 at {manifest.commit[:12]}",
        "/detection backend=truth",
        "flat (living room, kitchen, bedroom)",
        "no answer from   /chat",
        "latched",
    ):
        assert said in text


def test_a_cut_bag_says_what_is_left(search_bag: Callable[..., Path]) -> None:
    folder = search_bag()
    (file,) = folder.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    assert "closed properly  no: " in shown(folder)


def test_an_empty_bag_can_be_shown(tmp_path: Path, manifest: Manifest) -> None:
    BagWriter(tmp_path / "empty", manifest=manifest).close()
    assert "0 on 0 topics" in shown(tmp_path / "empty")


def test_names_in_a_bag_are_shown_as_they_are(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    odd = tmp_path / "[bold]odd"
    search_bag().rename(odd)
    (next(odd.glob("*.mcap"))).rename(odd / "x.mcap")
    metadata = odd / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("search_0_0.mcap", "x.mcap"))
    assert "[bold]odd" in shown(odd)


def test_publishers_that_offer_the_same_are_counted() -> None:
    latched = OfferedQos(durability="transient_local")
    lesser = OfferedQos(reliability="best_effort", durability="transient_local")
    assert qos_text([OfferedQos(), latched, OfferedQos()]) == "2 x reliable, 1 x latched"
    assert qos_text([lesser]) == "best effort transient local"
    assert qos_text([]) == ""

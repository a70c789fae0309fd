"""What a bag holds, at a glance: `robustnav bag info`."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from bags.reader import Bag

NS_PER_S = 1e9


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicInfo:
    """One topic of a bag; `rate_hz` is None where fewer than two messages tell none."""

    name: str
    type: str
    message_count: int
    rate_hz: float | None
    qos: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BagInfo:
    """What `robustnav bag info` tells of a bag; `start_ns` is None where it holds no message.

    `cut` is "" where the bag was closed properly, and otherwise says what is left of it.
    """

    path: str
    size_bytes: int
    compression: str
    start_ns: int | None
    duration_s: float
    message_count: int
    topics: tuple[TopicInfo, ...]
    manifest: Manifest | None
    cut: str


def bag_info(bag: Bag) -> BagInfo:
    """Describe `bag` from what its files tell, without reading its messages."""
    span = bag.span_ns
    duration_s = (span[1] - span[0]) / NS_PER_S if span else 0.0
    topics = tuple(
        TopicInfo(
            name=row.name,
            type=row.type,
            message_count=row.message_count,
            rate_hz=(row.message_count - 1) / duration_s
            if row.message_count > 1 and duration_s > 0
            else None,
            qos=qos_text(row.offers),
        )
        for row in bag.topics
    )
    return BagInfo(
        path=str(bag.path),
        size_bytes=bag.size_bytes,
        compression=bag.compression,
        start_ns=span[0] if span else None,
        duration_s=duration_s,
        message_count=sum(topic.message_count for topic in topics),
        topics=topics,
        manifest=bag.manifest,
        cut=bag.cut,
    )


def render(info: BagInfo) -> RenderableType:
    """The table that a terminal shows."""
    facts = Table.grid(padding=(0, 2))
    facts.add_column(style="bold")
    facts.add_column(overflow="fold")
    for name, text in _facts(info):
        facts.add_row(name, escape(text))
    topics = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    topics.add_column("topic", overflow="fold")
    topics.add_column("type", overflow="fold")
    topics.add_column("count", justify="right", no_wrap=True)
    topics.add_column("Hz", justify="right", no_wrap=True)
    topics.add_column("publishers", overflow="fold")
    for topic in info.topics:
        if topic.message_count:
            rate = "" if topic.rate_hz is None else f"{topic.rate_hz:.3g}"
            kind = topic.type.replace("/msg/", "/")
            topics.add_row(
                escape(topic.name), escape(kind), f"{topic.message_count}", rate, escape(topic.qos)
            )
    silent = [topic.name for topic in info.topics if not topic.message_count]
    last_line = Text(f"\nwithout messages: {', '.join(silent)}") if silent else Text()
    return Group(facts, Text(), topics, last_line)


def qos_text(offers: Sequence[OfferedQos]) -> str:
    """The publishers' QoS in a few words, such as "2 x reliable, 1 x latched".

    Latched is reliable and transient local; volatile goes without saying.
    """
    kinds = Counter(_kind(offer) for offer in offers)
    if len(offers) == 1:
        return next(iter(kinds))
    return ", ".join(f"{count} x {kind}" for kind, count in kinds.items())


def _kind(offer: OfferedQos) -> str:
    reliability = offer.reliability.replace("_", " ")
    if offer.durability == "volatile":
        return reliability
    is_latched = (offer.reliability, offer.durability) == ("reliable", "transient_local")
    return "latched" if is_latched else f"{reliability} {offer.durability.replace('_', ' ')}"


def _facts(info: BagInfo) -> list[tuple[str, str]]:
    facts = [("bag", info.path)]
    compression = f", {info.compression}" if info.compression else ""
    facts.append(("size", f"{_size(info.size_bytes)} (mcap{compression})"))
    if info.start_ns is not None:
        facts.append(("start", _start(info.start_ns, info.manifest)))
    facts.append(("duration", f"{info.duration_s:.1f} s"))
    facts.append(("messages", f"{info.message_count} on {len(info.topics)} topics"))
    facts.append(("closed properly", "yes" if not info.cut else f"no: {info.cut}"))
    return facts + (_manifest_facts(info.manifest) if info.manifest else [("manifest", "none")])


def _start(start_ns: int, manifest: Manifest | None) -> str:
    """Of the wall clock; a run in lock-step has a clock of its own, and was recorded at some other time."""
    if manifest is not None and manifest.lockstep:
        recorded = _moment(manifest.wall_start_ns, "%Y-%m-%d %H:%M:%S %z")
        return f"{start_ns / NS_PER_S:.3f} s of the run's own clock (lock-step, recorded {recorded})"
    return _moment(start_ns, "%Y-%m-%d %H:%M:%S.%f %z")


def _moment(time_ns: int, form: str) -> str:
    return datetime.fromtimestamp(time_ns / NS_PER_S).astimezone().strftime(form)


def _manifest_facts(manifest: Manifest) -> list[tuple[str, str]]:
    changes = " with uncommitted changes" if manifest.uncommitted_changes else ""
    commit = f" at {manifest.commit[:12]}{changes}" if manifest.commit else ""
    version = manifest.version or "of unknown version"
    facts = [("made by", f"robustnav {version}{commit} on {manifest.platform}")]
    if manifest.seed is not None:
        facts.append(("seed", str(manifest.seed)))
    if manifest.scene:
        facts.append(("scene", manifest.scene))
    if manifest.sim_start_ns is not None:
        facts.append(("simulated from", f"{manifest.sim_start_ns / NS_PER_S:.3f} s"))
    if manifest.back_ends:
        facts.append(("back ends", manifest.back_ends_text))
    if manifest.nodes:
        facts.append(("parameters of", ", ".join(node.node for node in manifest.nodes)))
    if manifest.redacted:
        facts.append(("redacted", "; ".join(manifest.redacted)))
    if manifest.silent_nodes:
        facts.append(("no answer from", ", ".join(manifest.silent_nodes)))
    return facts


def _size(size_bytes: int) -> str:
    value = float(size_bytes)
    for unit in ("B", "kB", "MB", "GB"):
        if value < 1000 or unit == "GB":
            break
        value /= 1000
    return f"{value:.3g} {unit}"

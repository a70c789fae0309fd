"""The short facts of a report: how the search went, and what made the run."""

from dataclasses import dataclass
from datetime import UTC, datetime

from bags.manifest import Manifest
from bags.metrics import SearchMetrics


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """A name and what there is to say under it."""

    name: str
    text: str


def search_facts(metrics: SearchMetrics) -> tuple[Fact, ...]:
    """Figures of the search; what the bag does not tell is left out."""
    told = {
        "success": {True: "yes", False: "no", None: None}[metrics.success],
        "steps": None if metrics.steps is None else str(metrics.steps),
        "driven": _metres(metrics.path_length_m),
        "shortest way": _metres(metrics.shortest_path_m),
        "SPL": None if metrics.spl is None else f"{metrics.spl:.2f}",
        "false alarms survived": None if metrics.false_alarms is None else str(metrics.false_alarms),
        "robot's time": _seconds(metrics.sim_duration_s),
        "wall time": _seconds(metrics.wall_duration_s),
    }
    return tuple(Fact(name=name, text=text) for name, text in told.items() if text is not None)


def manifest_facts(manifest: Manifest | None) -> tuple[Fact, ...]:
    """What made the run; empty where the recorder was not ours."""
    if manifest is None:
        return ()
    changes = " with uncommitted changes" if manifest.uncommitted_changes else ""
    begun = datetime.fromtimestamp(manifest.wall_start_ns / 1e9, tz=UTC)
    told = {
        "recorded": f"{begun:%Y-%m-%d %H:%M} UTC",
        "version": manifest.version,
        "commit": manifest.commit + changes if manifest.commit else "",
        "seed": "" if manifest.seed is None else str(manifest.seed),
        "scene": manifest.scene,
        "clock": _clock(manifest),
        "back ends": manifest.back_ends_text,
        "platform": manifest.platform,
        "packages": ", ".join(f"{row.package} {row.version}" for row in manifest.packages),
        "nodes": ", ".join(node.node for node in manifest.nodes),
        "no answer from": ", ".join(manifest.silent_nodes),
        "redacted": "; ".join(manifest.redacted),
    }
    return tuple(Fact(name=name, text=text) for name, text in told.items() if text)


def _clock(manifest: Manifest) -> str:
    begun = "" if manifest.sim_start_ns is None else f"simulated, from {manifest.sim_start_ns / 1e9:.3f} s on"
    return f"{begun}, in lock-step".removeprefix(", ") if manifest.lockstep else begun


def _metres(length_m: float | None) -> str | None:
    return None if length_m is None else f"{length_m:.2f} m"


def _seconds(duration_s: float | None) -> str | None:
    return None if duration_s is None else f"{duration_s:.1f} s"

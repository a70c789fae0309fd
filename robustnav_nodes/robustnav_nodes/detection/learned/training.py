"""Trains the detector: renders the pictures, trains its networks, writes the weights."""

import copy
import json
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import torch
from torch import nn

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.detection.learned.gradient_workers import MakeLoss
from robustnav_nodes.detection.learned.lessons import DetectionLoss, LookLoss
from robustnav_nodes.detection.learned.network import DetectorNetwork, LookNetwork, Widths
from robustnav_nodes.detection.learned.phase import PEAK_RATE, Clock, CurvePoint, Phase
from robustnav_nodes.detection.learned.rendering import Kind, RenderPlan, render_pictures
from robustnav_nodes.detection.learned.weights import Weights, digest_of, save_weights

# The seeds below this one are for demos and tests; those from TEST_SEED on are never trained on.
FIRST_SEED, TEST_SEED = 1000, 500_000
HOMES, PICTURES_PER_HOME = 800, 30
# Processes, each on one core.
WORKERS = 2
NETWORKS = ("detector", "look")
LOOK_SHARE = 0.25
# However slow the rendering was, something is learned.
LEARNING_MIN_S = 60.0

# What is being done, how much of it is over (0..1), and a word on it.
Report = Callable[[str, float, str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingPlan:
    """What to train and how long: `minutes` in all, rendering included; `seed` decides all that is random.

    `begin_with`: weights to go on from instead of from nothing; a network that is not among `networks` stays
    as it is there, and with `anew` those that are begin from nothing. `rate`: of the usual learning rate.
    """

    minutes: float
    seed: int
    homes: int = HOMES
    per_home: int = PICTURES_PER_HOME
    networks: tuple[str, ...] = NETWORKS
    begin_with: Weights | None = None
    anew: bool = False
    rate: float = 1.0

    def __str__(self) -> str:
        """All but the minutes: a training that was stopped may be given more of them."""
        first = "nothing" if self.begin_with is None else f"weights {digest_of(self.begin_with)[:12]}"
        pictures = f"{self.homes} homes of {self.per_home} pictures"
        anew = f", {' and '.join(self.networks)} anew" if self.anew else ""
        return f"from {first}{anew}, {pictures}, seed {self.seed}, rate {self.rate:g}"


def train_detector(
    out: Path, plan: TrainingPlan, *, resume: bool, report: Report, clock: Clock = time.monotonic
) -> Weights:
    """Train, and write the weights to `out`; pictures and checkpoints stay in `training` beside it.

    Pictures are rendered once; `resume` takes up checkpoints. Raises BadParameterError where there are some
    and `resume` was not asked for, and where the weights to begin with are missing or for other classes.
    """
    from sim_bridge.homes.objects.catalogue import LABELS

    if plan.begin_with is not None and plan.begin_with.labels != LABELS:
        raise BadParameterError(
            f"the weights to begin with are for other classes than the homes hold: {plan.begin_with.labels}"
        )
    kept = [name for name in NETWORKS if name not in plan.networks]
    if kept and plan.begin_with is None:
        raise BadParameterError(
            f"the {kept[0]} network is not to be trained: name weights that hold it (--begin-with)"
        )
    work = out.parent / "training"
    checkpoints = {name: work / f"{name}.checkpoint" for name in plan.networks}
    if not resume and any(path.exists() for path in checkpoints.values()):
        raise BadParameterError(
            f"{str(work)!r} holds an earlier training; take it up with --resume (and the same options), or "
            "remove its checkpoints"
        )
    folder = work / "pictures"
    torch.manual_seed(plan.seed)
    began_s = clock()
    homes = 0

    def rendered() -> None:
        nonlocal homes
        homes += 1
        report("pictures", homes / plan.homes, f"{homes} homes")

    render_pictures(
        RenderPlan(kind=Kind.TRAINING, first_seed=FIRST_SEED, homes=plan.homes, per_home=plan.per_home),
        folder,
        WORKERS,
        rendered,
    )
    left_s = max(LEARNING_MIN_S, plan.minutes * 60.0 - (clock() - began_s))
    widths = Widths()
    fresh = Weights(
        labels=LABELS, widths=widths, detector=DetectorNetwork(len(LABELS), widths), look=LookNetwork()
    )
    weights = plan.begin_with or fresh
    begun = fresh if plan.anew else weights
    networks: dict[str, nn.Module] = {"detector": begun.detector, "look": begun.look}
    make_loss: dict[str, MakeLoss] = {
        "detector": DetectionLoss(pictures=folder, seed=plan.seed),
        "look": LookLoss(pictures=folder),
    }
    share = {"detector": 1.0 - LOOK_SHARE, "look": LOOK_SHARE}
    phases = {
        name: Phase(
            copy.deepcopy(networks[name]).train().to(memory_format=torch.channels_last),
            make_loss[name],
            workers=WORKERS,
            seed=plan.seed,
            budget_s=left_s * share[name] / sum(share[trained] for trained in plan.networks),
            peak_rate=PEAK_RATE * plan.rate,
            checkpoint=checkpoints[name],
            purpose=str(plan),
            clock=clock,
        )
        for name in plan.networks
    }
    for name, phase in phases.items():
        phase.run(lambda now, name=name: report(name, now.share, _standing(now)))  # type: ignore[misc]
    trained = {name: phase.average.eval() for name, phase in phases.items()}
    weights = replace(weights, **trained)
    save_weights(out, weights)
    save_curves(out.with_suffix(".curves"), {name: phase.curve for name, phase in phases.items()})
    return weights


def save_curves(path: Path, curves: dict[str, list[CurvePoint]]) -> None:
    """Losses over time: as PATH.json, and drawn as PATH.png."""
    from matplotlib.figure import Figure

    text = json.dumps({name: [asdict(point) for point in curve] for name, curve in curves.items()})
    path.with_suffix(".json").write_text(text, encoding="utf-8")
    figure = Figure(figsize=(9.0, 3.5), layout="constrained")
    for axes, (name, curve) in zip(
        figure.subplots(1, len(curves), squeeze=False)[0], curves.items(), strict=True
    ):
        axes.plot([point.seconds / 60.0 for point in curve], [point.loss for point in curve])
        axes.set(title=name, xlabel="minutes", ylabel="loss", yscale="log")
    figure.savefig(path.with_suffix(".png"), dpi=120)


def _standing(phase: Phase) -> str:
    loss = f", loss {phase.curve[-1].loss:.2f}" if phase.curve else ""
    return f"{phase.steps} steps{loss}"

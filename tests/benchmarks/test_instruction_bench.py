"""The figures of `bench instruction`, by hand; the commands, on a small pack with a small model."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from robustnav_nodes.benchmarks.instruction_bench import (
    Judged,
    calibration_of,
    chosen_pairs,
    judge_episodes,
    mean_row,
    online_step_time,
    pair_rows,
    row_of,
)
from robustnav_nodes.benchmarks.instruction_episodes import bench_episodes
from robustnav_nodes.cli import app
from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode
from robustnav_nodes.instruction.injection import PROTOCOLS, Injector, error_episodes
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.verdict import Verdict
from tests.instruction.pack_files import write_lines, write_pack
from tests.instruction.small_world import said_walks

runner = CliRunner()


def judged(**changes: Any) -> Judged:
    chosen: dict[str, Any] = {
        "model": "m",
        "protocol": "uniform",
        "error_type": "direction",
        "scores": np.array([0.1, 0.9, 0.6, 0.4]),
        "labels": np.array([0.0, 1.0, 0.0, 1.0]),
        "distances": np.array([np.nan, 0.0, np.nan, 3.0]),
        "homes": ("a", "a", "b", "b"),
        "pairs": ("left/right", "left/right", "into/out of", "into/out of"),
        "seconds": 0.008,
    }
    return Judged(**(chosen | changes))


def test_auc_and_atd_of_four_episodes() -> None:
    """Of the four pairs of a wrong and a clean one three are in order; the distances are 0 and 3."""
    row = row_of(judged())
    assert (row.episodes, row.auc, row.atd, row.seconds_per_1000) == (4, 0.75, 1.5, 2.0)
    assert row.auc_ci is not None
    assert row.auc_ci[0] <= 0.75 <= row.auc_ci[1]


def test_no_episode_has_no_figures() -> None:
    nothing = np.zeros(0)
    row = row_of(judged(scores=nothing, labels=nothing, distances=nothing, homes=(), pairs=()))
    assert (row.episodes, row.auc, row.auc_ci, row.atd) == (0, None, None, None)


def test_the_mean_is_over_types_not_over_episodes() -> None:
    one, other = judged(), judged(error_type="room", scores=np.array([0.0, 1.0, 0.0, 1.0]))
    row = mean_row([row_of(one), row_of(other)], [one, other])
    assert row.error_type == "mean"
    assert row.auc == pytest.approx((0.75 + 1.0) / 2.0)
    assert row.auc_ci is not None


def test_each_pair_of_opposites_is_judged_against_its_own_clean_twins() -> None:
    rows = {row.pair: row for row in pair_rows(judged())}
    assert rows["left/right"].auc == 1.0
    assert rows["into/out of"].auc == 0.0


def test_scores_that_are_too_sure_get_a_temperature_above_one() -> None:
    rng = np.random.default_rng(0)
    labels = (rng.uniform(size=400) < 0.6).astype(float)
    scores = np.where(rng.uniform(size=400) < 0.75, labels, 1.0 - labels) * 0.98 + 0.01
    homes = tuple(f"home {k % 10}" for k in range(400))
    found = calibration_of(
        [judged(scores=scores, labels=labels, homes=homes, distances=labels, pairs=("",) * 400)]
    )
    assert found.temperature > 1.5
    assert found.error_scaled < 0.5 * found.error


class KnowsAll:
    """Tells wrong instructions by what is written in them."""

    def __init__(self, episodes: list[ErrorEpisode]) -> None:
        self._wrong = {one.tokens: [span.start for span in one.wrong] for one in episodes}

    def judge(self, trajectory: Trajectory, tokens: tuple[str, ...]) -> Verdict:
        del trajectory
        wrong = self._wrong[tokens]
        return Verdict(error_score=float(bool(wrong)), doubts=tuple((at, 1.0) for at in wrong))


def test_who_knows_all_is_always_right() -> None:
    injector = Injector(common_sense=anything_goes())
    episodes = list(error_episodes(said_walks(homes=2, walks=3, seed=0), "all", injector, 1))
    row = row_of(judge_episodes("m", KnowsAll(episodes), "uniform", "all", episodes))
    assert (row.auc, row.atd) == (1.0, 0.0)


def test_a_part_of_the_episodes_keeps_pairs_together() -> None:
    injector = Injector(common_sense=anything_goes())
    episodes = list(error_episodes(said_walks(homes=2, walks=4, seed=0), "room", injector, 1))
    part = chosen_pairs(episodes, 10, seed=3)
    assert len(part) == 10
    assert sum(one.label for one in part) == 5
    assert part == chosen_pairs(episodes, 10, seed=3)
    assert {one.key[:-1] for one in part if one.label} == {one.key[:-1] for one in part if not one.label}


def test_a_robot_is_timed_at_every_viewpoint() -> None:
    """Each walk of the small world has four."""
    injector = Injector(common_sense=anything_goes())
    episodes = list(error_episodes(said_walks(homes=1, walks=2, seed=0), "all", injector, 1))
    seen: list[int] = []

    class Counts:
        def judge(self, trajectory: Trajectory, tokens: tuple[str, ...]) -> Verdict:
            seen.append(len(trajectory))
            return Verdict(error_score=0.5)

    step = online_step_time("m", Counts(), "uniform", episodes)
    assert step is not None
    assert seen == [1, 2, 3, 4] * len(episodes)
    assert (step.steps, step.median_ms <= step.p95_ms) == (len(seen), True)


def test_a_packs_own_errors_are_kept_where_the_other_protocol_is_missing(tmp_path: Path) -> None:
    pack = write_pack(tmp_path / "pack", walks=12)
    for error_type in ERROR_TYPES:
        write_lines(pack / "errors_uniform" / f"val_seen_{error_type}.jsonl.gz", [])
    (pack / "r2r_train.jsonl.gz").unlink()  # whose wording, the same text each time, would accept nothing
    found = bench_episodes(pack, "val_seen", PROTOCOLS, None, 1)
    assert not any(found["uniform"].values())
    assert any(found["matched"].values())


def test_without_common_sense_anything_is_confused_with_anything(tmp_path: Path) -> None:
    """The pack allows a bedroom to be taken for a hallway alone."""
    pack = write_pack(tmp_path / "pack", walks=40)
    (pack / "priors.json").write_text(
        json.dumps({"room_adjacency": {"bedroom": ["hallway"]}, "object_colocation": {}})
    )
    wrong = {
        common_sense: {
            span.wrong
            for one in bench_episodes(pack, "train", ("uniform",), None, 1, common_sense=common_sense)[
                "uniform"
            ]["room"]
            for span in one.wrong
        }
        for common_sense in (True, False)
    }
    assert wrong[True] == {"hallway"}
    assert len(wrong[False]) > 5


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("torch")
    pytest.importorskip("sklearn")
    from robustnav_nodes.instruction.iedl_training import IedlSettings
    from robustnav_nodes.instruction.mention_network import NetworkSettings
    from robustnav_nodes.instruction.mention_training import MentionSettings, TreeSettings
    from robustnav_nodes.instruction.training import TrainingPlan, train_models

    out = tmp_path_factory.mktemp("model") / "model.npz"
    plan = TrainingPlan(
        data="small world",
        ours=MentionSettings(
            trees=TreeSettings(iterations=10, least_in_leaf=5, ensembles=1),
            network=NetworkSettings(width=16, epochs=2, batch=32),
            folds=2,
        ),
        iedl=IedlSettings(width=16, layers=1, epochs=1),
    )
    said = said_walks(homes=3, walks=3, seed=0)
    train_models(said, anything_goes(), plan, out, resume=False, say=lambda _: None)
    assert sorted(path.name for path in out.parent.iterdir()) == ["model.npz"]
    return out


def test_the_command_writes_a_row_for_each_model_and_type(model: Path, tmp_path: Path) -> None:
    pack = write_pack(tmp_path / "pack", walks=6)
    figures = tmp_path / "figures.json"
    done = runner.invoke(
        app,
        [
            *("bench", "instruction", "--data", str(pack), "--suite", "train", "--model", str(model)),
            *("--json", str(figures), "--plots", str(tmp_path)),
        ],
    )
    assert done.exit_code == 0, done.output
    report = json.loads(figures.read_text())
    assert report["bench"] == "instruction"
    models = {row["model"] for row in report["rows"]}
    assert models == {"random", "grounding", "surprise", "blind", "iedl", "mentions"}
    types = {row["error_type"] for row in report["rows"]}
    assert types == {"direction", "room", "object", "room_object", "all", "mean"}
    assert {row["protocol"] for row in report["rows"]} == {"uniform", "matched"}
    assert all("auc" in row and "auc_ci" in row and "atd" in row for row in report["rows"])
    assert all(row["seconds_per_1000"] > 0.0 for row in report["rows"] if row["episodes"])
    steps = {step["protocol"]: step for step in report["online_step_ms"]}
    assert set(steps) == {"uniform", "matched"}
    assert all(0.0 < step["median_ms"] <= step["p95_ms"] for step in steps.values())
    assert set(report["thesis"]) == {"thesis: random", "thesis: CLIP grounding", "thesis: IEDL"}
    assert "…" not in done.output  # nothing is cut off in a terminal of 80 columns
    assert (tmp_path / "instruction_auc.png").stat().st_size > 10_000
    assert (tmp_path / "instruction_reliability.png").exists()


def test_the_audit_reads_a_file_of_a_pack(model: Path, tmp_path: Path) -> None:
    pack = write_pack(tmp_path / "pack")
    figures = tmp_path / "audit.json"
    file = pack / "r2r_train.jsonl.gz"
    arguments = ["--model", str(model), "--threshold", "0", "--protocol", "uniform", "--json", str(figures)]
    done = runner.invoke(app, ["instruction", "audit", str(file), *arguments])
    assert done.exit_code == 0, done.output
    said = sum(
        len(json.loads(line)["instructions"]) for line in gzip.decompress(file.read_bytes()).splitlines()
    )
    assert len(json.loads(figures.read_text())["flagged"]) == said
    assert f"{said} of {said} instructions" in done.output


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--data", "nowhere"), "there is no pack at 'nowhere'"),
        (("--models", "oracle"), "there is no model 'oracle'"),
        (("--model", "none.npz"), "cannot read the model 'none.npz'"),
        (("--plots", "nowhere"), "is no folder"),
        (("--suite", "val_seen"), "add --data PACK"),
    ],
)
def test_bad_arguments_are_answered_with_a_sentence(
    model: Path, arguments: tuple[str, ...], sentence: str
) -> None:
    from robustnav_msgs_py.errors import RobustnavError

    if "--model" not in arguments:
        arguments = (*arguments, "--model", str(model))
    done = runner.invoke(app, ["bench", "instruction", "--episodes", "2", *arguments])
    assert done.exit_code != 0
    assert isinstance(done.exception, RobustnavError)
    assert sentence in str(done.exception)


def test_an_audit_of_another_file_is_refused(model: Path, tmp_path: Path) -> None:
    (tmp_path / "said.txt").write_text("turn left")
    done = runner.invoke(app, ["instruction", "audit", str(tmp_path / "said.txt"), "--model", str(model)])
    assert "name a file r2r_SPLIT.jsonl.gz" in str(done.exception)

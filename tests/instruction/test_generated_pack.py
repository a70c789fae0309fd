"""A generated pack is read by the loader of the real one, and holds what was generated."""

import json
import math
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.benchmarks.generated_instructions import (
    GenerationPlan,
    generated_instructions,
    write_generated_pack,
)
from robustnav_nodes.benchmarks.instruction_statistics import pack_statistics
from robustnav_nodes.cli import app
from robustnav_nodes.instruction.episodes import ERROR_TYPES
from robustnav_nodes.instruction.injection import PROTOCOLS
from robustnav_nodes.instruction.pack_lines import PackFolder
from robustnav_nodes.instruction.r2r_pack import R2rPack
from robustnav_nodes.instruction.tokens import tokenized

PLAN = GenerationPlan(seed=4200, homes=1, unseen=1, walks=5, walks_seen=2, writers=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("generated") / "pack"
    write_generated_pack(PLAN, out, workers=1)
    return out


def test_the_loader_reads_what_was_generated(folder: Path) -> None:
    """Values agree with those that never were in a file, but for rounding."""
    read = R2rPack(folder).instructions("val_unseen")
    made = list(generated_instructions(PLAN, "val_unseen", workers=1))
    assert [one.key for one in read] == [one.key for one in made]
    for ours, theirs in zip(made, read, strict=True):
        assert (ours.tokens, ours.group) == (theirs.tokens, theirs.group)
        for here, there in zip(ours.trajectory.viewpoints, theirs.trajectory.viewpoints, strict=True):
            assert there.place == here.place
            assert there.x_m == pytest.approx(here.x_m, abs=1e-3)
            assert math.remainder(there.yaw_in_rad - here.yaw_in_rad, math.tau) == pytest.approx(
                0.0, abs=5e-3
            )
            assert there.rooms == pytest.approx(here.rooms, abs=1e-9)
            assert [seen.name for seen in there.objects] == [seen.name for seen in here.objects]
            for one, other in zip(here.objects, there.objects, strict=True):
                assert one.bearing_rad is not None
                assert other.bearing_rad is not None
                turned = math.remainder(one.bearing_rad - other.bearing_rad, math.tau)
                assert turned == pytest.approx(0.0, abs=1e-2)
                assert other.range_m == pytest.approx(one.range_m, abs=5e-3)


def test_splits_share_homes_as_they_should(folder: Path) -> None:
    pack = R2rPack(folder)
    assert pack.splits == ("train", "val_seen", "val_unseen")
    homes = {split: {one.group for one in pack.instructions(split)} for split in pack.splits}
    assert homes["val_seen"] <= homes["train"]
    assert not homes["val_unseen"] & homes["train"]


def test_alignments_cover_the_instruction(folder: Path) -> None:
    for line in PackFolder(folder).rows("r2r_val_unseen.jsonl.gz"):
        for said, chunks in zip(line.texts("instructions"), line.items("sub_instructions"), strict=True):
            assert sum(len(words) for words, _, _ in chunks) <= len(tokenized(said))
            assert all(0 <= first <= last < len(line.texts("path")) for _, first, last in chunks)


def test_data_seeds_share_no_home() -> None:
    """Not neighbouring ones, nor what one trains in and another judges on."""
    plans = [GenerationPlan(seed=seed, homes=300, unseen=60) for seed in range(4)]
    seeds = [plan.seed_of(home) for plan in plans for home in range(plan.homes + plan.unseen)]
    seeds += [GenerationPlan(seed=seed, homes=100_000, unseen=0).seed_of(99_999) for seed in range(4)]
    assert len(set(seeds)) == len(seeds)
    assert GenerationPlan(seed=1, homes=0, unseen=1).seed_of(0) == plans[1].seed_of(300)
    with pytest.raises(BadParameterError, match="too many for one seed"):
        GenerationPlan(seed=1, homes=100_001, unseen=0)


def test_errors_are_pairs_and_one_word_away(folder: Path) -> None:
    pack = R2rPack(folder)
    clean = {one.key: one.tokens for one in pack.instructions("train")}
    found = 0
    for protocol in PROTOCOLS:
        for error_type in ERROR_TYPES:
            episodes = pack.episodes("train", protocol, error_type)
            assert sum(episode.label for episode in episodes) * 2 == len(episodes)
            for episode in episodes:
                if not episode.label:
                    assert episode.tokens == clean[episode.key.rpartition("_")[0]]
                found += len(episode.wrong)
    assert found > 20


def test_the_same_seed_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    write_generated_pack(PLAN, tmp_path / "again", workers=1)
    assert (tmp_path / "again" / "SHA256SUMS").read_text() == (folder / "SHA256SUMS").read_text()


def test_a_pack_is_not_written_over(folder: Path) -> None:
    with pytest.raises(BadFileError, match="holds a pack already"):
        write_generated_pack(PLAN, folder, workers=1)


def test_statistics_command(folder: Path, tmp_path: Path) -> None:
    report = tmp_path / "statistics.json"
    done = CliRunner().invoke(
        app, ["data", "statistics", str(folder), "--split", "train", "--json", str(report)]
    )
    assert done.exit_code == 0, done.output
    rows = json.loads(report.read_text())["rows"]
    assert len(rows) == len(PROTOCOLS) * len(ERROR_TYPES)
    for row in rows:
        assert row["episodes"] == 0 or row["errors_per_episode"] == sum(1 for n in row["kinds"].values() if n)
    assert rows[0]["thesis"]["episodes"] == 3218


def test_more_can_be_put_in_where_nothing_has_to_make_sense(folder: Path) -> None:
    likely, any_at_all = (
        sum(row.statistics.episodes for row in pack_statistics(folder, ["train"], common_sense=common_sense))
        for common_sense in (True, False)
    )
    assert any_at_all > likely > 0

"""What models of instruction errors learn from and are judged on: a pack, or homes made for it."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from robustnav_nodes.benchmarks.generated_instructions import (
    VAL_UNSEEN,
    GenerationPlan,
    generated_instructions,
)
from robustnav_nodes.benchmarks.instruction_bench import chosen_pairs
from robustnav_nodes.instruction.common_sense import CommonSense, anything_goes, derive_common_sense
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction
from robustnav_nodes.instruction.injection import PROTOCOLS, Protocol, episodes_put_in
from robustnav_nodes.instruction.mention_data import Errors
from robustnav_nodes.instruction.model_file import SHIPPED, load_model
from robustnav_nodes.instruction.pack_errors import TRAIN
from robustnav_nodes.instruction.r2r_pack import R2rPack
from robustnav_nodes.instruction.wording import learn_wording

BENCH_HOMES = 40

Episodes = dict[Protocol, dict[str, list[ErrorEpisode]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Lessons:
    """Instructions to learn from, what may be confused in them, errors that are there, and their origin."""

    instructions: Sequence[Instruction]
    common_sense: CommonSense
    name: str
    errors: Errors = field(default_factory=dict)


def lessons_of(
    data: Path | None, split: str, homes: int, seed: int, say: Callable[[str], object] = lambda told: None
) -> Lessons:
    """Of a pack, or of `homes` homes made for `seed`. Raises BadFileError for a pack that is none."""
    if data is not None:
        pack = R2rPack(data)
        return Lessons(
            instructions=pack.instructions(split),
            common_sense=pack.common_sense(),
            name=f"{data.name}, {split}",
            errors={
                protocol: [one for name in ERROR_TYPES for one in pack.episodes(split, protocol, name)]
                for protocol in PROTOCOLS
                if pack.has_episodes(split, protocol)
            },
        )
    plan = GenerationPlan(seed=seed, homes=homes, unseen=0)
    instructions = list(generated_instructions(plan, TRAIN, _workers(), say))
    return Lessons(
        instructions=instructions,
        common_sense=derive_common_sense(instructions),
        name=f"generated, {homes} homes of seed {seed}",
    )


def bench_episodes(
    data: Path | None,
    split: str,
    protocols: Sequence[Protocol],
    at_most: int | None,
    seed: int,
    *,
    common_sense: bool = True,
    say: Callable[[str], object] = lambda told: None,
) -> Episodes:
    """Clean and perturbed episodes by protocol and type of error, `at_most` of each.

    Of each protocol those of the pack where it holds any, else put in anew by the seed; always so without
    `common_sense`: any room may then replace any, and any object. Matched ones in homes made for this are
    drawn by the wording that comes along, whatever model is judged; in a pack by that of its `train`, which
    needs torch (BadParameterError). Raises BadFileError for a pack that is none, or has no such split.
    """
    pack = R2rPack(data) if data is not None else None
    found: Episodes = {}
    for protocol in protocols:
        if pack is not None and common_sense and pack.has_episodes(split, protocol):
            found[protocol] = {name: pack.episodes(split, protocol, name) for name in ERROR_TYPES}
    missing = [protocol for protocol in protocols if protocol not in found]
    if missing:
        wording = None
        if pack is None:
            plan = GenerationPlan(seed=seed, homes=0, unseen=BENCH_HOMES)
            instructions = list(generated_instructions(plan, VAL_UNSEEN, _workers(), say))
            if "matched" in missing:
                wording = load_model(SHIPPED).knowledge.wording
        else:
            instructions = pack.instructions(split)
            if "matched" in missing and split != TRAIN and TRAIN in pack.splits:
                wording = learn_wording(one.tokens for one in pack.instructions(TRAIN))
        if not common_sense:
            likely = anything_goes()
        else:
            likely = derive_common_sense(instructions) if pack is None else pack.common_sense()
        for protocol in missing:
            found[protocol] = episodes_put_in(instructions, likely, protocol, seed, wording=wording)
    return {
        protocol: {name: chosen_pairs(part, at_most, seed) for name, part in found[protocol].items()}
        for protocol in protocols
    }


def _workers() -> int:
    return len(os.sched_getaffinity(0))

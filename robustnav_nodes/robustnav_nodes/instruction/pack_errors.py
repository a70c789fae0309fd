"""Errors put into the clean instructions of a pack, as files of the pack: both protocols, all types."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from robustnav_nodes.instruction.common_sense import derive_common_sense
from robustnav_nodes.instruction.concepts import DIRECTION, pair_of
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction, WrongSpan
from robustnav_nodes.instruction.injection import PROTOCOLS, Injector, episodes_put_in, error_episodes
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.pack_writing import PackWriter
from robustnav_nodes.instruction.r2r_pack import R2rPack
from robustnav_nodes.instruction.wording import learn_wording

TRAIN = "train"


def write_errors(writer: PackWriter, splits: Sequence[str], seed: int) -> dict[str, int]:
    """Write priors.json and errors_*/ into a pack whose other files are written; count episodes by file.

    Common sense and wording are those of the split `train`, which must be there; in `train` itself the
    wording is that of other homes.
    """
    pack = R2rPack(writer.folder)
    clean = {split: pack.instructions(split) for split in splits}
    common_sense = derive_common_sense(clean[TRAIN])
    wording = learn_wording(instruction.tokens for instruction in clean[TRAIN])
    writer.row(
        "priors.json",
        {
            "room_adjacency": {name: list(others) for name, others in common_sense.rooms.items()},
            "object_colocation": {name: list(others) for name, others in common_sense.objects.items()},
        },
    )
    counts: dict[str, int] = {}
    for protocol in PROTOCOLS:
        in_train = episodes_put_in(clean[TRAIN], common_sense, protocol, seed)
        injector = Injector(common_sense=common_sense, wording=wording if protocol == "matched" else None)
        for split in splits:
            said = {instruction.key: instruction for instruction in clean[split]}
            for error_type in ERROR_TYPES:
                name = f"errors_{protocol}/{split}_{error_type}.jsonl.gz"
                episodes = (
                    in_train[error_type]
                    if split == TRAIN
                    else error_episodes(clean[split], error_type, injector, seed)
                )
                counts[name] = writer.rows(name, (_row(episode, said) for episode in episodes))
    return counts


def _row(episode: ErrorEpisode, said: Mapping[str, Instruction]) -> dict[str, Any]:
    key = episode.key.rpartition("_")[0]
    path_id, _, number = key.rpartition("_")
    return {
        "id": episode.key,
        "label": episode.label,
        "tokens": list(episode.tokens),
        "errors": list(_errors(episode, said[key].tokens)),
        "path_id": int(path_id),
        "instr": int(number),
        "scan": episode.group,
        "type": episode.error_type,
    }


def _errors(episode: ErrorEpisode, clean: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Each error with the words that stood there: the spans come in their order."""
    mentions = {mention.start: mention for mention in find_mentions(clean)}
    put_in = 0  # tokens more than in the clean instruction, so far
    for span in episode.wrong:
        mention = mentions[span.start - put_in]
        put_in += span.length - mention.length
        original = clean[mention.start : mention.start + mention.length]
        yield {
            "pos": span.start,
            "len": span.length,
            "kind": span.kind,
            "orig": " ".join(original),
            "new": " ".join(episode.tokens[span.start : span.start + span.length]),
            "frm": _concept(span, span.right),
            "to": _concept(span, span.wrong),
        }


def _concept(span: WrongSpan, concept: str) -> str:
    return pair_of(concept) if span.kind == DIRECTION else concept

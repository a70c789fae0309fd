"""What our model learns from: errors put into clean instructions, and every mention of them as a row."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction
from robustnav_nodes.instruction.injection import Injector, Protocol, error_episodes
from robustnav_nodes.instruction.mention_features.columns import Knowledge
from robustnav_nodes.instruction.mention_features.rows import MentionRows, mention_rows
from robustnav_nodes.instruction.mentions import Mention, find_mentions
from robustnav_nodes.instruction.scene import Scene, scene_of

Say = Callable[[str], None]
Errors = Mapping[Protocol, Sequence[ErrorEpisode]]
_TOLD_EVERY = 20_000  # episodes


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedRows:
    """Rows of many episodes: `episode` is the number of each row's episode, `wrong` 1 where it was put in."""

    values: NDArray[np.float32]
    episode: NDArray[np.int64]
    kind: NDArray[np.int64]  # an index into KINDS
    wrong: NDArray[np.int64]
    error_type: NDArray[np.int64]  # by episode, an index into ERROR_TYPES; a clean one has that of its pair
    label: NDArray[np.int64]  # by episode
    names: tuple[str, ...]  # of the columns of `values`
    blind: int

    @property
    def starts(self) -> NDArray[np.int64]:
        """int64 [episodes + 1]: where the rows of each episode begin, and where the last ends."""
        return np.searchsorted(self.episode, np.arange(len(self.label) + 1))


def training_episodes(
    instructions: Sequence[Instruction], injector_of: Callable[[str], Injector], draws: int, seed: int
) -> Iterator[ErrorEpisode]:
    """Every instruction clean and with each type of error, drawn `draws` times; an injector for each home.

    A pack that was made with the same seed holds other errors.
    """
    for number in range(draws):
        for one in instructions:
            injector = injector_of(one.group)
            for error_type in ERROR_TYPES:
                yield from error_episodes([one], error_type, injector, seed, number)


def rows_of(
    episodes: Sequence[ErrorEpisode],
    scenes: dict[int, Scene],
    knowledge_of: Callable[[str], Knowledge],
    say: Say,
) -> LearnedRows:
    """Describe every mention of every episode, each by the knowledge for its home."""
    values, episode, kind, wrong = [], [], [], []
    evidence: dict[tuple[int, int], Float64] = {}
    described: dict[tuple[int, tuple[str, ...]], tuple[tuple[Mention, ...], MentionRows]] = {}
    names: tuple[str, ...] = ()
    types = list(ERROR_TYPES)
    blind = 0
    for number, one in enumerate(episodes):
        walk = id(one.trajectory)
        knowledge = knowledge_of(one.group)
        scene = scenes[walk]
        if (walk, id(knowledge)) not in evidence:
            evidence[walk, id(knowledge)] = knowledge.places.evidence(scene)
        known = described.get((walk, one.tokens))  # clean ones come once for each type of error
        if known is None:
            mentions = find_mentions(one.tokens)
            rows = mention_rows(scene, evidence[walk, id(knowledge)], one.tokens, mentions, knowledge)
            if not one.wrong:
                described[walk, one.tokens] = mentions, rows
        else:
            mentions, rows = known
        names, blind = rows.names, rows.blind
        values.append(rows.values)
        episode += [number] * len(mentions)
        kind += [KINDS.index(m.kind) for m in mentions]
        wrong += [int(is_wrong(m, one)) for m in mentions]
        if number and number % _TOLD_EVERY == 0:
            say(f"described {number} of {len(episodes)} episodes")
    if not values or not sum(map(len, values)):
        raise BadParameterError(
            f"too few to learn from: in {len(episodes)} episodes nothing is mentioned that may be wrong"
        )
    return LearnedRows(
        values=np.concatenate(values),
        episode=np.array(episode, dtype=np.int64),
        kind=np.array(kind, dtype=np.int64),
        wrong=np.array(wrong, dtype=np.int64),
        error_type=np.array([types.index(one.error_type) for one in episodes], dtype=np.int64),
        label=np.array([one.label for one in episodes], dtype=np.int64),
        names=names,
        blind=blind,
    )


def is_wrong(mention: Mention, episode: ErrorEpisode) -> bool:
    """Whether a wrong span of its kind overlaps the mention."""
    return any(
        span.kind == mention.kind
        and span.start < mention.start + mention.length
        and mention.start < span.start + span.length
        for span in episode.wrong
    )


def part_of(rows: LearnedRows, episodes: NDArray[np.bool_]) -> LearnedRows:
    """The rows of some episodes, numbered anew."""
    kept = episodes[rows.episode]
    number = np.cumsum(episodes) - 1
    return LearnedRows(
        values=rows.values[kept],
        episode=number[rows.episode[kept]],
        kind=rows.kind[kept],
        wrong=rows.wrong[kept],
        error_type=rows.error_type[episodes],
        label=rows.label[episodes],
        names=rows.names,
        blind=rows.blind,
    )


def scenes_of(instructions: Iterable[Instruction | ErrorEpisode]) -> dict[int, Scene]:
    """By the identity of the trajectory, so that each is looked at once."""
    scenes: dict[int, Scene] = {}
    for one in instructions:
        if id(one.trajectory) not in scenes:
            scenes[id(one.trajectory)] = scene_of(one.trajectory)
    return scenes

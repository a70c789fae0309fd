"""What has to be beaten without learning: chance, and looking words up among what was seen."""

from collections.abc import Sequence

import numpy as np

from robustnav_nodes.instruction.concepts import HARDLY_LISTED, OBJECT, ROOM, ROOM_TYPES_OF
from robustnav_nodes.instruction.mentions import Mention, concepts_of_name, find_mentions
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, Trajectory
from robustnav_nodes.instruction.verdict import Verdict


class RandomGuess:
    """The thesis' random baseline: any score, any token; the seed and the words decide."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        del trajectory
        letters = [ord(letter) for letter in " ".join(tokens)]
        rng = np.random.default_rng([self._seed, *letters])
        order = rng.permutation(len(tokens))
        return Verdict(error_score=float(rng.uniform()), doubts=tuple((int(k), 0.0) for k in order))


class EntityGrounding:
    """A room or object that was said and never seen is wrong: the thesis' CLIP alignment, by names.

    A room counts as seen where the evidence for its type once exceeded `ROOM_SEEN`. The score is the share of
    what was said that was not seen; rooms without a type of evidence (closets) and doors, which no trajectory
    can be relied on to name, are not looked up.
    """

    ROOM_SEEN = 0.25

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        seen = {c for at in trajectory.viewpoints for one in at.objects for c in concepts_of_name(one.name)}
        rooms = [
            max((at.rooms[k] for at in trajectory.viewpoints), default=0.0) for k in range(len(ROOM_TYPES))
        ]
        said = [mention for mention in find_mentions(tokens) if _can_be_seen(mention)]
        missed = []
        for mention in said:
            if mention.kind == OBJECT:
                found = mention.concept in seen
            else:
                found = any(
                    rooms[ROOM_TYPES.index(name)] >= self.ROOM_SEEN for name in ROOM_TYPES_OF[mention.concept]
                )
            if not found:
                missed.append(mention)
        return Verdict(
            error_score=len(missed) / len(said) if said else 0.0,
            doubts=tuple((mention.start, 1.0) for mention in missed),
        )


def _can_be_seen(mention: Mention) -> bool:
    if mention.kind == ROOM:
        return mention.concept in ROOM_TYPES_OF
    return mention.kind == OBJECT and mention.concept not in HARDLY_LISTED

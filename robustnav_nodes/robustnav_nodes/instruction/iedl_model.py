"""IEDL as a judge: words to numbers, viewpoints to vectors, and the network's answer as a verdict."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.iedl import MAX_WORDS, Iedl, IedlShape
from robustnav_nodes.instruction.panorama import PanoramicEncoder
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.verdict import Verdict

if TYPE_CHECKING:
    from torch import Tensor

PADDING, RARE = 0, 1
_AT_LEAST = 3  # a word that is written less often is taken for any rare word


def learn_words(instructions: Iterable[Sequence[str]]) -> dict[str, int]:
    """A number, from 2 on, for each word that is not rare."""
    often = Counter(token for tokens in instructions for token in tokens)
    known = sorted(word for word, times in often.items() if times >= _AT_LEAST)
    return {word: RARE + 1 + k for k, word in enumerate(known)}


def word_numbers(words: Mapping[str, int], tokens: Sequence[str]) -> NDArray[np.int64]:
    """int64 [80]: what is longer is cut, what is shorter padded (thesis 4.1.3)."""
    numbers = np.full(MAX_WORDS, PADDING, dtype=np.int64)
    said = [words.get(token, RARE) for token in tokens[:MAX_WORDS]]
    numbers[: len(said)] = said
    return numbers


def batch_of_walks(encoded: Sequence[NDArray[np.float32]]) -> "tuple[Tensor, Tensor]":
    """Encoded viewpoints [B, T, places], padded to the longest walk, and a mask [B, T] of the real ones."""
    longest = max(len(one) for one in encoded)
    places = np.zeros((len(encoded), longest, encoded[0].shape[1]), dtype=np.float32)
    walked = np.zeros((len(encoded), longest), dtype=np.bool_)
    for row, one in enumerate(encoded):
        places[row, : len(one)], walked[row, : len(one)] = one, True
    return torch.from_numpy(places), torch.from_numpy(walked)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class IedlModel:
    """The thesis' model, learned; `words` numbers the words, `encoder` turns viewpoints into vectors."""

    network: Iedl
    words: Mapping[str, int]
    encoder: PanoramicEncoder

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        """An ErrorModel's; words after the 80th are not looked at."""
        words = torch.from_numpy(word_numbers(self.words, tokens)[None])
        words = words[:, : max(1, min(len(tokens), MAX_WORDS))]
        places, walked = batch_of_walks([self.encoder.encode(trajectory)])
        self.network.eval()
        with torch.inference_mode():
            logit, located = self.network(words, places, walked)
        shares = torch.softmax(located[0], dim=0).numpy()[: len(tokens)]
        order = np.argsort(-shares, kind="stable")
        return Verdict(
            error_score=float(torch.sigmoid(logit)[0]),
            doubts=tuple((int(k), float(shares[k])) for k in order),
        )


def arrays_of_iedl(model: IedlModel) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """What a file needs to hold: the weights in half precision, and the network's shape."""
    arrays: dict[str, NDArray[Any]] = {
        f"iedl/{name}": value.detach().numpy().astype(np.float16)
        for name, value in model.network.state_dict().items()
    }
    arrays["iedl_words"] = np.array(sorted(model.words, key=model.words.__getitem__))
    return arrays, asdict(model.network.shape)


def iedl_from_arrays(
    arrays: Mapping[str, NDArray[Any]], shape: Mapping[str, Any], encoder: PanoramicEncoder
) -> IedlModel:
    """The reverse; `encoder` is that of the training. Raises BadFileError where the arrays do not fit."""
    network = Iedl(IedlShape(**shape))
    if network.shape.places != encoder.width:
        raise BadFileError(
            f"IEDL was trained on viewpoints of {network.shape.places} numbers, and the encoder "
            f"{encoder.name!r} describes them by {encoder.width}: train it anew"
        )
    try:
        state = {
            name: torch.from_numpy(arrays[f"iedl/{name}"].astype(np.float32)) for name in network.state_dict()
        }
        network.load_state_dict(state)
        words = {str(word): RARE + 1 + k for k, word in enumerate(arrays["iedl_words"])}
    except (KeyError, RuntimeError) as error:
        raise BadFileError(f"the weights of IEDL do not fit together ({error}): train it anew") from error
    return IedlModel(network=network.eval(), words=words, encoder=encoder)

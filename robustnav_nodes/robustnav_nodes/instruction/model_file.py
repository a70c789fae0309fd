"""Learned models on disk: one .npz of plain arrays (no pickles) with ours, its blind twins and IEDL.

IEDL needs torch, ours does not: a robot that runs ours never imports it.
"""

import contextlib
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.injection import Protocol
from robustnav_nodes.instruction.mention_features.columns import Knowledge
from robustnav_nodes.instruction.mention_features.replacements import Replacements
from robustnav_nodes.instruction.mention_model import MentionModel, Scorer
from robustnav_nodes.instruction.mention_network import network_from_arrays
from robustnav_nodes.instruction.panorama import SEMANTIC, PanoramicEncoder, SemanticEncoder
from robustnav_nodes.instruction.place_model import PlaceModel
from robustnav_nodes.instruction.score_scale import ScoreScale
from robustnav_nodes.instruction.side_model import FEATURES as SIDE_FEATURES
from robustnav_nodes.instruction.side_model import SideModel
from robustnav_nodes.instruction.surprise import Surprise, surprise_from_arrays
from robustnav_nodes.instruction.trees import trees_from_arrays
from robustnav_nodes.instruction.wording import wording_from_weights

if TYPE_CHECKING:
    from robustnav_nodes.instruction.iedl_model import IedlModel

SHIPPED = Path(__file__).with_name("weights.npz")
FORMAT = 6
_WORDING = ("embedding", "bias", "out")
_PLACES = ("mean", "scale", "hidden", "out", "log_share", "climbs")


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnedModel:
    """What was learned, by (protocol, blind), and where from: data, seed, settings, figures at training."""

    knowledge: Knowledge
    features: tuple[str, ...]  # names of the columns that it was learned from
    scorers: Mapping[tuple[Protocol, bool], Scorer]
    surprise: Surprise
    card: Mapping[str, Any]
    iedl_arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)  # of iedl_model.arrays_of_iedl
    iedl_shape: Mapping[str, Any] | None = None  # None: IEDL was not trained
    iedl_encoder: str = SEMANTIC  # name of the encoder that IEDL was trained with

    def model(self, protocol: Protocol, *, blind: bool = False) -> MentionModel:
        """A judge for one protocol. Raises BadFileError where the file was not trained for it."""
        scorer = self.scorers.get((protocol, blind))
        if scorer is None:
            known = ", ".join(sorted({name for name, _ in self.scorers}))
            raise BadFileError(f"the model is not trained for the protocol {protocol!r}, only for {known}")
        return MentionModel(self.knowledge, scorer, self.features)

    def iedl(self, encoder: PanoramicEncoder | None = None) -> "IedlModel | None":
        """The thesis' model, where it was trained, with the encoder of its training (None: the semantic one).

        Raises BadFileError where that was another encoder, or the weights do not fit.
        """
        if self.iedl_shape is None:
            return None
        encoder = encoder or SemanticEncoder()
        if encoder.name != self.iedl_encoder:
            raise BadFileError(_other_encoder(self.iedl_encoder, encoder.name))
        from robustnav_nodes.instruction.iedl_model import iedl_from_arrays

        return iedl_from_arrays(self.iedl_arrays, self.iedl_shape, encoder)


def save_model(path: Path, model: LearnedModel) -> None:
    """Write the file whole or not at all. Raises BadFileError where it cannot be written."""
    arrays: dict[str, NDArray[Any]] = {
        "words": np.array(list(model.knowledge.wording.words)),
        **{f"wording/{part}": getattr(model.knowledge.wording, part).astype(np.float32) for part in _WORDING},
        "replacements": model.knowledge.replacements.log_share.astype(np.float32),
        **model.surprise.arrays(),
        **model.iedl_arrays,
    }
    for part in _PLACES:
        arrays[f"places/{part}"] = getattr(model.knowledge.places, part).astype(np.float32)
    arrays["sides/hidden"] = model.knowledge.places.sides.hidden.astype(np.float32)
    arrays["sides/out"] = model.knowledge.places.sides.out.astype(np.float32)
    scorers = []
    for (protocol, blind), scorer in model.scorers.items():
        name = f"{protocol}/{'blind' if blind else 'seeing'}"
        scale = scorer.scale
        arrays[f"{name}/scale"] = np.array([scale.offset, scale.factor, *scale.shifts])
        arrays.update(scorer.network.arrays(f"{name}/network"))
        for kind in KINDS:
            for number, trees in enumerate(scorer.trees[kind]):
                arrays.update(trees.arrays(f"{name}/{kind}/{number}"))
        count = {kind: len(scorer.trees[kind]) for kind in KINDS}
        scorers.append({"protocol": protocol, "blind": blind, "trees": count})
    header = {
        "format": FORMAT,
        "features": list(model.features),
        "scorers": scorers,
        "card": dict(model.card),
        "iedl": None if model.iedl_shape is None else dict(model.iedl_shape),
        "encoder": model.iedl_encoder,
    }
    unfinished = path.with_name(path.name + ".part")
    try:
        with unfinished.open("wb") as file:
            np.savez_compressed(file, header=np.array(json.dumps(header)), **arrays)  # type: ignore[arg-type]
        unfinished.replace(path)
    except OSError as error:
        raise BadFileError(f"cannot write the model {str(path)!r}: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            unfinished.unlink()


def load_model(path: Path) -> LearnedModel:
    """Read what `save_model` wrote. Raises BadFileError where it is something else."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(str(arrays["header"]))
        if header["format"] != FORMAT:
            raise BadFileError(
                f"the model {str(path)!r} is of format {header['format']!r}; this version reads {FORMAT}: "
                "train it anew"
            )
        return _model(arrays, header)
    except OSError as error:
        raise BadFileError(
            f"cannot read the model {str(path)!r}: {error.strerror or error}; `robustnav train iedl --data "
            "PACK` makes one"
        ) from error
    except (
        BadParameterError,
        ValueError,
        KeyError,
        TypeError,
        EOFError,
        zipfile.BadZipFile,
        zlib.error,
    ) as error:
        raise BadFileError(f"{str(path)!r} is no model of instruction errors: {error}") from error


def _model(arrays: Mapping[str, NDArray[Any]], header: Mapping[str, Any]) -> LearnedModel:
    features = len(header["features"])
    scorers: dict[tuple[Protocol, bool], Scorer] = {}
    for row in header["scorers"]:
        name = f"{row['protocol']}/{'blind' if row['blind'] else 'seeing'}"
        scorers[row["protocol"], bool(row["blind"])] = Scorer(
            trees={
                kind: tuple(
                    trees_from_arrays(arrays, f"{name}/{kind}/{number}", features)
                    for number in range(int(row["trees"][kind]))
                )
                for kind in KINDS
            },
            network=network_from_arrays(arrays, f"{name}/network", features),
            scale=_scale(arrays[f"{name}/scale"]),
            blind=bool(row["blind"]),
        )
    words = [str(word) for word in arrays["words"]]
    return LearnedModel(
        features=tuple(header["features"]),
        knowledge=Knowledge(
            places=PlaceModel(
                sides=_sides(arrays),
                **{part: arrays[f"places/{part}"].astype(np.float64) for part in _PLACES},
            ),
            wording=wording_from_weights(
                words, *(arrays[f"wording/{part}"].astype(np.float64) for part in _WORDING)
            ),
            replacements=Replacements(log_share=arrays["replacements"].astype(np.float64)),
        ),
        scorers=scorers,
        surprise=surprise_from_arrays(arrays),
        card=header["card"],
        iedl_arrays={name: array for name, array in arrays.items() if name.startswith("iedl")},
        iedl_shape=header["iedl"],
        iedl_encoder=str(header.get("encoder", SEMANTIC)),  # before there was a choice none was named
    )


def _other_encoder(trained: str, given: str) -> str:
    """A sentence; the other encoders than the semantic one are CLIP's."""
    if given == SEMANTIC:
        return (
            f"this IEDL looks at pictures ({trained}): name the folder of its CLIP with --clip-folder, or "
            "leave IEDL out with --models"
        )
    if trained == SEMANTIC:
        return f"this IEDL looks at no pictures, and {given} was given: leave out --clip-folder"
    return f"this IEDL was trained with {trained}, and --clip-folder holds {given}: name the former's folder"


def _scale(array: NDArray[Any]) -> ScoreScale:
    offset, factor, *shifts = array.astype(np.float64).tolist()
    return ScoreScale(offset=offset, factor=factor, shifts=np.array(shifts))


def _sides(arrays: Mapping[str, NDArray[Any]]) -> SideModel:
    hidden, out = (arrays[f"sides/{part}"].astype(np.float64) for part in ("hidden", "out"))
    return SideModel(
        hidden=_shaped(hidden, (SIDE_FEATURES + 1, hidden.shape[1])), out=_shaped(out, (hidden.shape[1] + 1,))
    )


def _shaped(array: NDArray[Any], shape: tuple[int, ...]) -> NDArray[Any]:
    if array.shape != shape:
        raise ValueError(f"an array is {array.shape}, not {shape}")
    return array

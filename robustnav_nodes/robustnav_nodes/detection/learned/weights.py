"""The weights file: arrays and what they are for, checked as it is read. Nothing in it is ever executed."""

import hashlib
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.detection.learned.network import DetectorNetwork, LookNetwork, Widths

FORMAT = "robustnav detector 3"
SHIPPED = Path(__file__).with_name("weights.npz")
REMEDY = "train them anew with `robustnav train detector`, or leave `model` empty for those that come along"
_FACTS, _DETECTOR, _LOOK = "facts", "detector.", "look."


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Weights:
    """Two trained networks and the names of their classes, in the order of their numbers."""

    labels: tuple[str, ...]
    widths: Widths
    detector: DetectorNetwork
    look: LookNetwork


def save_weights(path: Path, weights: Weights) -> None:
    """Write them with half precision, which costs no accuracy; the folder must exist."""
    arrays = {
        **_arrays(_DETECTOR, weights.detector),
        **_arrays(_LOOK, weights.look),
    }
    facts = {
        "format": FORMAT,
        "labels": weights.labels,
        "widths": asdict(weights.widths),
        "sha256": _digest(arrays),
    }
    with path.open("wb") as file:
        np.savez_compressed(file, **{_FACTS: np.array(json.dumps(facts))}, **arrays)  # type: ignore[arg-type]


def digest_of(weights: Weights) -> str:
    """What tells these weights from others; the same after they were saved and read."""
    return _digest({**_arrays(_DETECTOR, weights.detector), **_arrays(_LOOK, weights.look)})


def load_weights(path: Path = SHIPPED, labels: Sequence[str] | None = None) -> Weights:
    """Read weights, ready for use.

    Raises BadFileError where there are none, where they are damaged, and where they are not for `labels` in
    this order.
    """
    if not path.is_file():
        raise BadFileError(f"there is no weights file {str(path)!r}; {REMEDY}")
    try:
        with np.load(path, allow_pickle=False) as read:
            arrays = {name: read[name] for name in read.files}
        facts = json.loads(str(arrays.pop(_FACTS)))
        known = tuple(str(label) for label in facts["labels"])
        sizes = facts["widths"]
        widths = Widths(
            channels=tuple(sizes["channels"]),
            blocks=tuple(sizes["blocks"]),
            neck=sizes["neck"],
            head=sizes["head"],
        )
        known_format, whole = str(facts["format"]), facts["sha256"] == _digest(arrays)
    except (OSError, EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise BadFileError(
            f"the weights file {str(path)!r} is cut short or is none ({error}); {REMEDY}"
        ) from error
    if known_format != FORMAT:
        raise BadFileError(
            f"the weights file {str(path)!r} is of format {known_format!r}, this version reads {FORMAT!r}; "
            f"{REMEDY}"
        )
    if not whole:
        raise BadFileError(f"the weights file {str(path)!r} is damaged: its check sum differs; {REMEDY}")
    if labels is not None and tuple(labels) != known:
        raise BadFileError(
            f"the weights file {str(path)!r} is for other classes: {_difference(known, labels)}; {REMEDY}"
        )
    weights = Weights(
        labels=known, widths=widths, detector=DetectorNetwork(len(known), widths), look=LookNetwork()
    )
    _fill(path, weights.detector, _DETECTOR, arrays)
    _fill(path, weights.look, _LOOK, arrays)
    return weights


def _arrays(prefix: str, network: torch.nn.Module) -> dict[str, NDArray[np.generic]]:
    return {
        prefix + name: (value.half() if value.is_floating_point() else value).numpy()
        for name, value in network.state_dict().items()
    }


def _digest(arrays: Mapping[str, NDArray[np.generic]]) -> str:
    digest = hashlib.sha256()
    for name in sorted(arrays):
        digest.update(f"{name} {arrays[name].dtype} {arrays[name].shape}".encode())
        digest.update(np.ascontiguousarray(arrays[name]).tobytes())
    return digest.hexdigest()


def _fill(
    path: Path, network: torch.nn.Module, prefix: str, arrays: Mapping[str, NDArray[np.generic]]
) -> None:
    state = {
        name.removeprefix(prefix): torch.from_numpy(array)
        for name, array in arrays.items()
        if name.startswith(prefix)
    }
    try:
        network.load_state_dict(state)
    except RuntimeError as error:
        raise BadFileError(
            f"the weights file {str(path)!r} does not fit the network: {str(error).splitlines()[1].strip()} "
            f"{REMEDY}"
        ) from error
    network.eval()
    network.to(memory_format=torch.channels_last)


def _difference(known: Sequence[str], wanted: Sequence[str]) -> str:
    missing = [label for label in wanted if label not in known]
    surplus = [label for label in known if label not in wanted]
    if not missing and not surplus:
        return "the same ones in another order"
    return f"it lacks {missing!r} and has {surplus!r} beyond those asked for"

"""The thesis' panoramic encoder: pictures around each viewpoint through CLIP (ViT-B/16), from a folder."""

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from transformers import AutoImageProcessor, CLIPVisionModelWithProjection
from transformers.utils.logging import disable_progress_bar, set_verbosity_error

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.trajectory import Trajectory

Picture = NDArray[np.uint8]
_ERROR_LENGTH = 200
_DIGEST_DIGITS = 12
# What says where and by which version a model was saved, not what it computes.
_OF_THE_FILE = ("_name_or_path", "name_or_path", "transformers_version")


class ClipEncoder:
    """A PanoramicEncoder: the mean of the image embeddings of a place's pictures, of length one.

    `pictures_of` gives the pictures taken at a place, by the `place` of a Viewpoint, uint8
    [height, width, 3] each, RGB; a place without any becomes zeros. It is asked once for each place: the
    vector is kept, 2 kB with ViT-B/16. Nothing is downloaded. One thread.
    """

    def __init__(self, folder: Path, pictures_of: Callable[[str], Sequence[Picture]]) -> None:
        """Read a CLIP model that transformers saved (seconds). Raises BadFileError where it is none."""
        disable_progress_bar()  # a node has no screen
        set_verbosity_error()  # nor a reader for the words' half of a CLIP, which is not read here
        try:
            self._processor: Any = AutoImageProcessor.from_pretrained(str(folder), local_files_only=True)
            model: Any
            model, report = CLIPVisionModelWithProjection.from_pretrained(
                str(folder), local_files_only=True, output_loading_info=True
            )
        except Exception as error:  # transformers raises whatever its readers raise
            said = " ".join(str(error).split())[:_ERROR_LENGTH]
            raise BadFileError(
                f"cannot read a CLIP model of transformers from {str(folder)!r}; is it whole, with its image "
                f"processor? {type(error).__name__}: {said}"
            ) from error
        lacking = report["missing_keys"]
        if lacking:  # transformers reads of another model what fits, and makes up the rest
            raise BadFileError(
                f"{str(folder)!r} is no CLIP with its projection (it is {model.config.model_type!r}): it "
                f"lacks {len(lacking)} of its weights, {min(lacking)} among them"
            )
        self._model = model.float().eval()
        self._pictures_of = pictures_of
        self._known = {"": np.zeros(self.width, dtype=np.float32)}
        self._name = f"clip {_digest(self._model, self._processor)}"

    @property
    def name(self) -> str:
        """Tells one CLIP from another by a digest of its weights and settings, and those of its pictures."""
        return self._name

    @property
    def width(self) -> int:
        """Length of the vectors: 512 with ViT-B/16."""
        return int(self._model.config.projection_dim)

    def encode(self, trajectory: Trajectory) -> NDArray[np.float32]:
        """Float32 [T, width]; see PanoramicEncoder. Raises what `pictures_of` raises."""
        rows = np.zeros((max(1, len(trajectory)), self.width), dtype=np.float32)
        for at, viewpoint in enumerate(trajectory.viewpoints):
            if viewpoint.place not in self._known:
                self._known[viewpoint.place] = self._embedding(self._pictures_of(viewpoint.place))
            rows[at] = self._known[viewpoint.place]
        return rows

    def _embedding(self, pictures: Sequence[Picture]) -> NDArray[np.float32]:
        if not pictures:
            return np.zeros(self.width, dtype=np.float32)
        inputs = self._processor(
            images=list(pictures), input_data_format="channels_last", return_tensors="pt"
        )
        with torch.inference_mode():
            found = self._model(pixel_values=inputs["pixel_values"]).image_embeds
        unit = torch.nn.functional.normalize(found, dim=1).mean(dim=0)
        embedding: NDArray[np.float32] = torch.nn.functional.normalize(unit, dim=0).numpy()
        return embedding


def _digest(model: Any, processor: Any) -> str:
    found = hashlib.sha256()
    for settings in (model.config.to_dict(), processor.to_dict()):
        kept = {name: value for name, value in settings.items() if name not in _OF_THE_FILE}
        found.update(json.dumps(kept, sort_keys=True, default=str).encode())
    for name, weights in sorted(model.state_dict().items()):
        found.update(name.encode())
        found.update(weights.contiguous().numpy().data)
    return found.hexdigest()[:_DIGEST_DIGITS]

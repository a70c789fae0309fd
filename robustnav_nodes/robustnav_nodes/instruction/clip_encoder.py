"""The thesis' panoramic encoder: pictures around each viewpoint through CLIP (ViT-B/16), from a folder."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from transformers import AutoImageProcessor, CLIPVisionModelWithProjection
from transformers.utils.logging import disable_progress_bar

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.trajectory import Trajectory, Viewpoint

Picture = NDArray[np.uint8]
_ERROR_LENGTH = 200


class ClipEncoder:
    """A PanoramicEncoder: the mean of the image embeddings of a viewpoint's pictures, of length one.

    `pictures_of` gives the pictures taken at a viewpoint, uint8 [height, width, 3] each, RGB; a viewpoint
    without any becomes zeros. Nothing is downloaded.
    """

    def __init__(self, folder: Path, pictures_of: Callable[[Viewpoint], Sequence[Picture]]) -> None:
        """Read a CLIP model that transformers saved (seconds). Raises BadFileError where it is none."""
        disable_progress_bar()  # a node has no screen
        try:
            self._processor: Any = AutoImageProcessor.from_pretrained(str(folder), local_files_only=True)
            model: Any = CLIPVisionModelWithProjection.from_pretrained(str(folder), local_files_only=True)
        except Exception as error:  # transformers raises whatever its readers raise
            said = " ".join(str(error).split())[:_ERROR_LENGTH]
            raise BadFileError(
                f"cannot read a CLIP model of transformers from {str(folder)!r}; is it whole, with its image "
                f"processor? {type(error).__name__}: {said}"
            ) from error
        self._model = model.eval()
        self._pictures_of = pictures_of

    @property
    def width(self) -> int:
        """Length of the vectors: 512 with ViT-B/16."""
        return int(self._model.config.projection_dim)

    def encode(self, trajectory: Trajectory) -> NDArray[np.float32]:
        """Float32 [T, width]; see PanoramicEncoder."""
        rows = np.zeros((max(1, len(trajectory)), self.width), dtype=np.float32)
        for at, viewpoint in enumerate(trajectory.viewpoints):
            pictures = list(self._pictures_of(viewpoint))
            if pictures:
                rows[at] = self._embedding(pictures)
        return rows

    def _embedding(self, pictures: Sequence[Picture]) -> NDArray[np.float32]:
        inputs = self._processor(
            images=list(pictures), input_data_format="channels_last", return_tensors="pt"
        )
        with torch.inference_mode():
            found = self._model(pixel_values=inputs["pixel_values"]).image_embeds
        unit = torch.nn.functional.normalize(found, dim=1).mean(dim=0)
        embedding: NDArray[np.float32] = torch.nn.functional.normalize(unit, dim=0).numpy()
        return embedding

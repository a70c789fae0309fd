"""Detectors that look for whatever they are told in words: OWL-ViT, OWLv2 and Grounding DINO class models."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from transformers import AutoModelForZeroShotObjectDetection, AutoProcessor
from transformers.utils.logging import disable_progress_bar

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.suppression import suppress

OWL = ("owlvit", "owlv2")
GROUNDING_DINO = ("grounding-dino", "mm-grounding-dino")


class OpenVocabularyDetector:
    """A PixelDetector whose classes are any names, by a model that transformers saved in a folder.

    Nothing is downloaded. The names are all that is told to the model; the words around them are ours.
    """

    def __init__(self, folder: Path, *, labels: Sequence[str], score_min: float, nms_iou: float) -> None:
        """Read the model (seconds). Raises BadFileError where the folder does not hold one that is known."""
        self.labels = tuple(labels)
        self._score_min = score_min
        self._nms_iou = nms_iou
        disable_progress_bar()  # a node has no screen
        try:
            self._processor: Any = AutoProcessor.from_pretrained(str(folder), local_files_only=True)
            model: Any = AutoModelForZeroShotObjectDetection.from_pretrained(
                str(folder), local_files_only=True
            )
        except Exception as error:  # transformers raises whatever its readers raise
            raise BadFileError(
                f"cannot read a zero-shot detector of transformers from {str(folder)!r}; is it whole, with "
                f"its processor? {type(error).__name__}: {_shortened(str(error))}"
            ) from error
        self._kind = str(model.config.model_type)
        if self._kind not in (*OWL, *GROUNDING_DINO):
            raise BadFileError(
                f"{str(folder)!r} holds a model of type {self._kind!r}; "
                f"known are {', '.join((*OWL, *GROUNDING_DINO))}"
            )
        self._model = model.eval()

    def detect(self, image: ColorImage) -> Boxes:
        """See PixelDetector."""
        with torch.inference_mode():
            box_px, by_class = self._owl(image) if self._kind in OWL else self._grounding_dino(image)
        label = by_class.argmax(axis=1)
        score = by_class[np.arange(len(label)), label]
        kept = (score >= self._score_min) & np.isfinite(box_px).all(axis=1)
        height, width = image.pixels.shape[:2]
        found = Boxes(
            box_px=np.clip(box_px[kept], 0.0, np.array([width, height] * 2)).astype(np.float32),
            score=score[kept].astype(np.float32),
            label=label[kept].astype(np.uint32),
        )
        return suppress(found, self._nms_iou)

    def _owl(self, image: ColorImage) -> tuple[Float32, Float32]:
        """Boxes [n, 4] in the image, and scores [n, classes]."""
        prompts = [f"a photo of a {label}" for label in self.labels]
        inputs = self._processor(
            text=[prompts], images=image.pixels, input_data_format="channels_last", return_tensors="pt"
        )
        outputs = self._model(**inputs)
        placed = self._processor.post_process_grounded_object_detection(
            outputs, threshold=-1.0, target_sizes=[image.pixels.shape[:2]]
        )[0]
        return placed["boxes"].numpy(), torch.sigmoid(outputs.logits[0]).numpy()

    def _grounding_dino(self, image: ColorImage) -> tuple[Float32, Float32]:
        """Boxes [n, 4] in the image, and scores [n, classes]: of each class the best of its words' tokens."""
        prompt, spans = _one_prompt(self.labels)
        inputs = self._processor(
            text=prompt, images=image.pixels, input_data_format="channels_last", return_tensors="pt"
        )
        outputs = self._model(**inputs)
        tokens = self._processor.tokenizer(prompt, return_offsets_mapping=True)["offset_mapping"]
        by_token = torch.sigmoid(outputs.logits[0]).numpy()
        by_class = np.stack(
            [
                by_token[:, [at for at, (low, high) in enumerate(tokens) if begin <= low < high <= end]].max(
                    axis=1, initial=0.0
                )
                for begin, end in spans
            ],
            axis=1,
        )
        centre, half = np.split(outputs.pred_boxes[0].numpy() * [1.0, 1.0, 0.5, 0.5], 2, axis=1)
        height, width = image.pixels.shape[:2]
        box_px = np.concatenate([centre - half, centre + half], axis=1) * ([width, height] * 2)
        return box_px.astype(np.float32), by_class


def _one_prompt(labels: Sequence[str]) -> tuple[str, list[tuple[int, int]]]:
    """`mug. coffee cup.`, and where each name stands in it; dots in a name would end it."""
    prompt, spans = "", []
    for label in labels:
        name = label.lower().replace(".", " ").strip()
        spans.append((len(prompt), len(prompt) + len(name)))
        prompt += f"{name}. "
    return prompt.strip(), spans


def _shortened(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 200 else line[:197] + "..."

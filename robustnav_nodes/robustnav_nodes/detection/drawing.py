"""The image with the boxes drawn in, to look at."""

import dataclasses
from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from robustnav_msgs_py.values import ColorImage, Detections

BOX_COLOR = (255, 150, 20)


def draw_boxes(image: ColorImage, detections: Detections, labels: Sequence[str]) -> ColorImage:
    """A copy of `image` with each detection's box, class and score."""
    canvas = Image.fromarray(image.pixels)
    pen = ImageDraw.Draw(canvas)
    for box, score, label in zip(detections.box_px, detections.score, detections.label, strict=True):
        u_min, v_min, u_max, v_max = (float(side) for side in box)
        pen.rectangle((u_min, v_min, u_max, v_max), outline=BOX_COLOR)
        pen.text((u_min + 1.0, max(0.0, v_min - 11.0)), f"{labels[label]} {score:.2f}", fill=BOX_COLOR)
    return dataclasses.replace(image, pixels=np.asarray(canvas))

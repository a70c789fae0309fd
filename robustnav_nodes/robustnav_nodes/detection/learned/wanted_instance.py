"""*This* mug, not any mug: of the boxes of one class, those whose object looks like the one in a picture."""

from pathlib import Path

import cv2
import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.detector import LearnedDetector
from robustnav_nodes.detection.learned.instance_matcher import InstanceMatcher

# The longer side of an object that fills its picture, once it is brought to a usual size.
WHOLE_PX = 100


class WantedInstance:
    """Leaves out the boxes of its class that do not look like it. Used from the detector's thread.

    `told` says in words which object it is, and what it was told by.
    """

    def __init__(
        self, detector: LearnedDetector, picture: ColorImage, *, label: str = "", height_m: float = 0.0
    ) -> None:
        """It is what the detector finds in `picture`: its surest box of class `label` ('': of any class).

        Where it finds none of that class, it is the whole picture. `height_m` is how tall it is (0: not
        known). Raises BadParameterError where the class is unknown, or neither given nor to be seen.
        """
        if label and label not in detector.labels:
            raise BadParameterError(
                f"instance_class {label!r} is no class of this detector; "
                f"it knows {', '.join(detector.labels)}"
            )
        found = detector.detect(picture)
        if label:
            found = found[found.label == detector.labels.index(label)]
        elif not len(found):
            raise BadParameterError(
                "the detector knows nothing in instance_picture: say what it shows by instance_class"
            )
        if len(found):
            self.label, box_px = int(found.label[0]), found.box_px[0]
            u_min, v_min, u_max, v_max = (round(float(side)) for side in box_px)
            where = f"at ({u_min}, {v_min}) .. ({u_max}, {v_max}) px, score {found.score[0]:.2f}"
        else:
            self.label, where = detector.labels.index(label), "all of it"
            picture, box_px = _with_edges(picture)
        self.told = f"the {detector.labels[self.label]} in the picture, {where}"
        self._matcher = InstanceMatcher(detector, picture, box_px, height_m or None)

    def kept(self, image: ColorImage, boxes: Boxes, heights_m: Float32, likeness_min: float) -> Boxes:
        """Those of other classes, and those of its class that are at least so like it.

        heights_m [n]: how tall what each box shows is (NaN: not known).
        """
        stays = boxes.label != self.label
        own = np.flatnonzero(~stays)
        stays[own] = self._matcher.scores(image, boxes.box_px[own], heights_m[own]) >= likeness_min
        return boxes[stays]


def read_picture(path: Path) -> ColorImage:
    """A picture file (PNG, JPEG and others). Raises BadFileError where it is none."""
    pixels = cv2.imread(str(path), cv2.IMREAD_COLOR) if path.is_file() else None
    if pixels is None:
        raise BadFileError(f"instance_picture {str(path)!r} is no picture that can be read")
    rgb = np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB), dtype=np.uint8)
    return ColorImage(pixels=rgb, stamp_ns=0, frame_id="")


def _with_edges(picture: ColorImage) -> tuple[ColorImage, Float32]:
    """A picture of an object alone as one in which it is a third of each side, and its box there [4].

    A box at the edge of its image would count as cut.
    """
    rows, columns = picture.pixels.shape[:2]
    scale = WHOLE_PX / max(rows, columns)
    size = max(1, round(columns * scale)), max(1, round(rows * scale))
    small = cv2.resize(picture.pixels, size, interpolation=cv2.INTER_AREA)
    rows, columns = small.shape[:2]
    pixels = np.pad(small, ((rows, rows), (columns, columns), (0, 0)), mode="edge")
    box_px: Float32 = np.array([columns, rows, 2 * columns, 2 * rows], dtype=np.float32)
    return ColorImage(pixels=pixels, stamp_ns=picture.stamp_ns, frame_id=picture.frame_id), box_px

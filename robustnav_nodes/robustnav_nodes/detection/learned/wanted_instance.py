"""*This* mug, not any mug: of the boxes of one class, those whose object looks like the one in a picture."""

from pathlib import Path

import cv2
import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.detector import LearnedDetector
from robustnav_nodes.detection.learned.instance_matcher import InstanceMatcher


class WantedInstance:
    """Leaves out the boxes of its class that do not look like it. Used from the detector's thread."""

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
        rows, columns = picture.pixels.shape[:2]
        self.label = int(found.label[0]) if len(found) else detector.labels.index(label)
        self.box_px: Float32 = (
            found.box_px[0] if len(found) else np.array([0.0, 0.0, columns, rows], dtype=np.float32)
        )
        self._matcher = InstanceMatcher(detector, picture, self.box_px, height_m or None)

    def kept(self, image: ColorImage, boxes: Boxes, heights_m: Float32, likeness_min: float) -> Boxes:
        """Those of other classes, and those of its class that are at least so like it.

        heights_m [n]: how tall what each box shows is (NaN: not known).
        """
        likeness = self._matcher.scores(image, boxes.box_px, heights_m)
        return boxes[(boxes.label != self.label) | (likeness >= likeness_min)]


def read_picture(path: Path) -> ColorImage:
    """A picture file (PNG, JPEG and others). Raises BadFileError where it is none."""
    pixels = cv2.imread(str(path), cv2.IMREAD_COLOR) if path.is_file() else None
    if pixels is None:
        raise BadFileError(f"instance_picture {str(path)!r} is no picture that can be read")
    rgb = np.asarray(cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB), dtype=np.uint8)
    return ColorImage(pixels=rgb, stamp_ns=0, frame_id="")

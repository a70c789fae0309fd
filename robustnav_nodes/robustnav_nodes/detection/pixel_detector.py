"""What the back ends that look at pixels have in common."""

from typing import Protocol

from robustnav_msgs_py.values import ColorImage
from robustnav_nodes.detection.boxes import Boxes


class PixelDetector(Protocol):
    """Finds objects of its classes in one image at a time. Used from one thread.

    `labels` are the names of the classes, in the order of the numbers in `Boxes.label`.
    """

    labels: tuple[str, ...]

    def detect(self, image: ColorImage) -> Boxes:
        """The objects in an RGB image of any size, best first; none is an answer."""

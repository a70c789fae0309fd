"""How large what a box shows is: what tells a small mug from a large one, where depth is known."""

import numpy as np

from robustnav_msgs_py.values import Float32

# Columns of `extents`.
EXTENTS = 8
# A box that ends so near to the edge of its image may go on beyond it.
EDGE_PX = 1.0
# What counts as 0: the sides of a usual box, and of what is usually in it.
USUAL_PX, USUAL_M = 32.0, 0.15


def extents(box_px: Float32, metres_per_px: Float32, rows: int, columns: int) -> Float32:
    """For boxes [n, 4] in an image of so many rows and columns, float32 [n, EXTENTS].

    metres_per_px [n] is an object's depth over the focal length, NaN where it is not known. Logarithms of
    width and height in px and in m (0 where not known), whether they are known in m, and whether the box is
    cut at the upper edge of the image, the lower one, and at a side.
    """
    sides_px = np.maximum(box_px[:, 2:] - box_px[:, :2], 1.0)
    known = np.isfinite(metres_per_px) & (metres_per_px > 0.0)
    metres = np.where(known, metres_per_px, 1.0)[:, None]
    above = box_px[:, 1] <= EDGE_PX
    below = box_px[:, 3] >= rows - EDGE_PX
    aside = (box_px[:, 0] <= EDGE_PX) | (box_px[:, 2] >= columns - EDGE_PX)
    return np.column_stack(
        [
            np.log(sides_px / USUAL_PX),
            np.log(sides_px * metres / USUAL_M) * known[:, None],
            known,
            above,
            below,
            aside,
        ]
    ).astype(np.float32)

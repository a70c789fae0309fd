"""The rooms of a scene's map: what is left of the floor where no doorway is."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from robustnav_nodes.search_space.camera_view import CameraView

_HALF_DOOR_M = 0.5  # floor this near to a wall or to something tall is no middle of a room
_LEAST_MIDDLE_M2 = 0.25


def rooms_of(view: CameraView) -> NDArray[np.int64]:
    """int64 [k]: the room of each candidate, from 0: the one whose middle is nearest in a straight line.

    Middles are the parts of the floor, low furniture included, that are farther from what hides than half a
    door is wide. A place without any is one room.
    """
    scene, resolution_m = view.scene, view.scene.resolution_m
    clear_m = ndimage.distance_transform_edt(~scene.hides, sampling=resolution_m)
    middle, count = ndimage.label(clear_m > _HALF_DOOR_M)
    area_m2 = np.bincount(middle.ravel(), minlength=count + 1) * resolution_m**2
    middle[area_m2[middle] < _LEAST_MIDDLE_M2] = 0
    if not middle.any():
        return np.zeros(len(view.candidates), dtype=np.int64)
    row, column = ndimage.distance_transform_edt(middle == 0, return_distances=False, return_indices=True)
    height, width = middle.shape
    at_row = np.clip((view.candidates.y_m - scene.y_m) / resolution_m, 0, height - 1).astype(np.int64)
    at_column = np.clip((view.candidates.x_m - scene.x_m) / resolution_m, 0, width - 1).astype(np.int64)
    nearest = middle[row[at_row, at_column], column[at_row, at_column]]
    return np.unique(nearest, return_inverse=True)[1].reshape(-1).astype(np.int64)

"""Pictures of simulated homes with what is in them: where they are kept, and what is known of each object."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float32

PIXELS_FILE, OBJECTS_FILE = "pixels.npy", "objects.npz"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ObjectTable:
    """The objects of all pictures, one row for each object in each picture; sorted by picture.

    picture: int32 [n]; box_px: float32 [n, 4] around the visible pixels, upper bounds exclusive; label: int32
    [n]; look: int32 [n, 4], numbers of colour, substance, pattern and size; home, instance: int32 [n], which
    object it is; visible_px: int32 [n]; visible_fraction: float32 [n] in 0..1; distance_m, ahead_m: float32
    [n], from the camera to its centre, straight and along the optical axis; focal_px: float32 [n], of the
    camera.
    """

    picture: NDArray[np.int32]
    box_px: Float32
    label: NDArray[np.int32]
    look: NDArray[np.int32]
    home: NDArray[np.int32]
    instance: NDArray[np.int32]
    visible_px: NDArray[np.int32]
    visible_fraction: Float32
    distance_m: Float32
    ahead_m: Float32
    focal_px: Float32

    def __len__(self) -> int:
        return len(self.picture)

    def rows_of(self, picture: int) -> slice:
        """Where the objects of one picture stand."""
        first, last = np.searchsorted(self.picture, (picture, picture + 1))
        return slice(int(first), int(last))

    @classmethod
    def joined(cls, tables: "list[ObjectTable]") -> "ObjectTable":
        """All rows of the tables, in their order."""
        names = [field.name for field in fields(cls)]
        return cls(**{name: np.concatenate([getattr(table, name) for table in tables]) for name in names})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PictureSet:
    """Pictures, uint8 [n, height, width, 3] (mapped from the disk), and what is in them.

    labels: the names of the classes, in the order of their numbers.
    """

    pixels: NDArray[np.uint8]
    objects: ObjectTable
    labels: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.pixels)


def save_objects(folder: Path, objects: ObjectTable, labels: tuple[str, ...]) -> None:
    """Write what is in the pictures: last of all, so that a folder that has it is complete."""
    columns = {field.name: getattr(objects, field.name) for field in fields(ObjectTable)}
    np.savez(folder / OBJECTS_FILE, labels=np.array(labels), **columns)


def load_pictures(folder: Path) -> PictureSet:
    """Read what `render_pictures` made. Raises BadFileError where it is missing or not complete."""
    try:
        with np.load(folder / OBJECTS_FILE, allow_pickle=False) as read:
            labels = tuple(str(label) for label in read["labels"])
            objects = ObjectTable(**{field.name: read[field.name] for field in fields(ObjectTable)})
        pixels = np.load(folder / PIXELS_FILE, mmap_mode="r")
    except (OSError, KeyError, ValueError) as error:
        raise BadFileError(
            f"the pictures in {str(folder)!r} cannot be read ({error}); remove the folder to render them anew"
        ) from error
    return PictureSet(pixels=pixels, objects=objects, labels=labels)

"""The pictures of a pack, where it holds any: what a camera saw at each viewpoint, all around.

images/SCAN/VIEWPOINT/HEADING.jpg, one for each of HEADINGS_DEG: how many degrees the middle of the picture,
which was taken level, lies clockwise from +y, in three digits (000.jpg, 030.jpg … 330.jpg).
"""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.trajectory import Trajectory

HEADINGS_DEG = tuple(range(0, 360, 30))


class PackImages:
    """Reads pictures when they are asked for. Raises BadFileError where the pack holds none."""

    def __init__(self, pack: Path) -> None:
        self._folder = pack / "images"
        if not self._folder.is_dir():
            raise BadFileError(
                f"the pack {str(pack)!r} holds no pictures; CLIP looks at images/SCAN/VIEWPOINT/HEADING.jpg "
                "(000.jpg, 030.jpg … 330.jpg, degrees clockwise from +y)"
            )

    def check(self, walks: Iterable[Trajectory]) -> None:
        """Raises BadFileError where a picture of a viewpoint on these walks is missing."""
        for place in dict.fromkeys(viewpoint.place for walk in walks for viewpoint in walk.viewpoints):
            for path in self._paths(place):
                if not path.is_file():
                    raise BadFileError(f"the picture {str(path)!r} is missing")

    def at(self, place: str) -> list[NDArray[np.uint8]]:
        """Uint8 [height, width, 3] each, RGB, in the order of HEADINGS_DEG; `place` as a Viewpoint has it.

        Raises BadFileError where one is missing or is no picture.
        """
        return [_read(path) for path in self._paths(place)]

    def _paths(self, place: str) -> list[Path]:
        return [self._folder / place / f"{heading:03d}.jpg" for heading in HEADINGS_DEG]


def _read(path: Path) -> NDArray[np.uint8]:
    try:
        with Image.open(path) as picture:
            return np.asarray(picture.convert("RGB"))
    except FileNotFoundError as error:
        raise BadFileError(f"the picture {str(path)!r} is missing") from error
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise BadFileError(f"cannot read the picture {str(path)!r}: {error}") from error

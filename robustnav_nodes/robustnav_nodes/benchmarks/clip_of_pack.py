"""CLIP from a folder for IEDL, where the command line names one."""

from pathlib import Path
from typing import TYPE_CHECKING

from robustnav_msgs_py.errors import BadParameterError

if TYPE_CHECKING:
    from robustnav_nodes.instruction.clip_encoder import ClipEncoder
    from robustnav_nodes.instruction.pack_images import PackImages


def clip_of_pack(folder: Path, data: Path | None) -> "tuple[ClipEncoder, PackImages]":
    """The encoder, and the pictures of the pack `data` that it looks at; nothing is downloaded.

    Raises BadParameterError without a pack or without transformers, BadFileError where the folder holds no
    CLIP or the pack no pictures.
    """
    if data is None:
        raise BadParameterError(
            "CLIP looks at pictures, and the homes made for this have none: name a pack that holds images/ "
            "with --data"
        )
    try:
        from robustnav_nodes.instruction.clip_encoder import ClipEncoder
    except ImportError as error:
        raise BadParameterError(
            f"CLIP needs {error.name}, which is not installed: pip install 'robustnav[open-vocabulary]'"
        ) from error
    from robustnav_nodes.instruction.pack_images import PackImages

    images = PackImages(data)
    return ClipEncoder(folder, images.at), images

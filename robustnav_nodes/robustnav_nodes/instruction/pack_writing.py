"""Writes the files of a pack that `r2r_pack` reads: lines, conventions, and sums over all."""

import gzip
import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.pack_lines import SUMS
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_NO_TIME = 0  # gzip keeps none, so that the same pack has the same bytes whenever it is written


class PackWriter:
    """Writes into a folder that must not hold a pack yet. Raises BadFileError where that cannot be done."""

    def __init__(self, folder: Path) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BadFileError(f"cannot make the folder {str(folder)!r}: {error.strerror}") from error
        if (folder / "meta.json").exists():
            raise BadFileError(f"{str(folder)!r} holds a pack already; name another folder, or remove it")
        self.folder = folder
        self._written: list[str] = []

    def meta(self, **more: Any) -> None:
        """The file that names the conventions; `more` says where the data are from, and counts."""
        conventions = {
            "units": "metres, radians",
            "z": "up",
            "heading": "0 = +y, clockwise positive, [0,2pi)",
            "elevation": "positive up",
            "object_fields": [
                *("name", "heading", "elevation", "solid_angle_sr", "width", "height", "object_id"),
            ],
        }
        content = {"conventions": conventions, "rooms": list(ROOM_TYPES), **more}
        self._write("meta.json", (json.dumps(content, indent=1) + "\n").encode())

    def row(self, name: str, content: Mapping[str, Any]) -> None:
        """A .json file."""
        self._write(name, (json.dumps(content, indent=1) + "\n").encode())

    def rows(self, name: str, rows: Iterable[Mapping[str, Any]]) -> int:
        """A .jsonl.gz file; returns how many lines it has."""
        lines = [json.dumps(row, ensure_ascii=False, separators=(",", ":")) + "\n" for row in rows]
        self._write(name, gzip.compress("".join(lines).encode(), mtime=_NO_TIME))
        return len(lines)

    def sums(self) -> None:
        """SHA256SUMS over all that was written; what was written before is complete now."""
        lines = [
            f"{hashlib.sha256((self.folder / name).read_bytes()).hexdigest()}  {name}\n"
            for name in sorted(self._written)
        ]
        (self.folder / SUMS).write_text("".join(lines), encoding="utf-8")

    def _write(self, name: str, content: bytes) -> None:
        path = self.folder / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise BadFileError(f"cannot write {str(path)!r}: {error.strerror}") from error
        self._written.append(name)

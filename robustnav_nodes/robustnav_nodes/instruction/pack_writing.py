"""Writes the files of a pack that `r2r_pack` reads: lines, conventions, and sums over all."""

import contextlib
import gzip
import hashlib
import json
import os
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.pack_lines import SUMS
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_NO_TIME = 0  # gzip keeps none, so that the same pack has the same bytes whenever it is written


class PackWriter:
    """Writes a pack beside `folder`, and moves it there when all of it is written.

    Use it as a context: where that is left by an exception, nothing is left behind. `folder` must be missing
    or empty. Raises BadFileError where that is not so, or something cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self._target = folder.resolve()
        if os.path.ismount(self._target):
            raise BadFileError(
                f"{str(folder)!r} is a mounted disk, onto which no folder can be moved: name one in it"
            )
        if self._target.exists() and not self._is_empty():
            holds = "a pack" if (self._target / "meta.json").exists() else "something"
            raise BadFileError(f"{str(folder)!r} holds {holds} already; name another folder, or remove it")
        self.folder = self._target.with_name(f".{self._target.name}.{os.getpid()}.part")
        self._parents = [parent for parent in self._target.parents if not parent.exists()]
        self._written: list[str] = []

    def __enter__(self) -> Self:
        try:
            self.folder.mkdir(parents=True)
        except OSError as error:
            raise BadFileError(f"cannot make the folder {str(self.folder)!r}: {error.strerror}") from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self._sums()
                self._move()
        finally:
            self._clear()

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

    def _is_empty(self) -> bool:
        try:
            return self._target.is_dir() and not any(self._target.iterdir())
        except OSError as error:
            raise BadFileError(f"cannot read the folder {str(self._target)!r}: {error.strerror}") from error

    def _sums(self) -> None:
        lines = [
            f"{hashlib.sha256((self.folder / name).read_bytes()).hexdigest()}  {name}\n"
            for name in sorted(self._written)
        ]
        self._write(SUMS, "".join(lines).encode())

    def _move(self) -> None:
        try:
            self.folder.rename(self._target)  # which fails where the target is not empty any more
        except OSError as error:
            raise BadFileError(f"cannot move the pack to {str(self._target)!r}: {error.strerror}") from error

    def _clear(self) -> None:
        """Remove what was not moved, and the folders that were made for it."""
        shutil.rmtree(self.folder, ignore_errors=True)
        for parent in self._parents:
            with contextlib.suppress(OSError):  # one that holds something, as the moved pack, stays
                parent.rmdir()

    def _write(self, name: str, content: bytes) -> None:
        path = self.folder / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise BadFileError(f"cannot write {str(path)!r}: {error.strerror}") from error
        self._written.append(name)

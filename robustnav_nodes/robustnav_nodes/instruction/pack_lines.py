"""The files of a semantic R2R pack, line by line; what is not as it should be is said with file and line."""

import gzip
import hashlib
import json
import math
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError

SUMS = "SHA256SUMS"


def as_number(value: object) -> float | None:
    """The value as a float; None where it is no number, or one that no float holds (1e400, NaN)."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


class Row:
    """One line of a file, an object; it gives fields of the type asked for, or a sentence."""

    __slots__ = ("_fields", "where")

    def __init__(self, fields: Any, where: str) -> None:
        if not isinstance(fields, dict):
            raise BadFileError(f"{where} must hold an object, not {str(fields)[:60]!r}")
        self._fields = fields
        self.where = where

    def text(self, name: str) -> str:
        value = self._get(name)
        if not isinstance(value, str):
            raise self.wrong(name, value, "a text")
        return value

    def number(self, name: str) -> float:
        value = as_number(self._get(name))
        if value is None:
            raise self.wrong(name, self._get(name), "a finite number")
        return value

    def whole(self, name: str) -> int:
        value = self._get(name)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.wrong(name, value, "a whole number")
        return value

    def items(self, name: str) -> list[Any]:
        value = self._get(name)
        if not isinstance(value, list):
            raise self.wrong(name, value, "a list")
        return value

    def texts(self, name: str) -> list[str]:
        value = self.items(name)
        if not all(isinstance(item, str) for item in value):
            raise self.wrong(name, value, "a list of texts")
        return value

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        value = self.items(name)
        found = tuple(number for item in value if (number := as_number(item)) is not None)
        if len(value) != count or len(found) != count:
            raise self.wrong(name, value, f"{count} numbers")
        return found

    def rows(self, name: str) -> list["Row"]:
        return [Row(item, f"{self.where}, {name}[{k}],") for k, item in enumerate(self.items(name))]

    def named_texts(self, name: str) -> dict[str, tuple[str, ...]]:
        value = self._get(name)
        if not isinstance(value, dict) or not all(
            isinstance(words, list) and all(isinstance(word, str) for word in words)
            for words in value.values()
        ):
            raise self.wrong(name, value, "an object of lists of texts")
        return {key: tuple(words) for key, words in value.items()}

    def has(self, name: str) -> bool:
        return name in self._fields

    def flag(self, name: str) -> bool:
        value = self._get(name)
        if not isinstance(value, bool):
            raise self.wrong(name, value, "true or false")
        return value

    def objects(self, name: str) -> dict[str, "Row"]:
        """The objects in a field that is an object of objects, by their names."""
        value = self._get(name)
        if not isinstance(value, dict):
            raise self.wrong(name, value, "an object of objects")
        return {key: Row(item, f"{self.where}, {name}[{key!r}],") for key, item in value.items()}

    def wrong(self, name: str, value: object, wanted: str) -> BadFileError:
        """The error to raise where field `name` is `value`."""
        return BadFileError(f"{self.where} holds {name!r} = {str(value)[:60]!r}; it must be {wanted}")

    def _get(self, name: str) -> Any:
        if name not in self._fields:
            raise BadFileError(
                f"{self.where} has no field {name!r}; it has {', '.join(sorted(self._fields))}"
            )
        return self._fields[name]


class PackFolder:
    """A folder whose files are checked against its list of SHA-256 sums, where it has one."""

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise BadFileError(f"there is no pack at {str(folder)!r}: name the folder that holds meta.json")
        self.path = folder
        self._sums = self._read_sums()

    def has(self, name: str) -> bool:
        return (self.path / name).is_file()

    def row(self, name: str) -> Row:
        """The one object in a JSON file. Raises BadFileError."""
        return Row(_parsed(self._text(name), str(self.path / name)), str(self.path / name))

    def rows(self, name: str) -> Iterator[Row]:
        """The objects of a .jsonl.gz file, one a line. Raises BadFileError."""
        for number, line in enumerate(self._text(name).splitlines(), start=1):
            if line:
                where = f"line {number} of {str(self.path / name)!r}"
                yield Row(_parsed(line, where), where)

    def _text(self, name: str) -> str:
        path = self.path / name
        try:
            content = path.read_bytes()
        except OSError as error:
            raise BadFileError(
                f"the pack {str(self.path)!r} cannot be read: {name} is missing or closed ({error.strerror})"
            ) from error
        known = self._sums.get(name)
        if known is not None and hashlib.sha256(content).hexdigest() != known:
            raise BadFileError(
                f"{str(path)!r} is not the file that {SUMS} lists: it was changed or cut; copy the pack again"
            )
        try:
            return (gzip.decompress(content) if name.endswith(".gz") else content).decode("utf-8")
        except (OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
            raise BadFileError(f"{str(path)!r} cannot be unpacked: {error}") from error

    def _read_sums(self) -> dict[str, str]:
        if not (self.path / SUMS).is_file():
            return {}
        lines = (self.path / SUMS).read_text(encoding="utf-8", errors="replace").splitlines()
        return {words[1].lstrip("*"): words[0] for line in lines if len(words := line.split()) == 2}


def _parsed(text: str, where: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadFileError(f"{where} is not JSON: {error}") from error

"""The files of a bag whose recorder was killed: another recorder goes on after them, in a file of its own."""

import contextlib
import fcntl
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from bags.bag_metadata import FileRow, TopicRow, joined, read_metadata
from bags.mcap_file import McapFile
from bags.mcap_scan import open_file, summary_at_end
from bags.repair import RepairReport, repair_file
from robustnav_msgs_py.errors import BadFileError

CLOSED_ENTRY = "robustnav_closed"  # in metadata.yaml; a file's own end tells it of bags of other recorders


@dataclass(frozen=True, slots=True, kw_only=True)
class EarlierFiles:
    """What earlier files of a bag hold, for its metadata.yaml; what was repaired, and what could not be."""

    files: tuple[FileRow, ...] = ()
    topics: tuple[TopicRow, ...] = ()
    repairs: tuple[RepairReport, ...] = ()
    problems: tuple[str, ...] = ()


def file_name(folder: Path, number: int) -> str:
    """Name of a file of the bag in `folder`, as rosbag2 has it."""
    return f"{folder.name}_{number}.mcap"


def lock(stream: BinaryIO) -> bool:
    """Mark a file as being written until it is closed or the process ends; False where another one does."""
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks: nobody can tell
        return True
    return True


def find_earlier_files(folder: Path) -> tuple[Path, ...]:
    """Files of the bag that a killed recorder left in `folder`, in order; none where it wrote none.

    Takes no time: ends of files are looked at, not what they hold. Raises BadFileError where the bag was
    closed properly, is still being written, or where `folder` holds something else.
    """
    try:
        content = list(folder.iterdir())
    except OSError as error:
        raise BadFileError(f"{folder} cannot be read: {error.strerror or error}") from error
    numbered = {number: path for path in content if (number := _number(folder, path)) is not None}
    paths = tuple(numbered[number] for number in sorted(numbered))
    if content and not paths:
        raise BadFileError(f"{folder} exists already and is no bag; choose another name or move it away")
    for path in paths:
        with open_file(path) as stream:
            if not lock(stream):
                raise BadFileError(
                    f"{path} is being written by another recorder; choose another name or end that one"
                )
    if paths and _is_closed(folder, paths[-1]):
        raise BadFileError(
            f"{folder} exists already, was closed properly and is not overwritten; choose another name or "
            "move it away"
        )
    return paths


def next_number(folder: Path, earlier: Sequence[Path]) -> int:
    """Number of the file that follows `earlier`, files of the bag in `folder` in order."""
    last = _number(folder, earlier[-1]) if earlier else None
    return 0 if last is None else last + 1


def repair_earlier_files(paths: Sequence[Path]) -> EarlierFiles:
    """Repair those of `paths` that were cut, and count what they all hold.

    A file that cannot be repaired stays as it is and is counted as far as it is whole.
    """
    files: list[FileRow] = []
    topics: list[TopicRow] = []
    repairs: list[RepairReport] = []
    problems: list[str] = []
    for path in paths:
        try:
            if not has_sound_end(path):
                repairs.append(repair_file(path))
        except (BadFileError, OSError) as error:
            problems.append(f"{path} was cut and cannot be repaired: {error}")
        try:
            file, rows = counted(path)
        except BadFileError as error:
            problems.append(f"{path} is left out of the bag: {error}")
            continue
        files.append(file)
        topics.extend(rows)
    return EarlierFiles(
        files=tuple(files), topics=joined(topics), repairs=tuple(repairs), problems=tuple(problems)
    )


def counted(path: Path) -> tuple[FileRow, list[TopicRow]]:
    """What the file at `path` holds, as metadata.yaml tells it; raises BadFileError."""
    with contextlib.closing(McapFile(path)) as file:
        rows = [channel.row for channel in file.channels]
        start_ns, stop_ns = file.span_ns or (0, 0)
    count = sum(row.message_count for row in rows)
    told = FileRow(name=path.name, start_ns=start_ns, duration_ns=stop_ns - start_ns, message_count=count)
    return told, rows


def _number(folder: Path, path: Path) -> int | None:
    found = re.fullmatch(re.escape(folder.name) + r"_(\d+)\.mcap", path.name)
    return int(found[1]) if found else None


def _is_closed(folder: Path, last: Path) -> bool:
    if not has_sound_end(last):
        return False
    try:
        custom = read_metadata(folder).custom
    except BadFileError:  # it is the last that a recorder writes
        return False
    return all(entry.text != "no" for entry in custom if entry.name == CLOSED_ENTRY)


def has_sound_end(path: Path) -> bool:
    """Whether the file at `path` was finished; raises BadFileError where it cannot be opened."""
    with open_file(path) as stream:
        return summary_at_end(stream) is not None

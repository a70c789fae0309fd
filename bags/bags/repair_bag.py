"""Repair a bag whose recorder was killed or whose disk was full: its files, and metadata.yaml."""

import re
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from bags.bag_metadata import FILE_NAME, BagMetadata, joined, read_metadata
from bags.earlier_files import counted, has_sound_end, lock
from bags.mcap_scan import MAGIC, open_file, scan
from bags.repair import RepairReport, repair_file
from robustnav_msgs_py.errors import BadFileError


@dataclass(frozen=True, slots=True, kw_only=True)
class BagRepair:
    """What was repaired: of the bag that lies at `path` now, these files, and metadata.yaml or not."""

    path: Path
    files: tuple[RepairReport, ...]
    metadata_renewed: bool

    @property
    def sentences(self) -> tuple[str, ...]:
        """The report as a person reads it."""
        told = [report.sentence for report in self.files]
        if self.metadata_renewed:
            told.append(f"{self.path / FILE_NAME} was written anew")
        return tuple(told) or (f"{self.path} is whole: there is nothing to do",)


def repair_bag(path: Path, out: Path | None = None) -> BagRepair:
    """Repair the bag folder or the .mcap file at `path` in place, or into the new folder `out`.

    Each file stands as it was until its repaired one is whole on the disk. What is whole already is left
    alone (with `out`: copied). Raises BadFileError where there is no bag, nothing is left of it, it is being
    written, or `out` exists; OSError where the disk fails.
    """
    files = _files(path)
    for file in files:
        with open_file(file) as stream:
            if not lock(stream):
                raise BadFileError(f"{file} is being written; end its recorder first")
    if all(file.stat().st_size == 0 for file in files):
        raise BadFileError(f"{path} is empty: nothing was recorded, or the disk was full")
    if out is None:
        return _repaired(path, files)
    if out.exists():
        raise BadFileError(
            f"{out} exists already and is not overwritten; choose another name or move it away"
        )
    try:
        staged = Path(tempfile.mkdtemp(prefix=f".{out.name}.", dir=out.parent))
    except OSError as error:
        raise BadFileError(f"a bag cannot be written to {out}: {error.strerror or error}") from error
    try:
        for file in files:
            shutil.copyfile(file, staged / file.name)
        if path.is_dir() and (path / FILE_NAME).is_file():
            shutil.copyfile(path / FILE_NAME, staged / FILE_NAME)
        done = _repaired(staged, [staged / file.name for file in files])
        staged.chmod(0o755)  # a temporary folder is its owner's alone
        staged.rename(out)
    except BaseException:
        shutil.rmtree(staged, ignore_errors=True)
        raise
    moved = tuple(replace(report, path=out / report.path.name) for report in done.files)
    return BagRepair(path=out, files=moved, metadata_renewed=done.metadata_renewed)


def bag_files(folder: Path) -> list[Path]:
    """Files of the bag in `folder`, in order, also where metadata.yaml is missing or was cut.

    Raises BadFileError where a file is missing, or `folder` holds no bag or several.
    """
    try:
        found = [folder / row.name for row in read_metadata(folder).files]
    except BadFileError as error:
        found = sorted(folder.glob("*.mcap"), key=lambda file: (_number(file), file.name))
        if not found:
            raise BadFileError(f"{folder} is no bag: there is no .mcap file in it") from error
        if len({re.sub(r"_\d+$", "", file.stem) for file in found}) > 1:
            raise BadFileError(
                f"{folder} has no {FILE_NAME} that can be read and holds {len(found)} files of several bags, "
                f"such as {found[0].name} and {found[-1].name}; name one file"
            ) from error
    for file in found:
        if not file.is_file():
            raise BadFileError(f"{folder / FILE_NAME} names {file.name}, which is not there")
    return found


def _files(path: Path) -> list[Path]:
    if not path.exists():
        raise BadFileError(f"there is no bag at {path}")
    return bag_files(path) if path.is_dir() else [path]


def _number(file: Path) -> int:
    found = re.search(r"_(\d+)$", file.stem)
    return int(found[1]) if found else 0


def _repaired(path: Path, files: Sequence[Path]) -> BagRepair:
    reports = tuple(repair_file(file) for file in files if not _is_whole(file))
    renewed = path.is_dir() and _renew_metadata(path, files, was_repaired=bool(reports))
    return BagRepair(path=path, files=reports, metadata_renewed=renewed)


def _is_whole(file: Path) -> bool:
    """Whether the file has an end, and every chunk in it can be read."""
    if not has_sound_end(file):
        return False
    with open_file(file) as stream:
        stream.seek(len(MAGIC))
        return scan(stream).damaged_chunks == 0


def _renew_metadata(folder: Path, files: Sequence[Path], *, was_repaired: bool) -> bool:
    """Write metadata.yaml again where it is missing or does not tell what is there."""
    try:
        before: BagMetadata | None = read_metadata(folder)
    except BadFileError:
        before = None
    holds = [counted(file) for file in files]
    told = BagMetadata(
        files=tuple(row for row, _ in holds),
        topics=joined(topic for _, topics in holds for topic in topics),
        custom=before.custom if before else (),
        ros_distro=before.ros_distro if before else "jazzy",
    )
    if before is not None and not was_repaired and before.message_count == told.message_count:
        return False
    told.write(folder)
    return True

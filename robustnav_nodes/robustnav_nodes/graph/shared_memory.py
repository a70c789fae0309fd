"""Shared memory of DDS that killed processes left behind."""

import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

SHM = Path("/dev/shm")
SETTLED_AFTER_S = 5.0  # a younger port may be about to get its lock
_PORT = re.compile(r"fastrtps_port\d+")


def clean_shared_memory() -> None:
    """Remove segments and ports that no living process uses.

    Fast DDS's own tool finds what still has a lock file. Ports of a process that was killed while others
    talked to it have lost theirs; they are removed where no process maps them.
    """
    tool = shutil.which("fastdds", path=str(Path(sys.executable).parent)) or shutil.which("fastdds")
    if tool is not None:
        subprocess.run([tool, "shm", "clean"], check=False, capture_output=True, timeout=30.0)
    orphans = set(_ports_without_lock())
    if orphans:
        for port in orphans - _mapped_files():
            (SHM / port).unlink(missing_ok=True)
            (SHM / f"sem.{port}_mutex").unlink(missing_ok=True)


def _ports_without_lock() -> Iterator[str]:
    names = {item.name for item in SHM.iterdir()} if SHM.is_dir() else set()
    for name in names:
        if not _PORT.fullmatch(name) or names & {f"{name}_el", f"{name}_sl"}:
            continue
        try:
            age_s = time.time() - (SHM / name).stat().st_mtime
        except FileNotFoundError:
            continue
        if age_s > SETTLED_AFTER_S:
            yield name


def _mapped_files() -> set[str]:
    """Names of the files in shared memory that some process has mapped."""
    found: set[str] = set()
    for maps in Path("/proc").glob("[0-9]*/maps"):
        try:
            text = maps.read_text(encoding="utf-8", errors="replace")
        except OSError:  # it has just ended, or is another user's, whose files we could not remove either
            continue
        found |= {line.rpartition("/")[2] for line in text.splitlines() if f"{SHM}/" in line}
    return found

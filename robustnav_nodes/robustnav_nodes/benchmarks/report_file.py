"""The JSON files of `robustnav bench NAME --json FILE`."""

import contextlib
import json
import os
from pathlib import Path
from typing import Any

import robustnav_nodes
from robustnav_msgs_py.errors import BadFileError


def check_writable(*paths: Path | None) -> None:
    """Refuse, before hours of work, a file that could not be written after them; None: nothing wanted.

    Raises BadFileError where the folder that it is to lie in is missing or closed, or it is a folder.
    """
    for path in paths:
        if path is None:
            continue
        if path.is_dir():
            raise BadFileError(f"cannot write {str(path)!r}: it is a folder; name a file")
        if not os.access(path.parent, os.W_OK | os.X_OK):
            raise BadFileError(f"cannot write {str(path)!r}: {str(path.parent)!r} is no folder to write to")


def write_report(path: Path, bench: str, **content: Any) -> None:
    """Write the report of benchmark `bench`, whole or not at all; a file that is there is replaced.

    Raises BadFileError where it cannot be written.
    """
    from bags.provenance import manifest_of_this_run  # bags stands on this package

    code = manifest_of_this_run(Path(robustnav_nodes.__file__))
    report = {"bench": bench, "version": code.version, "commit": code.commit, **content}
    if code.uncommitted_changes:
        report["uncommitted_changes"] = True
    unfinished = path.with_name(path.name + ".part")
    try:
        unfinished.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
        unfinished.replace(path)
    except OSError as error:
        raise BadFileError(f"cannot write the report {str(path)!r}: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            unfinished.unlink()

"""Text files of other people's data sets, read with a sentence for each way in which they can be wrong."""

import json
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError


def read_text(path: Path) -> str:
    """What a text file holds. Raises BadFileError where it cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise BadFileError(
            f"cannot read {str(path)!r}: {error.strerror}; the folder must hold this file"
        ) from error
    except UnicodeDecodeError as error:
        raise BadFileError(f"{str(path)!r} is not text: {error}; get the file anew") from error


def read_lines(path: Path) -> list[str]:
    """The lines of a text file, without the empty ones at its end."""
    return read_text(path).rstrip().splitlines()


def read_json_object(path: Path) -> dict[str, Any]:
    """The JSON object in a file. Raises BadFileError where there is none."""
    try:
        content = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise BadFileError(f"{str(path)!r} is not JSON: {error}; get the file anew") from error
    if not isinstance(content, dict):
        raise BadFileError(f"{str(path)!r} must hold a JSON object, not {content!r:.80}")
    return content


def read_instance_names(path: Path) -> dict[int, str]:
    """Names by number from lines such as "red_mug 7"; a file that is missing names nothing."""
    if not path.exists():
        return {}
    names = {}
    for number, line in enumerate(read_lines(path), start=1):
        words = line.split()
        if len(words) < 2 or not words[-1].isdecimal():
            raise BadFileError(
                f"line {number} of {str(path)!r} is {line!r:.80}: it must be a name, a blank and a number"
            )
        names[int(words[-1])] = " ".join(words[:-1])
    return names

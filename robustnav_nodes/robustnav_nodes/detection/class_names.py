"""The class names that a model was trained for, or is to look for: from the parameters or a text file."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from robustnav_msgs_py.errors import BadFileError, BadParameterError

MOST_CLASSES = 10_000


def read_class_names(names: Sequence[str], file: str) -> tuple[str, ...]:
    """The names, stripped, in their order; blank lines and lines that begin with # do not count.

    Raises BadParameterError where there are none, a name comes twice or holds a comma (names travel
    comma-separated), or both ways are used; BadFileError where the file cannot be read.
    """
    if names and file:
        raise BadParameterError(
            f"class_names holds {len(names)} names and class_names_file is {file!r}: give one of the two"
        )
    source = f"class_names_file {file!r}" if file else "class_names"
    lines = _read(Path(file)) if file else list(names)
    found = [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]
    if not found:
        raise BadParameterError(
            f"{source} holds no class names; this back end needs them, in the order of the model's outputs"
        )
    if len(found) > MOST_CLASSES:
        raise BadParameterError(f"{source} holds {len(found)} names; {MOST_CLASSES} are the most: is it one?")
    for name, times in Counter(found).items():
        if "," in name:
            raise BadParameterError(f"{source} holds {name!r}; a class name must not hold a comma")
        if times > 1:
            raise BadParameterError(f"{source} holds {name!r} {times} times; names must differ")
    return tuple(found)


def _read(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise BadFileError(f"cannot read the class names {str(path)!r}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadFileError(f"the class names {str(path)!r} are no text: {error}") from error

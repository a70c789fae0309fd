"""The class names that a model was trained for, or is to look for: from the parameters or a text file."""

from collections.abc import Sequence
from pathlib import Path

from robustnav_msgs_py.errors import BadFileError, BadParameterError

MOST_CLASSES = 10_000


def class_names(classes: Sequence[str], classes_file: str) -> tuple[str, ...]:
    """The names, stripped, in their order; blank lines and lines that begin with # do not count.

    Raises BadParameterError where there are none, a name comes twice or holds a comma (names travel
    comma-separated), or both ways are used; BadFileError where the file cannot be read.
    """
    if classes and classes_file:
        raise BadParameterError(
            f"classes names {len(classes)} classes and classes_file is {classes_file!r}: give one of the two"
        )
    source = f"classes_file {classes_file!r}" if classes_file else "classes"
    lines = _read(Path(classes_file)) if classes_file else list(classes)
    names = [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]
    if not names:
        raise BadParameterError(
            f"{source} holds no class names; this back end needs them, in the order of the model's outputs"
        )
    if len(names) > MOST_CLASSES:
        raise BadParameterError(f"{source} holds {len(names)} names; {MOST_CLASSES} are the most: is it one?")
    for name in names:
        if "," in name:
            raise BadParameterError(f"{source} holds {name!r}; a class name must not hold a comma")
        if names.count(name) > 1:
            raise BadParameterError(f"{source} holds {name!r} {names.count(name)} times; names must differ")
    return tuple(names)


def _read(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise BadFileError(f"cannot read the class names {str(path)!r}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise BadFileError(f"the class names {str(path)!r} are no text: {error}") from error

"""A scene file's text as tables, lists and words, each with its line.

Of YAML, only what a person needs to describe a home: what YAML has for surprises (anchors and aliases, tags,
several documents, a field given twice) is refused here, before it can grow or hide anything.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from robustnav_msgs_py.errors import BadSceneError

# A row is about 120 bytes: thousands of objects fit.
MAX_BYTES = 1_000_000
# The format needs four: the file, its lists, their rows, the numbers of a row.
MAX_DEPTH = 8

# The C version is ten times faster; it is missing where PyYAML was built without libyaml.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_TAB_INDENT = re.compile(r"^ *\t[ \t]*\S", re.MULTILINE)
_BARE_HEX = re.compile(r"[:\[,{] *#[0-9A-Fa-f]{6}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Words:
    """What stands for one value: a word, a number, nothing. `quoted` tells "1" from 1."""

    line: int
    text: str
    quoted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Items:
    """A list."""

    line: int
    nodes: tuple["Node", ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Values by the names of their fields, in the file's order; `lines` says where each field begins."""

    line: int
    fields: Mapping[str, "Node"]
    lines: Mapping[str, int]


Node = Words | Items | Table


def problem(source: str, line: int, what: str) -> BadSceneError:
    """The error for something wrong on a line (counted from 1) of `source`."""
    return BadSceneError(f"{source}, line {line}: {what}")


def parse_table(text: str, source: str) -> Table:
    """The table that a scene file's text is; `source` names the file in errors.

    Raises BadSceneError where the text is no YAML, no table, too large, or more YAML than a scene file may
    hold.
    """
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > MAX_BYTES:
        raise BadSceneError(
            f"{source} has {size} bytes; a scene file has {MAX_BYTES} at most: take furniture and objects "
            "out of it"
        )
    tab = _TAB_INDENT.search(text)
    if tab is not None:
        line = text.count("\n", 0, tab.start()) + 1
        raise problem(source, line, "it is indented with a tab, which YAML forbids; use blanks")
    top = _Composer(text=text, source=source).document()
    if not isinstance(top, Table):
        raise problem(
            source,
            top.line,
            f"a scene file is a table of fields, as 'format: robustnav scene', not {shown(top)}",
        )
    return top


def shown(node: Node) -> str:
    """What a value is, for an error."""
    match node:
        case Words(text=""):
            return "empty"
        case Words(quoted=True):
            return f"the text {node.text!r:.80}"
        case Words():
            return f"{node.text!r:.80}"
        case Items():
            return f"a list of {len(node.nodes)}"
        case Table():
            return f"a table with the fields {', '.join(map(repr, node.fields)) or 'none'}"


class _Composer:
    """Makes the tree out of YAML's events, one after the other, so that nothing is built that is refused."""

    def __init__(self, *, text: str, source: str) -> None:
        self._source = source
        self._text = text
        self._events: Iterator[Any] = iter(yaml.parse(text, Loader=_LOADER))

    def document(self) -> Node:
        """The only document of the text."""
        self._next()  # the stream's start
        start = self._next()
        if isinstance(start, yaml.StreamEndEvent):
            raise BadSceneError(
                f"{self._source} is empty; write a scene into it as docs/scene_format.md shows"
            )
        top = self._node(self._next(), 1)
        self._next()  # the document's end
        more = self._next()
        if not isinstance(more, yaml.StreamEndEvent):
            raise self._problem(more, "a second document begins ('---'); put each scene into its own file")
        return top

    def _node(self, event: Any, depth: int) -> Node:
        if isinstance(event, yaml.AliasEvent):
            raise self._problem(event, f"the alias '*{event.anchor}': write the value out instead")
        if event.anchor is not None:
            raise self._problem(event, f"the anchor '&{event.anchor}': a scene has none, take it away")
        if event.tag is not None:
            raise self._problem(event, f"the tag {event.tag!r:.80}: a scene has none, take it away")
        line = _line(event)
        if isinstance(event, yaml.ScalarEvent):
            return Words(line=line, text=event.value, quoted=bool(event.style))
        if depth > MAX_DEPTH:
            raise self._problem(event, f"tables and lists are nested more than {MAX_DEPTH} deep; write rows")
        if isinstance(event, yaml.SequenceStartEvent):
            return Items(line=line, nodes=tuple(self._items(depth)))
        return self._table(line, depth)

    def _items(self, depth: int) -> Iterator[Node]:
        while not isinstance(event := self._next(), yaml.SequenceEndEvent):
            yield self._node(event, depth + 1)

    def _table(self, line: int, depth: int) -> Table:
        fields: dict[str, Node] = {}
        lines: dict[str, int] = {}
        while not isinstance(event := self._next(), yaml.MappingEndEvent):
            key = self._node(event, depth + 1)
            if not isinstance(key, Words):
                raise problem(self._source, key.line, f"a field's name must be a word, not {shown(key)}")
            if key.text in fields:
                raise problem(
                    self._source,
                    key.line,
                    f"the field {key.text!r:.80} is on line {lines[key.text]} already; keep one of them",
                )
            fields[key.text] = self._node(self._next(), depth + 1)
            lines[key.text] = key.line
        return Table(line=line, fields=fields, lines=lines)

    def _next(self) -> Any:
        try:
            return next(self._events)
        except yaml.MarkedYAMLError as error:
            raise self._not_yaml(error) from error
        except (yaml.YAMLError, UnicodeError) as error:
            what = " ".join(str(error).split())
            raise BadSceneError(f"{self._source} is not YAML: {what}; remove that character") from error

    def _not_yaml(self, error: yaml.MarkedYAMLError) -> BadSceneError:
        marks = [mark for mark in (error.context_mark, error.problem_mark) if mark is not None]
        lines = self._text.splitlines()
        about = [lines[mark.line] for mark in marks if mark.line < len(lines)]
        hint = "compare the line, and that above it, with docs/scene_format.md"
        if any(_BARE_HEX.search(line) for line in about):
            hint = "'#' begins a comment: write colours as #rrggbb in quotes"
        why = "; ".join(part for part in (error.context, error.problem) if part)
        return problem(self._source, marks[-1].line + 1 if marks else 1, f"this is not YAML ({why}); {hint}")

    def _problem(self, event: Any, what: str) -> BadSceneError:
        return problem(self._source, _line(event), what)


def _line(event: Any) -> int:
    return int(event.start_mark.line) + 1

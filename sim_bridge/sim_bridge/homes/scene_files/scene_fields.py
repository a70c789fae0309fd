"""The fields of one table of a scene file, read by type; errors name the file, the line and the table."""

import difflib
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from enum import StrEnum
from typing import Any, TypeVar

import yaml

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.materials import COLOURS, Material, Substance, material
from sim_bridge.homes.scene_files.scene_text import Items, Node, Table, Words, problem, shown

MAX_LENGTH_M = 1000.0
MAX_HEADING_DEG = 360.0
MAX_WHOLE = 2**63 - 1

_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)
_WHOLE = re.compile(r"[-+]?\d{1,19}", re.ASCII)
_NOT_FINITE = re.compile(r"[-+]?\.?(nan|inf|infinity)", re.IGNORECASE)
# Fields by which people find a row again, the first that is there.
_ROW_NAMES = ("name", "class", "room")
_MOST_OPTIONS_SHOWN = 12
_TEXT_TAG = "tag:yaml.org,2002:str"
_RESOLVER: Any = yaml.resolver.Resolver()

# What people write has few decimals. More stand there only where `degrees_text` needed them to be exact.
_HAND_WRITTEN_DECIMALS = 9
_MAX_DECIMALS = 20
_PRECISE = Context(prec=40)
_RADIANS_PER_DEGREE = _PRECISE.divide(
    Decimal("3.14159265358979323846264338327950288419716939937510"), Decimal(180)
)

Choice = TypeVar("Choice", bound=StrEnum)


def heading_rad(degrees: str) -> float:
    """A heading in radians from degrees as they are written.

    As `math.radians` has it, but from ten decimals on to the last bit: `math.radians` never returns some
    floats.
    """
    if len(degrees.partition(".")[2]) <= _HAND_WRITTEN_DECIMALS:
        return math.radians(float(degrees))
    return float(_PRECISE.multiply(Decimal(degrees), _RADIANS_PER_DEGREE))


def degrees_text(heading: float) -> str:
    """The fewest decimals of degrees from which `heading_rad` makes exactly `heading` (rad).

    Within 1e-20 degrees where no number of decimals does, which is so for tiny headings alone.
    """
    degrees = _PRECISE.divide(Decimal(heading + 0.0), _RADIANS_PER_DEGREE)  # + 0.0: no "-0"
    text = ""
    for decimals in range(_MAX_DECIMALS + 1):
        text = f"{degrees:.{decimals}f}"
        if heading_rad(text) == heading:
            break
    return text


def is_plain_text(words: str) -> bool:
    """Whether YAML takes the words for text without quotes, and not for a number, a yes or nothing."""
    return bool(_RESOLVER.resolve(yaml.ScalarNode, words, (True, False)) == _TEXT_TAG)


def nearest(word: str, options: Sequence[str]) -> str:
    """What to add to an error about a word that is none of `options`."""
    close = difflib.get_close_matches(word, options, n=1)
    if close:
        return f"; did you mean {str(close[0])!r}?"
    more = ", ..." if len(options) > _MOST_OPTIONS_SHOWN else ""
    return f"; there are {', '.join(options[:_MOST_OPTIONS_SHOWN]) or 'none'}{more}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """A table of a scene file and its place, as "furniture[3] 'chair 2'"; the file itself has none.

    Every method raises BadSceneError where the field is not what it must be, or is missing and `default` is
    None.
    """

    source: str
    place: str
    table: Table

    def __contains__(self, name: str) -> bool:
        return name in self.table.fields

    def error(self, what: str, name: str | None = None) -> BadSceneError:
        """The error for something wrong with the table, or with its field `name`."""
        line = self.table.line if name is None else self.table.lines.get(name, self.table.line)
        return problem(self.source, line, f"{self.place}: {what}" if self.place else what)

    def allow(self, names: Sequence[str]) -> None:
        """Refuse fields that are none of `names`."""
        for name in self.table.fields:
            if name not in names:
                raise self.error(f"there is no field {name!r:.80} here{nearest(name, names)}", name)

    def text(self, name: str, default: str | None = None) -> str:
        """Words on one line, without blanks around them."""
        if name not in self and default is not None:
            return default
        return self._text(name, self._node(name))

    def texts(self, name: str, meaning: str) -> tuple[str, ...]:
        """As many words as the list that `meaning` shows has, as "[a room, another room]"."""
        return tuple(self._text(name, node) for node in self._nodes(name, meaning))

    def length_m(self, name: str, default: float | None = None) -> float:
        """A number of metres."""
        if name not in self and default is not None:
            return default
        return self._metres(name, self._node(name))

    def lengths_m(self, name: str, meaning: str) -> tuple[float, ...]:
        """As many numbers of metres as the list that `meaning` shows has, as "[x, y]"."""
        return tuple(self._metres(name, node) for node in self._nodes(name, meaning))

    def heading_rad(self, name: str, default: float | None = None) -> float:
        """A heading, written in degrees."""
        if name not in self and default is not None:
            return default
        return self._heading(name, self._node(name))

    def pose(self, name: str) -> tuple[float, float, float]:
        """[x, y, heading] in metres and degrees; the heading is returned in radians."""
        x, y, heading = self._nodes(name, "[x, y, heading]")
        return self._metres(name, x), self._metres(name, y), self._heading(name, heading)

    def whole(self, name: str, default: int | None = None) -> int:
        """A whole number, 0 or more."""
        if name not in self and default is not None:
            return default
        node = self._node(name)
        if isinstance(node, Words) and not node.quoted and _WHOLE.fullmatch(node.text):
            number = int(node.text)
            if 0 <= number <= MAX_WHOLE:
                return number
        raise self._wrong(name, node, f"a whole number from 0 to {MAX_WHOLE}")

    def choice(self, name: str, options: type[Choice], default: Choice | None = None) -> Choice:
        """One of the words of `options`."""
        if name not in self and default is not None:
            return default
        word = self.text(name)
        if word not in list(options):
            raise self.error(f"{name!r} is {word!r:.80}{nearest(word, list(options))}", name)
        return options(word)

    def colour(self, name: str, default: str | None = None) -> str:
        """The name of a colour, or #rrggbb."""
        word = self.text(name, default).lower()
        try:
            Material(substance=Substance.PAINT, colour=word)
        except BadSceneError as wrong:
            what = f"{name!r} is {word!r:.80}{nearest(word, list(COLOURS))}, or write #rrggbb in quotes"
            raise self.error(what, name) from wrong
        return word

    def material(self, name: str, default: Material | None = None) -> Material:
        """A material, in words."""
        if name not in self and default is not None:
            return default
        words = self.text(name)
        try:
            return material(words)
        except BadSceneError as wrong:
            raise self.error(f"{name!r}: {wrong}", name) from wrong

    def one_of(self, name: str, known: Sequence[str], what: str) -> str:
        """The name of one of the `known` rooms or pieces of furniture."""
        word = self.text(name)
        self.require_known(name, word, known, what)
        return word

    def require_known(self, name: str, word: str, known: Sequence[str], what: str) -> None:
        """Refuse a name that nothing in the file has."""
        if word not in known:
            raise self.error(
                f"{name!r} is {word!r:.80}, and no {what} has that name{nearest(word, known)}", name
            )

    def rows(self, name: str, limit: int) -> Iterator["Row"]:
        """The tables of a list; none where the field is missing or empty."""
        node = self.table.fields.get(name, Words(line=0, text="", quoted=False))
        if node == Words(line=node.line, text="", quoted=False):
            return
        if not isinstance(node, Items):
            raise self._wrong(name, node, "a list of rows, each beginning with '- '")
        if len(node.nodes) > limit:
            raise self.error(f"{name!r} has {len(node.nodes)} rows; take some out, {limit} is the most", name)
        for at, row in enumerate(node.nodes):
            place = f"{name}[{at}]"
            if not isinstance(row, Table):
                raise problem(
                    self.source, row.line, f"{place} must be a table, as {{name: ...}}, not {shown(row)}"
                )
            names = [row.fields[field] for field in _ROW_NAMES if field in row.fields]
            if names and isinstance(names[0], Words):
                place += f" {names[0].text!r:.80}"
            yield Row(source=self.source, place=place, table=row)

    def _node(self, name: str) -> Node:
        if name not in self:
            raise self.error(f"the field {name!r} is missing; add it as docs/scene_format.md shows")
        return self.table.fields[name]

    def _nodes(self, name: str, meaning: str) -> tuple[Node, ...]:
        node = self._node(name)
        if not isinstance(node, Items) or len(node.nodes) != meaning.count(",") + 1:
            raise self._wrong(name, node, f"a list {meaning}")
        return node.nodes

    def _text(self, name: str, node: Node) -> str:
        if not isinstance(node, Words):
            raise self._wrong(name, node, "text")
        if not node.text:
            raise self._wrong(name, node, "text ('#' begins a comment: write colours as #rrggbb in quotes)")
        if not node.quoted and not is_plain_text(node.text):
            raise self._wrong(name, node, "text: put quotes around it if it is meant as a word")
        if not node.text.isprintable() or node.text != node.text.strip():
            raise self._wrong(
                name, node, "text on one line, without blanks around it or signs nobody can see"
            )
        return node.text

    def _number(self, name: str, node: Node, limit: float, unit: str) -> str:
        """A number as it is written, between -limit and limit."""
        if isinstance(node, Words):
            if node.quoted and _NUMBER.fullmatch(node.text):
                raise self._wrong(name, node, "a number: take away the quotes")
            if _NOT_FINITE.fullmatch(node.text):
                raise self._wrong(name, node, "a finite number")
            if not node.quoted and _NUMBER.fullmatch(node.text):
                if not -limit <= float(node.text) <= limit:
                    raise self._wrong(name, node, f"from {-limit:g} to {limit:g} {unit}")
                return node.text
        raise self._wrong(name, node, f"a number of {unit}, with a point before its decimals")

    def _metres(self, name: str, node: Node) -> float:
        return float(self._number(name, node, MAX_LENGTH_M, "metres"))

    def _heading(self, name: str, node: Node) -> float:
        return heading_rad(self._number(name, node, MAX_HEADING_DEG, "degrees"))

    def _wrong(self, name: str, node: Node, wanted: str) -> BadSceneError:
        return problem(
            self.source,
            node.line,
            f"{self.place + ': ' if self.place else ''}{name!r} must be {wanted}; it is {shown(node)}",
        )

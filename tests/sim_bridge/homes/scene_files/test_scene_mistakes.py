"""What a person can get wrong in a scene file: each mistake is refused with its line and what to do."""

import contextlib
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.scene_files.scene_file import (
    FORMAT,
    MAX_DOORS,
    MAX_FURNITURE,
    MAX_OBJECTS,
    MAX_ROOMS,
    MAX_WINDOWS,
    VERSION,
    parse_scene,
)
from sim_bridge.homes.scene_files.scene_text import MAX_DEPTH

SMALL = (Path(__file__).parents[3] / "data" / "scenes" / "small.yaml").read_text(encoding="utf-8")


def rejected(text: str) -> str:
    """The sentence with which a text is refused."""
    with pytest.raises(BadSceneError) as caught:
        parse_scene(text, "'home.yaml'")
    return str(caught.value)


def changed(old: str, new: str) -> str:
    assert SMALL.count(old) == 1
    return SMALL.replace(old, new)


@settings(max_examples=300, deadline=None)
@given(text=st.text(max_size=80) | st.lists(st.sampled_from(SMALL.splitlines())).map("\n".join))
def test_any_other_text_is_refused_with_a_sentence(text: str) -> None:
    assert rejected(text).startswith("'home.yaml'")


@settings(max_examples=300, deadline=None)
@given(at=st.integers(0, len(SMALL) - 1), sign=st.sampled_from(list("x1 \t\n#:,[]{}\"'*&!-|>%\0\ud800é")))
def test_one_wrong_sign_never_breaks_the_reader(at: int, sign: str) -> None:
    with contextlib.suppress(BadSceneError):
        parse_scene(SMALL[:at] + sign + SMALL[at + 1 :], "'home.yaml'")


@pytest.mark.parametrize(
    ("name", "row", "limit"),
    [
        ("rooms", "{name: room %d, kind: kitchen, area: [0, 0, 4, 3.5]}", MAX_ROOMS),
        ("doors", "{between: [kitchen, kitchen], at: [%d, 0]}", MAX_DOORS),
        ("windows", "{room: kitchen, side: south, from: %d, to: 999}", MAX_WINDOWS),
        (
            "furniture",
            "{name: c%d, kind: chair, room: kitchen, at: [2, 1], width: 1, main: oak wood, accent: sky wood}",
            MAX_FURNITURE,
        ),
        (
            "objects",
            "{class: mug, on: chair 1, at: [0, %d.0e-9], colour: blue, material: glass}",
            MAX_OBJECTS,
        ),
    ],
)
def test_a_list_takes_so_many_rows_and_not_one_more(name: str, row: str, limit: int) -> None:
    def text(rows: int) -> str:
        own = [] if name == "rooms" else re.findall(r"rooms:\n.*\n", SMALL)
        chair = re.findall(r"furniture:\n.*\n", SMALL) if name == "objects" else []
        first = 'format: robustnav scene\nversion: 1\nname: "1"\nstart: [0, 0, 0]\n'
        return (
            first + "".join(own + chair) + f"{name}:\n" + "".join(f"  - {row % at}\n" for at in range(rows))
        )

    scene = parse_scene(text(limit), "a text")
    assert len(getattr(scene, name)) == limit
    assert f"'{name}' has {limit + 1} rows" in rejected(text(limit + 1))


def test_nothing_grows_out_of_aliases() -> None:
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
        f"{b}: &{b} [{', '.join(['*' + a] * 9)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    assert "line 1: the anchor '&a'" in rejected(bomb)
    assert "line 5: the alias '*x'" in rejected(changed("kind: kitchen", "kind: *x"))


def test_nesting_ends_somewhere() -> None:
    assert f"more than {MAX_DEPTH} deep" in rejected("[" * 200_000)
    assert f"more than {MAX_DEPTH} deep" in rejected("{a: " * 100_000)
    assert f"more than {MAX_DEPTH} deep" in rejected("- " * 100_000)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", r"'home\.yaml' is empty; write a scene"),
        ("# nothing\n", r"is empty"),
        ("- 1\n", r"line 1: a scene file is a table of fields.* not a list of 1"),
        ("hello", r"line 1: a scene file is a table of fields.* not 'hello'"),
        ("name: [1", r"line \d: this is not YAML"),
        ("a: b: c", r"line 1: this is not YAML"),
        ("name: \0", r"'home\.yaml' is not YAML: .*#x0000"),
        ("name: \ud800", r"'home\.yaml' is not YAML"),
        ("name: a\n---\nname: b\n", r"line 2: a second document"),
        ("name: !!python/object:os.system x", r"line 1: the tag 'tag:yaml.org,2002:python/object:os.system'"),
        ("? [a]\n: b\n", r"line 1: a field's name must be a word, not a list of 1"),
        (changed("rooms:\n", "rooms:\n\t"), r"line 5: it is indented with a tab.* use blanks"),
    ],
    ids=lambda value: repr(value)[:30],
)
def test_what_is_no_table_is_refused(text: str, sentence: str) -> None:
    assert re.search(sentence, rejected(text))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # The format and its version.
        (
            f"format: {FORMAT}",
            "format: robustnav search scene",
            r"line 1: 'format' is 'robustnav search scene'",
        ),
        (f"format: {FORMAT}\n", "", r"the field 'format' is missing"),
        (f"version: {VERSION}", "version: 2", r"line 2: it is of version 2, .* reads 1 only; get a newer"),
        (f"version: {VERSION}", "version: 0", r"line 2: it is of version 0, .*write 'version: 1'"),
        (f"version: {VERSION}", "version: one", r"line 2: 'version' must be a whole number.* it is 'one'"),
        # Fields.
        ("name: small\n", "", r"the field 'name' is missing"),
        ("start: [1, 1, 90]\n", "", r"the field 'start' is missing"),
        (
            "name: small",
            "name: small\nnmae: big",
            r"line 4: there is no field 'nmae' here; did you mean 'name'\?",
        ),
        ("name: small", "name: small\nname: big", r"line 4: the field 'name' is on line 3 already"),
        ("on: chair 1,", "on: chair 1, on: chair 1,", r"line 9: the field 'on' is on line 9 already"),
        (
            "colour: blue",
            "color: blue",
            r"line 9: objects\[0\] 'mug': .* 'color' here; did you mean 'colour'\?",
        ),
        ("colour: blue, ", "", r"line 9: objects\[0\] 'mug': the field 'colour' is missing"),
        ("width: 0.4, ", "", r"line 7: furniture\[0\] 'chair 1': the field 'width' is missing"),
        ("class: mug, ", "", r"line 9: objects\[0\]: the field 'class' is missing"),
        # Lists and tables.
        (
            "  - {class",
            "  {class",
            r"line 9: 'objects' must be a list of rows.* a table with the fields 'class'",
        ),
        ("  - {name: kitchen, kind: kitchen, area: [0, 0, 4, 3.5]}\n", "", r"line 4: 'rooms' has no rows"),
        (
            "  - {name: kitchen, kind: kitchen, area: [0, 0, 4, 3.5]}",
            "  - kitchen",
            r"line 5: rooms\[0\] must be",
        ),
        (
            "  - {name: kitchen, kind: kitchen, area: [0, 0, 4, 3.5]}",
            " kitchen",
            r"line 5: 'rooms' must be a list",
        ),
        ("name: small", "name: [small]", r"line 3: 'name' must be text; it is a list of 1"),
        ("at: [2, 1]", "at: [2, 1, 0]", r"line 7: .*'at' must be a list \[x, y\]; it is a list of 3"),
        (
            "at: [2, 1]",
            "at: {x: 2, y: 1}",
            r"line 7: .*'at' must be a list .* a table with the fields 'x', 'y'",
        ),
        ("start: [1, 1, 90]", "start: [1, 1]", r"line 10: 'start' must be a list \[x, y, heading\]"),
        # Numbers.
        ("width: 0.4", "width: wide", r"line 7: .*'width' must be a number of metres.* it is 'wide'"),
        (
            "width: 0.4",
            'width: "0.4"',
            r"'width' must be a number: take away the quotes; it is the text '0\.4'",
        ),
        ("width: 0.4", "width: yes", r"'width' must be a number of metres.* it is 'yes'"),
        ("width: 0.4", "width: true", r"'width' must be a number of metres.* it is 'true'"),
        ("width: 0.4", "width: .nan", r"'width' must be a finite number; it is '\.nan'"),
        ("width: 0.4", "width: -.inf", r"'width' must be a finite number; it is '-\.inf'"),
        ("width: 0.4", "width: 1e999", r"'width' must be from -1000 to 1000 metres; it is '1e999'"),
        ("width: 0.4", "width: 40 cm", r"'width' must be a number of metres.* it is '40 cm'"),
        ("width: 0.4", "width: 1:30", r"'width' must be a number of metres"),
        ("width: 0.4", "width: 0x10", r"'width' must be a number of metres"),
        ("width: 0.4", "width: ", r"'width' must be a number of metres.* it is empty"),
        ("start: [1, 1, 90]", "start: [1, 1, 361]", r"'start' must be from -360 to 360 degrees; it is '361'"),
        ("on: chair 1,", "on: chair 1, surface: -1,", r"'surface' must be a whole number.* it is '-1'"),
        ("on: chair 1,", "on: chair 1, surface: 1.5,", r"'surface' must be a whole number.* it is '1\.5'"),
        ("on: chair 1,", 'on: chair 1, surface: "1",', r"'surface' must be a whole number.* the text '1'"),
        ("name: small", f"name: small\nseed: {10**30}", r"'seed' must be a whole number"),
        (
            "area: [0, 0, 4, 3.5]",
            "area: [4, 0, 0, 3.5]",
            r"line 5: rooms\[0\] 'kitchen': 'area' is .* minimum",
        ),
        # Words.
        ("name: small", "name: 12", r"line 3: 'name' must be text: put quotes around it"),
        ("name: small", "name: no", r"line 3: 'name' must be text: put quotes around it"),
        ("name: small", "name:", r"line 3: 'name' must be text .*'#' begins a comment.* it is empty"),
        ("name: small", 'name: ""', r"line 3: 'name' must be text"),
        (
            "name: small",
            'name: " small"',
            r"line 3: 'name' must be text on one line, without blanks around it",
        ),
        ("name: small", 'name: "a\\nb"', r"line 3: 'name' must be text on one line"),
        (
            "colour: blue",
            "colour: bleu",
            r"line 9: objects\[0\] 'mug': 'colour' is 'bleu'; did you mean 'blue'\?",
        ),
        ("colour: blue", 'colour: "#12345"', r"'colour' is '#12345'; .* or write #rrggbb in quotes"),
        ("colour: blue", "colour: #123456", r"line \d+: this is not YAML .*'#' begins a comment"),
        ("material: ceramic", "material: ceramics", r"'material' is 'ceramics'; did you mean 'ceramic'\?"),
        (
            "material: ceramic",
            "material: glass, size: huge",
            r"'size' is 'huge'; there are small, medium, large",
        ),
        ("main: oak wood", "main: oak", r"furniture\[0\] 'chair 1': 'main': a material is a colour"),
        ("main: oak wood", "main: okay wood", r"'main': no colour is called 'okay'"),
        ("at: [2, 1]", "at: [2, 1], facing: left", r"'facing' is 'left'"),
        # Names that must be there, once.
        (
            "room: kitchen",
            "room: kichen",
            r"'room' is 'kichen', and no room has that name; did you mean 'kitchen'",
        ),
        (
            "on: chair 1",
            "on: sofa 1",
            r"'on' is 'sofa 1', and no piece of furniture has that name; there are chair 1",
        ),
        (
            "objects:",
            (
                "  - {name: chair 1, kind: c, room: kitchen, at: [1, 1], width: 1, "
                "main: oak wood, accent: sky wood}\nobjects:"
            ),
            r"line 8: furniture\[1\] 'chair 1': the name is taken by line 7 already",
        ),
        (
            "furniture:",
            "doors:\n  - {between: [kitchen, garden], at: [4, 1]}\nfurniture:",
            r"line 7: doors\[0\]: 'between' is 'garden', and no room has that name",
        ),
        (
            "furniture:",
            "windows:\n  - {room: kitchen, side: up, from: 1, to: 2}\nfurniture:",
            r"line 7: windows\[0\] 'kitchen': 'side' is 'up'",
        ),
    ],
    ids=lambda value: repr(value)[:30],
)
def test_each_mistake_is_refused_with_its_line_and_what_to_do(old: str, new: str, sentence: str) -> None:
    assert re.search(sentence, rejected(changed(old, new)))

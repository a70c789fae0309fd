"""Scene files: exact round trips, defaults, files, and a documentation that has every field."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadFileError, BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.materials import COLOURS, Material, Pattern, Substance, material
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.scene import (
    Look,
    Scene,
    SceneDoor,
    SceneFurniture,
    SceneObject,
    SceneRoom,
    SceneWindow,
    Size,
    Style,
)
from sim_bridge.homes.scene_files.scene_fields import degrees_text, heading_rad
from sim_bridge.homes.scene_files.scene_file import (
    MAX_DOORS,
    MAX_FURNITURE,
    MAX_OBJECTS,
    MAX_ROOMS,
    MAX_WINDOWS,
    parse_scene,
    read_scene,
    scene_text,
    write_scene,
)
from sim_bridge.homes.scene_files.scene_rows import (
    DEFAULT_DOOR_WIDTH_M,
    DEFAULT_FLOOR,
    DEFAULT_SILL_M,
    DEFAULT_TOP_M,
    DEFAULT_WALLS,
    FIELDS,
)
from sim_bridge.homes.scene_files.scene_text import MAX_BYTES

ROOT = Path(__file__).parents[4]
SCENES = ROOT / "tests" / "data" / "scenes"
TWO_ROOMS = SCENES / "two_rooms.yaml"
SMALL = (SCENES / "small.yaml").read_text(encoding="utf-8")
DOCS = ROOT / "docs" / "scene_format.md"


# What people may use as names, that which YAML takes for something else among them.
NAMES = (SCENES / "awkward_names.txt").read_text(encoding="utf-8").splitlines()

printable = st.just(" ") | st.characters(exclude_categories=("C", "Z"))
names = st.one_of(
    st.sampled_from(NAMES),
    st.text(printable, min_size=1, max_size=12).map(str.strip).filter(bool),
)
lengths = st.integers(-1_000_000_000, 1_000_000_000).map(lambda micrometres: micrometres / 1e6)
headings = st.one_of(
    st.floats(-6.28, 6.28).filter(lambda heading: heading == 0.0 or abs(heading) > 1e-4),
    st.integers(-6_283_185, 6_283_185).map(lambda millionths: millionths / 1e6),
    st.integers(-360, 360).map(math.radians),
)
colours = st.one_of(st.sampled_from(sorted(COLOURS)), st.from_regex(r"#[0-9a-f]{6}", fullmatch=True))
materials = st.builds(
    Material, substance=st.sampled_from(Substance), colour=colours, pattern=st.sampled_from(Pattern)
)
looks = st.builds(
    Look,
    colour=colours,
    substance=st.sampled_from(Substance),
    pattern=st.sampled_from(Pattern),
    size=st.sampled_from(Size),
)
styles = st.builds(Style, width_m=lengths, main=materials, accent=materials)


@st.composite
def areas(draw: st.DrawFn) -> Rect:
    xs, ys = (sorted(draw(st.lists(lengths, min_size=2, max_size=2, unique=True))) for _ in range(2))
    return Rect(x_min_m=xs[0], y_min_m=ys[0], x_max_m=xs[1], y_max_m=ys[1])


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    room_names = draw(st.lists(names, min_size=1, max_size=3, unique=True))
    piece_names = draw(st.lists(names, min_size=1, max_size=3, unique=True))
    room, piece = st.sampled_from(room_names), st.sampled_from(piece_names)
    doors = st.builds(SceneDoor, rooms=st.tuples(room, room), x_m=lengths, y_m=lengths, width_m=lengths)
    windows = st.builds(
        SceneWindow,
        room=room,
        side=st.sampled_from(Side),
        from_m=lengths,
        to_m=lengths,
        sill_m=st.one_of(st.just(DEFAULT_SILL_M), lengths),
        top_m=st.one_of(st.just(DEFAULT_TOP_M), lengths),
    )
    objects = st.builds(
        SceneObject,
        label=names,
        look=looks,
        furniture=piece,
        surface=st.integers(0, 3),
        x_m=lengths,
        y_m=lengths,
        turn_rad=headings,
    )
    return Scene(
        name=draw(names),
        seed=draw(st.none() | st.integers(0, 2**63 - 1)),
        rooms=tuple(
            SceneRoom(
                name=name,
                kind=draw(names),
                area=draw(areas()),
                floor=draw(materials),
                walls=draw(materials),
            )
            for name in room_names
        ),
        doors=tuple(draw(st.lists(doors, max_size=2))),
        windows=tuple(draw(st.lists(windows, max_size=2))),
        furniture=tuple(
            SceneFurniture(
                name=name,
                kind=draw(names),
                room=draw(room),
                x_m=draw(lengths),
                y_m=draw(lengths),
                quarter_turns=draw(st.integers(0, 3)),
                style=draw(styles),
            )
            for name in piece_names
        ),
        objects=tuple(draw(st.lists(objects, max_size=3))),
        start=Pose2D(x_m=draw(lengths), y_m=draw(lengths), yaw_rad=draw(headings)),
    )


@settings(max_examples=60, deadline=None)
@given(scene=scenes())
def test_any_scene_comes_back_exactly_from_its_text(scene: Scene) -> None:
    text = scene_text(scene)
    assert parse_scene(text, "a text") == scene
    assert scene_text(parse_scene(text, "a text")) == text


@settings(max_examples=300, deadline=None)
@given(heading=headings)
def test_a_heading_comes_back_to_the_last_bit(heading: float) -> None:
    assert heading_rad(degrees_text(heading)) == heading


@pytest.mark.parametrize("degrees", range(-360, 361, 15))
def test_whole_degrees_are_what_python_makes_of_them_and_are_written_so(degrees: int) -> None:
    assert heading_rad(str(degrees)) == math.radians(degrees)
    assert degrees_text(math.radians(degrees)) == str(degrees)


def test_a_scene_written_by_a_person_is_read() -> None:
    scene = read_scene(TWO_ROOMS)
    assert scene.name == "two rooms"
    assert scene.seed is None
    assert scene.rooms[0] == SceneRoom(
        name="kitchen",
        kind="kitchen",
        area=Rect(x_min_m=0.0, y_min_m=0.0, x_max_m=4.0, y_max_m=3.5),
        floor=material("grey tiles"),
        walls=material("#f2edd0 paint"),
    )
    assert (scene.rooms[1].floor, scene.rooms[1].walls) == (DEFAULT_FLOOR, DEFAULT_WALLS)
    assert scene.doors == (
        SceneDoor(rooms=("kitchen", "bedroom"), x_m=4.0, y_m=1.0, width_m=DEFAULT_DOOR_WIDTH_M),
    )
    assert scene.windows == (
        SceneWindow(room="kitchen", side=Side.SOUTH, from_m=1.0, to_m=2.2),
        SceneWindow(room="bedroom", side=Side.EAST, from_m=1.2, to_m=2.4, sill_m=1.1),
    )
    assert scene.furniture[2] == SceneFurniture(
        name="bed 1",
        kind="bed",
        room="bedroom",
        x_m=6.0,
        y_m=2.325,
        quarter_turns=3,
        style=Style(width_m=1.6, main=material("oak wood"), accent=material("blue striped fabric")),
    )
    assert scene.objects[0] == SceneObject(
        label="mug",
        look=Look(colour="blue", substance=Substance.CERAMIC, pattern=Pattern.STRIPED, size=Size.SMALL),
        furniture="dining table 1",
        surface=0,
        x_m=0.1,
        y_m=-0.2,
        turn_rad=math.radians(30),
    )
    assert scene.objects[3].surface == 1
    assert scene.start == Pose2D(x_m=3.0, y_m=0.8, yaw_rad=math.pi / 2.0)


def test_defaults_are_those_of_the_scene_itself() -> None:
    window = SceneWindow(room="kitchen", side=Side.WEST, from_m=1.0, to_m=2.0)
    assert (window.sill_m, window.top_m) == (DEFAULT_SILL_M, DEFAULT_TOP_M)
    look = Look(colour="blue", substance=Substance.CERAMIC)
    assert parse_scene(SMALL, "a text").objects[0].look == look
    assert parse_scene(SMALL, "a text").furniture[0].quarter_turns == 0


def test_missing_styles_and_looks_come_from_the_caller() -> None:
    text = SMALL.replace("width: 0.4, main: oak wood, accent: red fabric", "main: blue wood").replace(
        ", colour: blue, material: ceramic", ", pattern: dotted"
    )
    asked: list[str] = []

    def style(kind: str) -> Style:
        asked.append(kind)
        return Style(width_m=0.5, main=material("oak wood"), accent=material("grey fabric"))

    def look(label: str) -> Look:
        asked.append(label)
        return Look(colour="red", substance=Substance.GLASS)

    scene = parse_scene(text, "a text", default_style=style, default_look=look)
    assert asked == ["chair", "mug"]
    assert scene.furniture[0].style == Style(
        width_m=0.5, main=material("blue wood"), accent=material("grey fabric")
    )
    assert scene.objects[0].look == Look(colour="red", substance=Substance.GLASS, pattern=Pattern.DOTTED)
    asked.clear()
    parse_scene(SMALL, "a text", default_style=style, default_look=look)
    assert asked == []


def test_what_the_catalogue_refuses_is_refused_with_the_line() -> None:
    def style(kind: str) -> Style:
        raise BadSceneError(f"no kind is called {kind!r}")

    with pytest.raises(BadSceneError, match=r"line 7: .*furniture\[0\] 'chair 1': 'kind': no kind") as caught:
        parse_scene(SMALL.replace("width: 0.4, ", ""), "'home.yaml'", default_style=style)
    assert isinstance(caught.value.__cause__, BadSceneError)


def test_a_text_is_short_and_always_the_same() -> None:
    text = scene_text(parse_scene(SMALL, "a text"))
    assert text.splitlines()[2:] == [
        "format: robustnav scene",
        "version: 1",
        "name: small",
        "rooms:",
        "  - {name: kitchen, kind: kitchen, area: [0, 0, 4, 3.5], floor: oak boards, walls: cream paint}",
        "furniture:",
        (
            "  - {name: chair 1, kind: chair, room: kitchen, at: [2, 1], facing: east, width: 0.4, "
            "main: oak wood, accent: red fabric}"
        ),
        "objects:",
        "  - {class: mug, on: chair 1, at: [0, 0.1], colour: blue, material: ceramic}",
        "start: [1, 1, 90]",
    ]


def test_lengths_are_rounded_to_a_micrometre() -> None:
    scene = parse_scene(SMALL, "a text")
    scene = replace(scene, start=Pose2D(x_m=1.0 / 3.0, y_m=-1e-9))
    assert scene_text(scene).endswith("start: [0.333333, 0, 0]\n")


def test_quarter_turns_come_back_as_0_to_3() -> None:
    scene = parse_scene(SMALL, "a text")
    turned = replace(scene, furniture=(replace(scene.furniture[0], quarter_turns=-1),))
    assert parse_scene(scene_text(turned), "a text").furniture[0].quarter_turns == 3


def test_a_scene_that_could_not_be_read_again_is_not_written(tmp_path: Path) -> None:
    scene = parse_scene(SMALL, "a text")
    path = tmp_path / "home.yaml"
    for bad in (
        replace(scene, name=""),
        replace(scene, name="two\nlines"),
        replace(scene, rooms=()),
        replace(scene, seed=-1),
        replace(scene, objects=(replace(scene.objects[0], furniture="chair 2"),)),
        replace(scene, objects=(replace(scene.objects[0], x_m=math.nan),)),
        replace(scene, objects=(replace(scene.objects[0], turn_rad=math.inf),)),
        replace(scene, objects=scene.objects * (MAX_OBJECTS + 1)),
    ):
        with pytest.raises(BadSceneError):
            write_scene(bad, path)
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_written_whole_and_never_replaced_unasked(tmp_path: Path) -> None:
    path = tmp_path / "home.yaml"
    scene = read_scene(TWO_ROOMS)
    write_scene(scene, path)
    assert read_scene(path) == scene
    other = replace(scene, name="another")
    with pytest.raises(BadFileError, match="exists already"):
        write_scene(other, path)
    assert read_scene(path) == scene
    write_scene(other, path, replace=True)
    assert read_scene(path) == other
    assert [entry.name for entry in tmp_path.iterdir()] == ["home.yaml"]


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="cannot write the scene file .*nowhere.*No such file"):
        write_scene(read_scene(TWO_ROOMS), tmp_path / "nowhere" / "home.yaml")


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="cannot read the scene file .*none.yaml.*No such file"):
        read_scene(tmp_path / "none.yaml")
    with pytest.raises(BadFileError, match="Is a directory"):
        read_scene(tmp_path)


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "home.yaml"
    for content in (SMALL.encode("utf-16"), b"\xff\xfe\x00", "name: küche".encode("latin-1")):
        path.write_bytes(content)
        with pytest.raises(BadFileError, match="not text in UTF-8"):
            read_scene(path)


def test_windows_line_ends_and_byte_order_marks_do_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "home.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + SMALL.replace("\n", "\r\n").encode())
    assert read_scene(path) == parse_scene(SMALL, "a text")


def test_a_file_too_large_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "home.yaml"
    padding = "#" + "x" * (MAX_BYTES - len(SMALL) - 2) + "\n"
    path.write_text(SMALL + padding)
    assert read_scene(path).name == "small"
    path.write_text(SMALL + "#" + padding)
    with pytest.raises(BadFileError, match="larger than 1000000 bytes"):
        read_scene(path)
    for text in (SMALL + "#" + padding, SMALL + "#" + "é" * (MAX_BYTES // 2)):
        with pytest.raises(BadSceneError, match=r"a text has \d+ bytes; a scene file has 1000000 at most"):
            parse_scene(text, "a text")


def test_lists_may_be_empty_and_seeds_null() -> None:
    text = SMALL.replace("name: small", "name: small\nseed: null").replace(
        "furniture:", "doors:\nwindows: []\nfurniture:"
    )
    assert parse_scene(text, "a text") == parse_scene(SMALL, "a text")


def test_the_documentation_has_every_field_word_and_limit() -> None:
    page = DOCS.read_text(encoding="utf-8")
    for name, fields in FIELDS.items():
        heading = f"### {name}\n" if name else "### The file\n"
        section = page.partition(heading)[2].partition("\n#")[0]
        assert section, heading
        assert re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE) == list(fields), heading
    for word in (*COLOURS, *Substance, *Pattern, *Size, *Side):
        assert re.search(rf"\b{word}\b", page), word
    for limit in (MAX_ROOMS, MAX_DOORS, MAX_WINDOWS, MAX_FURNITURE, MAX_OBJECTS):
        assert str(limit) in page
    for default in (DEFAULT_FLOOR, DEFAULT_WALLS):
        assert f"`{default}`" in page


def test_the_example_in_the_documentation_is_the_one_that_is_tested() -> None:
    example = re.search(r"```yaml\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)
    assert example is not None
    assert example[1] == TWO_ROOMS.read_text(encoding="utf-8")

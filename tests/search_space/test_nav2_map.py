from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.nav2_map import read_nav2_map, write_nav2_map

GOOD: dict[str, Any] = {
    "image": "floor.pgm",
    "resolution": 0.05,
    "origin": [-1.5, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
GREYS = np.array([[0, 254], [205, 100]], dtype=np.uint8)


def save(folder: Path, pixels: np.ndarray = GREYS, image: str = "floor.pgm", **changes: Any) -> Path:
    """A map in `folder`; a change to None leaves the key out."""
    Image.fromarray(pixels).save(folder / image)
    content = {key: value for key, value in (GOOD | {"image": image} | changes).items() if value is not None}
    path = folder / "floor.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def cells_of(path: Path) -> list[list[int]]:
    """As the image shows them: the top row first."""
    return read_nav2_map(path).cells[::-1].tolist()


def test_a_map_as_the_map_saver_writes_it(tmp_path):
    """Black is occupied, white free, 205 unknown; 100 is 0.61 occupied: neither. The top row has most y."""
    floor = read_nav2_map(save(tmp_path))
    assert floor.cells.tolist() == [[-1, -1], [100, 0]]
    assert floor.cells.dtype == np.int8
    assert (floor.resolution_m, floor.origin, floor.frame_id) == (0.05, Pose2D(x_m=-1.5, y_m=2.0), "map")


def test_thresholds_themselves_are_unknown(tmp_path):
    """Occupied is above occupied_thresh, free below free_thresh: 0.2 and 0.8 are neither."""
    pixels = np.array([[50, 51, 204, 205]], np.uint8)
    path = save(tmp_path, pixels, negate=1, occupied_thresh=0.8, free_thresh=0.2)
    assert cells_of(path) == [[0, -1, -1, 100]]


@pytest.mark.parametrize("negate", [1, True])
def test_negate_makes_white_occupied(tmp_path, negate):
    assert cells_of(save(tmp_path, negate=negate)) == [[0, 100], [100, -1]]


def test_scale_goes_from_0_to_100_between_the_thresholds(tmp_path):
    """Grey 153 is 0.4 occupied: (0.4 - 0.2) / (0.7 - 0.2) = 40 percent."""
    path = save(
        tmp_path,
        np.array([[255, 204, 153, 77, 76, 0]], np.uint8),
        mode="scale",
        occupied_thresh=0.7,
        free_thresh=0.2,
    )
    assert cells_of(path) == [[0, 0, 40, 100, 100, 100]]


def test_raw_takes_the_grey_itself_whatever_negate_says(tmp_path):
    pixels = np.array([[0, 1, 100, 101, 255]], np.uint8)
    for negate in (0, 1):
        assert cells_of(save(tmp_path, pixels, mode="raw", negate=negate)) == [[0, 1, 100, -1, -1]]


def test_trinary_averages_alpha_into_the_colour(tmp_path):
    """Transparent black is 0: occupied; opaque black is 1/4 light, 0.75 occupied; transparent white 0.25."""
    pixels = np.array([[[0, 0, 0, 0], [0, 0, 0, 255], [255, 255, 255, 0], [255, 255, 255, 255]]], np.uint8)
    path = save(tmp_path, pixels, "floor.png", occupied_thresh=0.8)
    assert cells_of(path) == [[100, -1, -1, 0]]


def test_scale_takes_what_is_not_opaque_for_unknown(tmp_path):
    pixels = np.array([[[0, 0, 0, 254], [0, 0, 0, 255], [255, 255, 255, 0], [255, 255, 255, 255]]], np.uint8)
    assert cells_of(save(tmp_path, pixels, "floor.png", mode="scale")) == [[-1, 100, -1, 0]]


def test_colours_count_by_their_mean(tmp_path):
    """Pure red is a third light: 0.67 occupied."""
    path = save(tmp_path, np.array([[[255, 0, 0], [255, 255, 255]]], np.uint8), "floor.png")
    assert cells_of(path) == [[100, 0]]


@pytest.mark.parametrize(
    "content",
    [
        b"P2\n# by hand\n2 2\n255\n0 254\n205 100\n",
        b"P5\n2 2\n255\n\x00\xfe\xcd\x64",
        b"P5\n2 2\n65535\n\x00\x00\xfe\xfe\xcd\xcd\x64\x64",
    ],
)
def test_every_kind_of_pgm_is_the_same_map(tmp_path, content):
    path = save(tmp_path)
    (tmp_path / "floor.pgm").write_bytes(content)
    assert cells_of(path) == [[100, 0], [-1, -1]]


def test_a_png_of_16_bits_is_the_same_map(tmp_path):
    assert cells_of(save(tmp_path, GREYS.astype(np.uint16) * 257, "floor.png")) == [[100, 0], [-1, -1]]


def test_the_image_is_looked_for_beside_the_yaml_file(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "images").mkdir()
    save(tmp_path / "images")
    path = save(tmp_path / "maps", image="other.pgm")
    monkeypatch.chdir(tmp_path)
    for image in ("../images/floor.pgm", str(tmp_path / "images" / "floor.pgm")):
        path.write_text(yaml.safe_dump(GOOD | {"image": image}))
        assert cells_of(path.relative_to(tmp_path)) == [[100, 0], [-1, -1]]


def test_numbers_as_other_yaml_libraries_write_them(tmp_path):
    path = save(tmp_path)
    path.write_text(path.read_text().replace("0.05", "5e-2").replace("negate: 0", "negate: no"))
    assert read_nav2_map(path).resolution_m == 0.05


@given(data=st.data(), height=st.integers(1, 8), width=st.integers(1, 8))
@settings(max_examples=50, deadline=None)
def test_what_is_written_is_read_again(tmp_path_factory, data, height, width):
    value = st.sampled_from([-1, 0, 100])
    cells = data.draw(st.lists(value, min_size=height * width, max_size=height * width))
    place = st.floats(-1e3, 1e3)
    floor = OccupancyMap(
        cells=np.array(cells, dtype=np.int8).reshape(height, width),
        resolution_m=data.draw(st.floats(1e-6, 10.0)),
        origin=Pose2D(x_m=data.draw(place), y_m=data.draw(place)),
    )
    path = tmp_path_factory.mktemp("map") / "floor.yaml"
    write_nav2_map(floor, path)
    again = read_nav2_map(path)
    np.testing.assert_array_equal(again.cells, floor.cells)
    assert (again.resolution_m, again.origin) == (floor.resolution_m, floor.origin)


@pytest.mark.parametrize("there", ["floor.yaml", "floor.pgm"])
def test_nothing_is_overwritten(tmp_path, there):
    (tmp_path / there).write_text("mine")
    floor = OccupancyMap(
        cells=np.zeros((2, 2), dtype=np.int8), resolution_m=0.1, origin=Pose2D(x_m=0.0, y_m=0.0)
    )
    with pytest.raises(BadFileError, match=f"{there}' exists already"):
        write_nav2_map(floor, tmp_path / "floor.yaml")
    assert [path.name for path in tmp_path.iterdir()] == [there]
    with pytest.raises(BadFileError, match="cannot write the map.*No such file"):
        write_nav2_map(floor, tmp_path / "nowhere" / "floor.yaml")


@pytest.mark.parametrize("key", list(GOOD))
def test_a_missing_key_is_named(tmp_path, key):
    path = save(tmp_path)
    path.write_text(yaml.safe_dump({name: value for name, value in GOOD.items() if name != key}))
    with pytest.raises(BadFileError, match=f"floor.yaml' has no '{key}'"):
        read_nav2_map(path)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"image": 7}, "'image' .* is 7; it must be the name of a file"),
        ({"image": ""}, "'image' .* is ''"),
        ({"image": "gone.pgm"}, "no image .*gone.pgm', which 'image' in .*floor.yaml' names"),
        ({"image": "."}, "cannot be read"),
        ({"resolution": 0.0}, "'resolution' .* is 0.0; .* above 0"),
        ({"resolution": -0.05}, "above 0"),
        ({"resolution": float("nan")}, "'resolution' .* holds nan; it must be a finite number"),
        ({"resolution": True}, "holds True"),
        ({"resolution": [0.05]}, r"holds \[0.05\]"),
        ({"resolution": 10**400}, "must be a finite number"),
        ({"origin": [0.0, 0.0]}, r"'origin' .* must be \[x, y, yaw\], not \[0.0, 0.0\]"),
        ({"origin": "here"}, "not 'here'"),
        ({"origin": [0.0, "far", 0.0]}, "'origin' .* holds 'far'"),
        ({"origin": [0.0, 0.0, 0.3]}, "yaw 0.3 rad; rotated maps are not supported"),
        ({"negate": "perhaps"}, "'negate' .* is 'perhaps'; it must be 0 or 1"),
        ({"occupied_thresh": 0.1}, "'free_thresh' is 0.196 and 'occupied_thresh' is 0.1"),
        ({"occupied_thresh": 65}, "must lie in 0..1"),
        ({"free_thresh": -0.1}, "must lie in 0..1"),
        ({"mode": "fancy"}, "'mode' .* is 'fancy'; it must be one of trinary, scale, raw"),
        ({"mode": ["raw"]}, "'mode'"),
    ],
)
def test_a_wrong_value_is_a_sentence(tmp_path, changes, sentence):
    path = save(tmp_path)
    path.write_text(yaml.safe_dump(GOOD | changes))
    with pytest.raises(BadFileError, match=sentence):
        read_nav2_map(path)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "must hold keys .* not None"),
        (b"- 1\n- 2\n", r"must hold keys .* not \[1, 2\]"),
        (b"image: [", "is not YAML"),
        (b"image: \xff\xfe", "is not YAML"),
        (b"image: 2001-99-99", "is not YAML"),
        (b"[" * 5000, "is not YAML"),
        (b"image: !!python/object/apply:os.getcwd []", "is not YAML"),
    ],
)
def test_a_file_that_is_no_description_is_a_sentence(tmp_path, content, sentence):
    path = tmp_path / "floor.yaml"
    path.write_bytes(content)
    with pytest.raises(BadFileError, match=sentence):
        read_nav2_map(path)


def test_a_file_that_is_not_there_is_a_sentence(tmp_path):
    with pytest.raises(BadFileError, match="cannot read the map .*nothing.yaml': No such file"):
        read_nav2_map(tmp_path / "nothing.yaml")


@pytest.mark.parametrize("image", ["floor.pgm", "floor.png"])
def test_an_image_cut_anywhere_is_a_sentence_or_a_map(tmp_path, image):
    """Never another error; a cut that leaves every pixel is no harm."""
    path = save(tmp_path, image=image)
    whole = (tmp_path / image).read_bytes()
    refused = 0
    for length in range(len(whole)):
        (tmp_path / image).write_bytes(whole[:length])
        try:
            assert cells_of(path) == [[100, 0], [-1, -1]]
        except BadFileError:
            refused += 1
    assert refused > len(whole) // 2


def test_another_kind_of_file_is_no_image(tmp_path):
    path = save(tmp_path)
    for content in (
        b"",
        b"hello",
        b"%PDF-1.7",
        b"P5\n-1 2\n255\n",
        b"P5\n2 2\n0\n\0\0\0\0",
        b"P5\n9999999 9999999\n255\n",
    ):
        (tmp_path / "floor.pgm").write_bytes(content)
        with pytest.raises(BadFileError, match="cannot be read.*must be a PGM, PNG or BMP"):
            read_nav2_map(path)

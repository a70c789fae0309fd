import dataclasses
import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.scene_file import read_scene, write_scene
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

few_examples = settings(max_examples=60, deadline=None)
names = st.text(max_size=8)


@st.composite
def scenes(draw) -> SearchScene:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    poses, candidates = draw(st.integers(1, 12)), draw(st.integers(1, 9))
    visible = rng.random((poses, candidates)) < 0.5
    space = SearchSpace(
        graph=PoseGraph(
            x_m=rng.normal(size=poses),
            y_m=rng.normal(size=poses) * 1e-300,
            yaw_rad=rng.random(poses),
            successors=rng.integers(-1, poses, size=(poses, 4), dtype=np.int32),
            headings=draw(st.integers(1, 72)),
        ),
        candidates=Candidates(
            x_m=rng.normal(size=candidates),
            y_m=rng.normal(size=candidates),
            size_m=float(rng.random()) + 0.01,
        ),
        observability=Observability.of_rows(
            np.concatenate([[0], np.cumsum(visible.sum(axis=1))]),
            np.nonzero(visible)[1].astype(np.int32),
            candidates,
        ),
        frame_id=draw(names),
    )
    targets = tuple(
        SearchTarget(
            label=draw(names),
            in_view=rng.random(poses) < 0.3,
            destination=rng.random(poses) < 0.3 if draw(st.booleans()) else None,
            detections={name: record(rng, poses, candidates) for name in draw(st.lists(names, unique=True))},
        )
        for _ in range(draw(st.integers(0, 2)))
    )
    return SearchScene(
        name=draw(names),
        difficulty=draw(names),
        space=space,
        targets=targets,
        starts=rng.integers(0, poses, size=draw(st.integers(0, 4)), dtype=np.int32),
    )


def record(rng: np.random.Generator, poses: int, candidates: int) -> DetectionRecord:
    lengths = rng.integers(0, candidates + 1, size=rng.integers(0, 6))
    total = int(lengths.sum())
    return DetectionRecord(
        statistics=ClassStatistics(precision=float(rng.random()), recall=float(rng.random())),
        pose=np.sort(rng.integers(0, poses, size=len(lengths), dtype=np.int32)),
        start=np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64),
        candidate=rng.integers(0, candidates, size=total, dtype=np.int32),
        weight=1.0 - rng.random(total),
    )


def assert_same(a, b) -> None:
    """Equal all the way down: types, shapes, dtypes and bits."""
    assert type(a) is type(b)
    if dataclasses.is_dataclass(a):
        for field in dataclasses.fields(a):
            assert_same(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, np.ndarray):
        assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())
    elif isinstance(a, dict):
        assert list(a) == list(b)
        for key in a:
            assert_same(a[key], b[key])
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            assert_same(one, other)
    else:
        assert a == b


@pytest.fixture(scope="module")
def scene() -> SearchScene:
    """Two poses, two candidates, one target with one detection of each detector."""
    once = DetectionRecord(
        statistics=ClassStatistics(precision=0.8, recall=0.6),
        pose=np.array([1], dtype=np.int32),
        start=np.array([0, 2]),
        candidate=np.array([0, 1], dtype=np.int32),
        weight=np.array([1.0, 0.5]),
    )
    space = SearchSpace(
        graph=PoseGraph(
            x_m=np.zeros(2),
            y_m=np.zeros(2),
            yaw_rad=np.array([0.0, np.pi]),
            successors=np.array([[-1, -1, 1, 1], [-1, -1, 0, 0]], dtype=np.int32),
            headings=2,
        ),
        candidates=Candidates(x_m=np.array([1.0, -1.0]), y_m=np.zeros(2), size_m=0.2),
        observability=Observability.of_rows(np.array([0, 1, 3]), np.array([0, 0, 1], dtype=np.int32), 2),
    )
    target = SearchTarget(
        label="mug",
        in_view=np.array([False, True]),
        destination=np.array([False, True]),
        detections={"perfect": once, "noisy": once},
    )
    return SearchScene(
        name="one", difficulty="easy", space=space, targets=(target,), starts=np.array([0], dtype=np.int32)
    )


@pytest.fixture(scope="module")
def written(scene, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("scenes") / "one.npz"
    write_scene(scene, path)
    return path


def changed(written: Path, path: Path, **arrays: np.ndarray | None) -> Path:
    """A copy of the file with some arrays changed, or left out where None; `__` stands for a slash."""
    with np.load(written) as old:
        content = dict(old) | {name.replace("__", "/"): array for name, array in arrays.items()}
    with path.open("wb") as output:
        np.savez(output, **{name: array for name, array in content.items() if array is not None})
    return path


def about(**changes: object) -> np.ndarray:
    """The header of a scene without targets, changed."""
    entries = {
        "format": "robustnav search scene",
        "version": 1,
        "name": "",
        "difficulty": "",
        "frame_id": "map",
        "headings": 2,
        "candidate_size_m": 0.2,
        "targets": [],
    }
    return np.frombuffer(json.dumps(entries | changes).encode(), dtype=np.uint8)


@given(scene=scenes())
@few_examples
def test_what_is_written_is_read_bit_for_bit(tmp_path_factory, scene):
    path = tmp_path_factory.mktemp("scene") / "scene.npz"
    write_scene(scene, path)
    assert_same(read_scene(path), scene)


def test_same_scene_gives_the_same_bytes(scene, written, tmp_path):
    write_scene(read_scene(written), tmp_path / "again.npz")
    assert (tmp_path / "again.npz").read_bytes() == written.read_bytes()


def test_numpy_reads_it_without_pickle(written):
    with np.load(written, allow_pickle=False) as arrays:
        assert arrays["target/0/in_view"].tolist() == [False, True]


def test_nothing_is_overwritten(scene, tmp_path):
    path = tmp_path / "scene.npz"
    path.write_bytes(b"precious")
    with pytest.raises(BadFileError, match=r"exists already: remove it"):
        write_scene(scene, path)
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("scene.npz", b"precious")]


def test_where_nothing_can_be_written_nothing_is_left(scene, tmp_path):
    (tmp_path / "file").touch()
    for folder in ("file", "missing"):
        with pytest.raises(BadFileError, match=r"cannot write the scene file .*scene\.npz"):
            write_scene(scene, tmp_path / folder / "scene.npz")
    assert [file.name for file in tmp_path.iterdir()] == ["file"]


def test_a_disk_that_fills_up_leaves_nothing(scene, tmp_path, monkeypatch):
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(BadFileError, match="No space left"):
        write_scene(scene, tmp_path / "scene.npz")
    assert list(tmp_path.iterdir()) == []


@given(share=st.floats(0.0, 1.0, exclude_max=True))
@few_examples
def test_a_cut_file_is_refused(written, tmp_path_factory, share):
    content = written.read_bytes()
    cut = tmp_path_factory.mktemp("cut") / "cut.npz"
    cut.write_bytes(content[: int(share * len(content))])
    with pytest.raises(BadFileError, match=r"cut\.npz.*write or import it anew"):
        read_scene(cut)


@given(data=st.data())
@settings(max_examples=300, deadline=None)
def test_a_damaged_file_is_refused_or_says_the_same(scene, written, tmp_path_factory, data):
    """Some bytes, such as the date of a zip entry, mean nothing to us."""
    content = bytearray(written.read_bytes())
    content[data.draw(st.integers(0, len(content) - 1))] ^= data.draw(st.integers(1, 255))
    damaged = tmp_path_factory.mktemp("damaged") / "scene.npz"
    damaged.write_bytes(content)
    try:
        read = read_scene(damaged)
    except BadFileError:
        return
    assert_same(read, scene)


def test_files_of_others_are_refused(tmp_path):
    path = tmp_path / "other"
    with pytest.raises(BadFileError, match="cannot read"):
        read_scene(path)
    with pytest.raises(BadFileError, match="cannot read"):
        read_scene(tmp_path)
    path.write_text("hello")
    with pytest.raises(BadFileError, match="not a zip file"):
        read_scene(path)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("letter.txt", "hello")
    with pytest.raises(BadFileError, match="cannot be unpacked"):
        read_scene(path)
    for array in (np.zeros(3), np.array([{}], dtype=object)):
        other = io.BytesIO()
        np.savez(other, x=array, allow_pickle=True)
        path.write_bytes(other.getvalue())
        with pytest.raises(BadFileError, match=r"lacks 'about'|allow_pickle"):
            read_scene(path)


def test_a_file_that_unpacks_to_too_much_is_refused(written, tmp_path, monkeypatch):
    monkeypatch.setattr("robustnav_nodes.benchmarks.scene_file._MAX_BYTES", 1000)
    with pytest.raises(BadFileError, match=r"it holds .* GB"):
        read_scene(written)


def test_another_version_is_refused(written, tmp_path):
    newer = changed(written, tmp_path / "newer.npz", about=about(version=2))
    with pytest.raises(BadFileError, match="of version 2, this robustnav reads version 1"):
        read_scene(newer)


@pytest.mark.parametrize(
    ("arrays", "sentence"),
    [
        ({"starts": None}, "it lacks 'starts'"),
        ({"starts": np.array([2], np.int32)}, r"'starts' holds 2 \.\. 2, which is not within 0 \.\. 1"),
        ({"starts": np.array([0])}, r"'starts' is int64 \[1\], not int32 \['any'\]"),
        ({"pose__y_m": np.zeros(3)}, r"'pose/y_m' is float64 \[3\], not float64 \[2\]"),
        ({"pose__y_m": np.array([0.0, np.nan])}, "'pose/y_m' holds numbers that are not finite"),
        ({"pose__successors": np.full((2, 4), -2, np.int32)}, r"not within -1 \.\. 1"),
        ({"observability__seen": np.array([0, 1, 0], np.int32)}, "does not ascend within each pose"),
        ({"observability__seen_start": np.array([0, 2, 2])}, "does not ascend from 0 to 3"),
        ({"observability__seen_start": np.array([0, 2**62, 3])}, "does not ascend from 0 to 3"),
        ({"target__0__in_view": np.zeros(2)}, "'target/0/in_view' is float64"),
        ({"target__0__destination": None}, "it lacks 'target/0/destination'"),
        ({"target__0__detector__0__weight": np.array([1.0, 0.0])}, "a weight is not positive"),
        ({"target__0__detector__1__start": np.array([0, 1])}, "does not ascend from 0 to 2"),
        ({"about": np.frombuffer(b"{", dtype=np.uint8)}, "'about' is not JSON"),
        ({"about": np.frombuffer(b"[" * 100_000, dtype=np.uint8)}, "'about' is not JSON"),
        ({"about": about(format="cookbook")}, "its format is 'cookbook'"),
        ({"about": about(headings="many")}, "'headings' in its 'about' must be of type int, not 'many'"),
        ({"about": about(headings=True)}, "must be of type int, not True"),
        ({"about": about(headings=0)}, "make no sense"),
        ({"about": about(candidate_size_m=float("nan"))}, "make no sense"),
        ({"about": about(targets=[7])}, "'has_destination' in its 'about' must be of type bool"),
    ],
)
def test_what_does_not_hold_together_is_refused(written, tmp_path, arrays, sentence):
    path = changed(written, tmp_path / "bad.npz", **arrays)
    with pytest.raises(BadFileError, match=sentence):
        read_scene(path)


def test_statistics_out_of_range_are_refused(written, tmp_path):
    detector = {"name": "noisy", "precision": 1.5, "recall": 0.5}
    target = {"label": "mug", "has_destination": True, "detectors": [detector]}
    path = changed(written, tmp_path / "bad.npz", about=about(targets=[target]))
    with pytest.raises(BadFileError, match=r"precision is 1\.5"):
        read_scene(path)

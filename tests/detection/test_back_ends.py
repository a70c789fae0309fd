"""A back end that cannot be made says in a sentence what is missing."""

import builtins
from pathlib import Path
from typing import Any

import pytest

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.parameters import build
from robustnav_nodes.detection.back_ends import make_detector
from robustnav_nodes.detection.class_names import read_class_names
from robustnav_nodes.detection.parameters import DetectionParameters

MODULES = {"learned": "learned.detector", "onnx": "onnx_detector", "open_vocabulary": "open_vocabulary"}


def make(**values: Any) -> Any:
    return make_detector(build(DetectionParameters, values))


def test_truth_does_not_look_at_pixels() -> None:
    with pytest.raises(BadParameterError, match="'truth' does not look at pixels"):
        make(back_end="truth")


@pytest.mark.parametrize("back_end", ["onnx", "open_vocabulary"])
def test_a_model_must_be_named_and_there(back_end: str, tmp_path: Path) -> None:
    with pytest.raises(BadParameterError, match="set the parameter model"):
        make(back_end=back_end, class_names=["mug"])
    with pytest.raises(BadFileError, match="there is no"):
        make(back_end=back_end, class_names=["mug"], model=str(tmp_path / "nowhere"))


@pytest.mark.parametrize(
    ("back_end", "package", "extra"),
    [("learned", "torch", "learn"), ("onnx", "cv2", "onnx"), ("open_vocabulary", "torch", "open-vocabulary")],
)
def test_what_is_not_installed_is_named(
    back_end: str, package: str, extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.startswith("robustnav_nodes.detection.") and name.endswith(MODULES[back_end]):
            raise ImportError(f"No module named {package!r}")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(BadParameterError, match=rf"No module named '{package}'.*robustnav\[{extra}\]"):
        make(back_end=back_end, model=str(tmp_path), class_names=["mug"])


def test_class_names_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "names.txt"
    path.write_text("# of the model\nmug\n\n coffee cup \n")
    assert read_class_names([], str(path)) == ("mug", "coffee cup")


@pytest.mark.parametrize(
    ("names", "words"),
    [([], "no class names"), (["mug", "mug"], "'mug' 2 times"), (["mug, cup"], "must not hold a comma")],
)
def test_class_names_that_cannot_be(names: list[str], words: str) -> None:
    with pytest.raises(BadParameterError, match=words):
        read_class_names(names, "")


def test_class_files_that_cannot_be(tmp_path: Path) -> None:
    path = tmp_path / "names.txt"
    with pytest.raises(BadFileError, match="No such file"):
        read_class_names([], str(path))
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadFileError, match="are no text"):
        read_class_names([], str(path))
    with pytest.raises(BadParameterError, match="give one of the two"):
        read_class_names(["mug"], str(path))

"""Makes the back ends that look at pixels. What each stands on is imported only when it is wanted."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, cast

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.detection.class_names import read_class_names
from robustnav_nodes.detection.parameters import LEARNED, DetectionParameters
from robustnav_nodes.detection.pixel_detector import PixelDetector

if TYPE_CHECKING:  # they stand on torch
    from robustnav_nodes.detection.learned.detector import LearnedDetector
    from robustnav_nodes.detection.learned.wanted_instance import WantedInstance


def make_detector(parameters: DetectionParameters) -> PixelDetector:
    """The back end that `parameters` ask for, `truth` apart; takes seconds.

    Raises BadParameterError where it is not installed or parameters are missing, BadFileError where the
    model or the class names cannot be read or do not fit each other.
    """
    makers: dict[str, Callable[[DetectionParameters], PixelDetector]] = {
        LEARNED: _learned,
        "onnx": _onnx,
        "open_vocabulary": _open_vocabulary,
    }
    if parameters.back_end not in makers:
        raise BadParameterError(
            f"back_end {parameters.back_end!r} does not look at pixels; those that do: {', '.join(makers)}"
        )
    try:
        return makers[parameters.back_end](parameters)
    except ImportError as error:
        extra = {LEARNED: "learn"}.get(parameters.back_end, parameters.back_end.replace("_", "-"))
        raise BadParameterError(
            f"back_end {parameters.back_end!r} cannot run here: {error}; "
            f"install what it stands on: pip install 'robustnav[{extra}]'"
        ) from error


def make_instance(parameters: DetectionParameters, detector: PixelDetector) -> "WantedInstance | None":
    """The one object that `parameters` ask for, if they do, as `detector` (made from them) knows it.

    Raises what `check_instance` raises, BadParameterError where it is not clear which object is meant, and
    BadFileError where its picture cannot be read.
    """
    check_instance(parameters)
    if not parameters.instance_picture:
        return None
    from robustnav_nodes.detection.learned.wanted_instance import WantedInstance, read_picture

    return WantedInstance(
        cast("LearnedDetector", detector),
        read_picture(Path(parameters.instance_picture).expanduser()),
        label=parameters.instance_class,
        height_m=parameters.instance_height_m,
    )


def check_instance(parameters: DetectionParameters) -> None:
    """Raises BadParameterError where one object alone is asked for and cannot be told from others."""
    if parameters.instance_picture and parameters.back_end != LEARNED:
        raise BadParameterError(
            f"instance_picture is for the back end {LEARNED!r}; {parameters.back_end!r} cannot tell two "
            "objects of a class apart"
        )


def _learned(parameters: DetectionParameters) -> PixelDetector:
    from robustnav_nodes.detection.learned.detector import LearnedDetector
    from robustnav_nodes.detection.learned.weights import SHIPPED, load_weights

    path = Path(parameters.model).expanduser() if parameters.model else SHIPPED
    named = bool(parameters.class_names or parameters.class_names_file)
    labels = read_class_names(parameters.class_names, parameters.class_names_file) if named else None
    detector: PixelDetector = LearnedDetector(load_weights(path, labels), parameters.score_min)
    return detector


def _onnx(parameters: DetectionParameters) -> PixelDetector:
    path = _model_path(parameters, "an ONNX file")
    labels = read_class_names(parameters.class_names, parameters.class_names_file)
    from robustnav_nodes.detection.onnx_detector import OnnxDetector

    return OnnxDetector(
        path,
        labels=labels,
        score_min=parameters.score_min,
        nms_iou=parameters.nms_iou,
        input_size_px=parameters.input_size_px,
    )


def _open_vocabulary(parameters: DetectionParameters) -> PixelDetector:
    path = _model_path(parameters, "a folder with a model that transformers saved")
    labels = read_class_names(parameters.class_names, parameters.class_names_file)
    from robustnav_nodes.detection.open_vocabulary import OpenVocabularyDetector

    return OpenVocabularyDetector(
        path,
        labels=labels,
        score_min=parameters.score_min,
        nms_iou=parameters.nms_iou,
    )


def _model_path(parameters: DetectionParameters, what: str) -> Path:
    if not parameters.model:
        raise BadParameterError(
            f"back_end {parameters.back_end!r} needs {what}: set the parameter model; nothing is downloaded"
        )
    path = Path(parameters.model).expanduser()
    if not path.exists():
        raise BadFileError(
            f"there is no {str(path)!r}; back_end {parameters.back_end!r} needs {what} there: "
            "set the parameter model"
        )
    return path

"""What decides the detections: the back end and its dials, and where boxes are placed in depth."""

from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter

TRUTH, LEARNED = "truth", "learned"
BACK_ENDS = (TRUTH, LEARNED, "onnx", "open_vocabulary")
# What a back end is made from: a change takes the node's configuring.
OF_THE_MAKING = ("back_end", "instance_picture", "instance_class", "instance_height_m")


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectionParameters:
    """The back end, what it is made from, its dials, and the placing of boxes.

    `truth` sees the simulated home's ground truth through dials; the others look at the pixels. The back end
    and what it is made from are read when the node is configured.
    """

    back_end: str = parameter(TRUTH, "what looks at the images", choices=BACK_ENDS)
    seed: int = parameter(
        1, "truth: decides which objects are missed and imagined from where", low=0, high=2**31 - 1
    )

    recall: float = parameter(
        0.6, "truth: chance that an object within the limits is detected from a pose", low=0.0, high=1.0
    )
    precision: float = parameter(
        0.8, "truth: part of a class's detections that are right", low=0.05, high=1.0
    )
    prevalence: float = parameter(
        0.1,
        "truth: part of all views that show an object of a class; sets how often one is imagined",
        low=0.0,
        high=1.0,
    )
    range_max_m: float = parameter(
        4.0, "truth: farthest distance at which objects are seen", unit="m", low=0.2, high=30.0
    )
    visible_fraction_min: float = parameter(
        0.3, "truth: an object must show at least this part of itself", low=0.01, high=1.0
    )
    class_dials: list[str] = parameter(
        [], "truth: dials of single classes, such as 'mug recall=0.4 precision=0.9 range_max_m=2.5'"
    )
    view_spacing_m: float = parameter(
        0.3, "truth: views within a cell of this size err alike", unit="m", low=0.01, high=5.0
    )
    view_headings: int = parameter(12, "truth: and within one of this many headings", low=1, high=360)

    model: str = parameter(
        "",
        "learned: weights, empty for those that come along; onnx: the model file; "
        "open_vocabulary: folder of the model",
    )
    class_names: list[str] = parameter(
        [],
        "onnx, open_vocabulary: the class names, in the order of the model's outputs; learned: those that "
        "its weights must be for, empty: whatever they are for",
    )
    class_names_file: str = parameter("", "text file of the class names instead, one on a line")
    score_min: float = parameter(
        0.3, "learned, onnx, open_vocabulary: boxes with a lower score are dropped", low=0.0, high=1.0
    )
    nms_iou: float = parameter(
        0.5,
        "onnx, open_vocabulary: of two boxes of a class that overlap by more (IoU) the better one stays",
        low=0.05,
        high=1.0,
    )
    input_size_px: int = parameter(
        640, "onnx: side of the square that the model looks at", unit="px", low=32, high=4096
    )
    instance_picture: str = parameter(
        "", "learned: picture of the one object that is meant; others of its class are left out"
    )
    instance_class: str = parameter(
        "", "learned: the class of what instance_picture shows, empty: what the detector sees there"
    )
    instance_height_m: float = parameter(
        0.0, "learned: how tall that object is, 0: not known", unit="m", low=0.0, high=5.0
    )
    instance_likeness_min: float = parameter(
        0.95, "learned: what is less like it is left out; 1 is the same look", low=0.0, high=1.0
    )
    rate_max_hz: float = parameter(
        0.0,
        "learned, onnx, open_vocabulary: at most so many images a second, by their stamps; 0: no limit",
        unit="Hz",
        low=0.0,
        high=100.0,
    )
    load_again_s: float = parameter(
        5.0, "a back end that could not be made is tried again after", unit="s", low=0.5, high=600.0
    )

    depth_gap_m: float = parameter(
        0.12, "surfaces in a box are parted where depth jumps by more than this", unit="m", low=0.01, high=2.0
    )
    depth_cover: float = parameter(
        0.4, "the nearest surface that covers this part of a box is the object", low=0.05, high=1.0
    )
    depth_behind: float = parameter(
        0.2,
        "an object's middle lies behind its face by this part of its box's smaller side",
        low=0.0,
        high=1.0,
    )
    depth_samples_min: int = parameter(3, "valid depth samples that a box needs", low=1, high=10_000)
    marker_lifetime_s: int = parameter(1, "how long markers stay", unit="s", low=1, high=60)
    image_wait: int = parameter(
        8, "images of which only parts have come that are kept waiting", unit="images", low=1, high=100
    )

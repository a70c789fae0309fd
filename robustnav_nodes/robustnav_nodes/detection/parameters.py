"""What decides the detections: the back end, its dials, and where boxes are placed in depth."""

from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter

BACK_ENDS = ("truth",)


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectionParameters:
    """The back end and its dials. The dials are those of the `truth` back end, for the simulated home."""

    back_end: str = parameter("truth", "what looks at the images", choices=BACK_ENDS)
    seed: int = parameter(
        1, "decides which objects are missed and imagined from where", low=0, high=2**31 - 1
    )

    recall: float = parameter(
        0.6, "chance that an object within the limits is detected from a pose", low=0.0, high=1.0
    )
    precision: float = parameter(0.8, "part of a class's detections that are right", low=0.05, high=1.0)
    prevalence: float = parameter(
        0.1,
        "part of all views that show an object of a class; sets how often one is imagined",
        low=0.0,
        high=1.0,
    )
    range_max_m: float = parameter(
        4.0, "farthest distance at which objects are seen", unit="m", low=0.2, high=30.0
    )
    visible_fraction_min: float = parameter(
        0.3, "an object must show at least this part of itself", low=0.01, high=1.0
    )
    class_dials: list[str] = parameter(
        [], "dials of single classes, such as 'mug recall=0.4 precision=0.9 range_max_m=2.5'"
    )
    view_spacing_m: float = parameter(
        0.3, "views within a cell of this size err alike", unit="m", low=0.01, high=5.0
    )
    view_headings: int = parameter(12, "and within one of this many headings", low=1, high=360)

    depth_part: float = parameter(
        0.5, "middle part of a box whose median depth is the object's", low=0.05, high=1.0
    )
    depth_samples_min: int = parameter(3, "valid depth samples that a box needs", low=1, high=10_000)
    marker_lifetime_s: int = parameter(1, "how long markers stay", unit="s", low=1, high=60)
    image_wait: int = parameter(
        8, "images of which only parts have come that are kept waiting", unit="images", low=1, high=100
    )

"""Dials of the simulated detector: how well it knows each class."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.detection.parameters import DetectionParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class Dials:
    """How well the detector knows one class; the meaning of each is its parameter's."""

    recall: float
    precision: float
    prevalence: float
    range_max_m: float
    visible_fraction_min: float

    def __post_init__(self) -> None:
        for name in ("recall", "precision", "prevalence", "visible_fraction_min"):
            value = getattr(self, name)
            if not 0.0 <= value <= 1.0:
                raise BadParameterError(f"dial {name} is {value!r}; it must lie in 0..1")
        if self.precision == 0.0 or self.range_max_m <= 0.0:
            raise BadParameterError(
                f"dials precision ({self.precision!r}) and range_max_m ({self.range_max_m!r}) must be above 0"
            )

    @property
    def p_imagined(self) -> float:
        """Chance that a view shows an imagined object of the class.

        Of all detections of the class the part `precision` is right: right ones come at the rate
        prevalence * recall, so imagined ones at that times (1 - precision) / precision.
        """
        return min(1.0, self.prevalence * self.recall * (1.0 - self.precision) / self.precision)


def dials_by_class(parameters: DetectionParameters, labels: Sequence[str]) -> dict[str, Dials]:
    """The dials of every class in `labels`; raises BadParameterError for a line that cannot be read."""
    common = Dials(
        recall=parameters.recall,
        precision=parameters.precision,
        prevalence=parameters.prevalence,
        range_max_m=parameters.range_max_m,
        visible_fraction_min=parameters.visible_fraction_min,
    )
    dials = dict.fromkeys(labels, common)
    for line in parameters.class_dials:
        label, settings = _read_line(line)
        if label not in dials:
            raise BadParameterError(
                f"class_dials has {line!r}; known classes are {', '.join(sorted(labels))}"
            )
        dials[label] = replace(common, **settings)
    return dials


def _read_line(line: str) -> tuple[str, dict[str, float]]:
    """'coffee cup recall=0.4' -> ('coffee cup', {'recall': 0.4})."""
    words = line.split()
    label = " ".join(word for word in words if "=" not in word)
    settings: dict[str, float] = {}
    for name, _, text in (word.partition("=") for word in words if "=" in word):
        try:
            settings[name] = float(text)
        except ValueError as error:
            raise BadParameterError(f"class_dials has {line!r}; {text!r} is no number") from error
    unknown = settings.keys() - set(Dials.__dataclass_fields__)
    if unknown or not label or not settings:
        raise BadParameterError(
            f"class_dials has {line!r}; write 'CLASS DIAL=NUMBER ...' "
            f"with dials {', '.join(Dials.__dataclass_fields__)}"
        )
    return label, settings

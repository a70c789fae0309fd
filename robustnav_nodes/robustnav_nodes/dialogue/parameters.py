"""What decides the dialogue."""

from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class DialogueParameters:
    """Limits of what is read and said."""

    max_line_chars: int = parameter(
        500, "longer lines of the person are not read", unit="characters", low=20, high=100_000
    )
    max_names: int = parameter(40, "class names listed in one answer at most", low=1, high=1000)

"""What decides the simulated person."""

from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedUserParameters:
    """What the person wants, and how patient they are."""

    target: str = parameter("", "class of the object to ask for; empty: one that is there only once, by seed")
    seed: int = parameter(1, "decides the object when none is named", low=0, high=2**31 - 1)
    ask_after_s: float = parameter(
        2.0,
        "the first request comes after; a recorder hears people a little late",
        unit="s",
        low=0.0,
        high=600.0,
    )
    ask_again_s: float = parameter(
        15.0, "an unanswered request is said again after", unit="s", low=1.0, high=600.0
    )
    check_period_s: float = parameter(0.5, "how often the person looks up", unit="s", low=0.05, high=10.0)

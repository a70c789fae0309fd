"""What publishers offer on a topic, how bags store it, and what a recorder asks for to hear them all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import yaml

from robustnav_msgs_py.errors import BadFileError

INFINITE_NS = 2**63 - 1
NS_PER_S = 1_000_000_000
# In the order of the numbers that bags older than Jazzy hold in their place.
HISTORY = ("system_default", "keep_last", "keep_all", "unknown")
RELIABILITY = ("system_default", "reliable", "best_effort", "unknown", "best_available")
DURABILITY = ("system_default", "transient_local", "volatile", "unknown", "best_available")
LIVELINESS = ("system_default", "automatic", "manual_by_node", "manual_by_topic", "unknown", "best_available")


@dataclass(frozen=True, slots=True, kw_only=True)
class OfferedQos:
    """Quality of service that one publisher offers, in rosbag2's words.

    reliability: reliable | best_effort; durability: volatile | transient_local; history: keep_last |
    keep_all; liveliness: automatic | manual_by_topic. A policy that discovery does not tell is "unknown"
    (over DDS the history always is, with depth 0). Durations are nanoseconds, INFINITE_NS where unlimited.
    """

    reliability: str = "reliable"
    durability: str = "volatile"
    history: str = "keep_last"
    depth: int = 10
    deadline_ns: int = INFINITE_NS
    lifespan_ns: int = INFINITE_NS
    liveliness: str = "automatic"
    liveliness_lease_ns: int = INFINITE_NS

    def as_mapping(self) -> dict[str, Any]:
        """The mapping that rosbag2 (metadata version 9) writes for this profile."""
        return {
            "history": self.history,
            "depth": self.depth,
            "reliability": self.reliability,
            "durability": self.durability,
            "deadline": _duration(self.deadline_ns),
            "lifespan": _duration(self.lifespan_ns),
            "liveliness": self.liveliness,
            "liveliness_lease_duration": _duration(self.liveliness_lease_ns),
            "avoid_ros_namespace_conventions": False,
        }

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, Any]) -> Self:
        """Read what `as_mapping` or any rosbag2 made; raises BadFileError where a policy is missing."""
        try:
            return cls(
                reliability=_word(mapping["reliability"], RELIABILITY),
                durability=_word(mapping["durability"], DURABILITY),
                history=_word(mapping["history"], HISTORY),
                depth=int(mapping["depth"]),
                deadline_ns=_nanoseconds(mapping["deadline"]),
                lifespan_ns=_nanoseconds(mapping["lifespan"]),
                liveliness=_word(mapping["liveliness"], LIVELINESS),
                liveliness_lease_ns=_nanoseconds(mapping["liveliness_lease_duration"]),
            )
        except (IndexError, KeyError, TypeError, ValueError) as error:
            raise BadFileError(f"this is no QoS profile of a topic: {mapping!r} ({error!r})") from error


def offers_as_text(offers: Sequence[OfferedQos]) -> str:
    """The YAML text that stands in a channel's metadata of an MCAP file."""
    return str(yaml.safe_dump([offer.as_mapping() for offer in offers], sort_keys=False)) if offers else ""


def offers_from_text(text: str) -> tuple[OfferedQos, ...]:
    """Inverse of `offers_as_text`; raises BadFileError for anything that is not a list of profiles."""
    try:
        rows = yaml.safe_load(text) or []
    except yaml.YAMLError as error:
        raise BadFileError(f"the offered QoS of a topic is not YAML: {text[:80]!r}") from error
    if not isinstance(rows, list):
        raise BadFileError(f"the offered QoS of a topic must be a list, not {text[:80]!r}")
    return tuple(OfferedQos.from_mapping(row) for row in rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What a subscription asks for; less than every publisher offers, so that all of them match."""

    reliable: bool
    latched: bool


def request_for(offers: Sequence[OfferedQos]) -> Request:
    """The most that all of `offers` grant: a lone best-effort publisher makes the request best effort."""
    return Request(
        reliable=all(offer.reliability == "reliable" for offer in offers),
        latched=all(offer.durability == "transient_local" for offer in offers),
    )


def _word(policy: str | int, words: tuple[str, ...]) -> str:
    return words[policy] if isinstance(policy, int) else str(policy)


def _duration(nanoseconds: int) -> dict[str, int]:
    return {"sec": nanoseconds // NS_PER_S, "nsec": nanoseconds % NS_PER_S}


def _nanoseconds(duration: Mapping[str, Any]) -> int:
    return int(duration["sec"]) * NS_PER_S + int(duration["nsec"])

"""The quality of service with which a topic of a bag is played."""

from dataclasses import replace

from bags.bag_metadata import TopicRow
from bags.offered_qos import OfferedQos
from robustnav_msgs_py import contract

# Each of many speakers latched one transform there, and what one said does not replace what another did.
DEPTHS = {"/tf_static": 100}


def offer_to_play(row: TopicRow, *, depth: int) -> OfferedQos:
    """What the player offers in place of all who spoke on a topic: the most that any of them offered.

    So everyone who heard one of them hears the player. Where they differ in deadline, lifespan or liveliness,
    none of these is offered. Volatile topics keep at least `depth` messages for slow listeners, as many as
    may come at once when a bag is played fast; latched ones keep `latched_depth(row)`.
    """
    told = row.offers
    alike = bool(told) and all(replace(offer, depth=told[0].depth) == told[0] for offer in told)
    latched = is_latched(row)
    return replace(
        told[0] if alike else OfferedQos(),
        reliability="best_effort"
        if told and all(offer.reliability == "best_effort" for offer in told)
        else "reliable",
        durability="transient_local" if latched else "volatile",
        history="keep_last",
        depth=latched_depth(row) if latched else max(depth, *(offer.depth for offer in told), 1),
    )


def is_latched(row: TopicRow) -> bool:
    """Whether anybody latched on the topic."""
    return any(offer.durability == "transient_local" for offer in row.offers)


def latched_depth(row: TopicRow) -> int:
    """How many messages of a latched topic a late listener gets.

    Discovery does not tell it, so most bags do not: then it is the contract's for topics of ours, and one
    for each speaker for others.
    """
    told = [offer for offer in row.offers if offer.durability == "transient_local"]
    if told and all(offer.depth > 0 for offer in told):
        return max(sum(offer.depth for offer in told), DEPTHS.get(row.name, 0))
    ours = (
        topic.qos.depth
        for topic in contract.TOPICS
        if topic.qos.latched and topic.type == row.type and f"/{row.name}".endswith(f"/{topic.name}")
    )
    return max(len(told), DEPTHS.get(row.name, 0), *ours, 1)

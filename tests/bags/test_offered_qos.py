import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.offered_qos import OfferedQos, offers_as_text, offers_from_text, request_for
from robustnav_msgs_py.errors import BadFileError

NANOSECONDS = st.integers(0, 2**63 - 1)
OFFERS = st.builds(
    OfferedQos,
    reliability=st.sampled_from(["reliable", "best_effort"]),
    durability=st.sampled_from(["volatile", "transient_local"]),
    history=st.sampled_from(["keep_last", "keep_all", "unknown"]),
    depth=st.integers(0, 10_000),
    deadline_ns=NANOSECONDS,
    lifespan_ns=NANOSECONDS,
    liveliness=st.sampled_from(["automatic", "manual_by_topic"]),
    liveliness_lease_ns=NANOSECONDS,
)


@given(st.lists(OFFERS, max_size=3))
def test_offers_survive_as_text(offers: list[OfferedQos]) -> None:
    assert offers_from_text(offers_as_text(offers)) == tuple(offers)


@given(st.lists(OFFERS, min_size=1, max_size=5))
def test_the_request_matches_every_publisher_and_asks_for_all_they_grant(offers: list[OfferedQos]) -> None:
    request = request_for(offers)
    assert request.reliable == (not any(offer.reliability == "best_effort" for offer in offers))
    assert request.latched == (not any(offer.durability == "volatile" for offer in offers))


def test_a_bag_older_than_jazzy_has_numbers_in_place_of_words() -> None:
    text = """- {history: 1, depth: 5, reliability: 2, durability: 1, lifespan: {sec: 0, nsec: 0},
    deadline: {sec: 2147483647, nsec: 4294967295}, liveliness: 1,
    liveliness_lease_duration: {sec: 1, nsec: 5}, avoid_ros_namespace_conventions: false}"""
    (offer,) = offers_from_text(text)
    words = (offer.history, offer.reliability, offer.durability, offer.liveliness)
    assert words == ("keep_last", "best_effort", "transient_local", "automatic")
    assert offer.liveliness_lease_ns == 1_000_000_005


@pytest.mark.parametrize("text", ["{", "words", "- 3", "- {history: keep_last}", "- {history: 99}"])
def test_what_is_no_profile_is_refused(text: str) -> None:
    with pytest.raises(BadFileError):
        offers_from_text(text)

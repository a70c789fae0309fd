"""Injected errors are where they are said to be, of the wanted kinds, and the same for the same seed."""

from dataclasses import replace

import numpy as np
import pytest

from robustnav_nodes.instruction import injection
from robustnav_nodes.instruction.common_sense import CommonSense, anything_goes, derive_common_sense
from robustnav_nodes.instruction.concepts import OBJECTS, ROOMS
from robustnav_nodes.instruction.episodes import ERROR_TYPES, Instruction
from robustnav_nodes.instruction.injection import Injector, episodes_put_in, error_episodes, error_statistics
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.wording import learn_wording


@pytest.mark.parametrize("error_type", ERROR_TYPES)
def test_wrong_words_are_where_the_truth_says(instruction: Instruction, error_type: str) -> None:
    clean, wrong = error_episodes([instruction], error_type, Injector(common_sense=anything_goes()), 7)
    assert (clean.label, wrong.label) == (0, 1)
    assert [span.kind for span in sorted(wrong.wrong, key=lambda s: s.kind)] == sorted(
        ERROR_TYPES[error_type]
    )
    mentions = {(m.start, m.length): m for m in find_mentions(wrong.tokens)}
    for span in wrong.wrong:
        assert mentions[span.start, span.length].concept == span.wrong != span.right
    kept = [
        t for k, t in enumerate(wrong.tokens) if not any(0 <= k - s.start < s.length for s in wrong.wrong)
    ]
    assert set(kept) <= set(clean.tokens)


def test_the_seed_decides(instruction: Instruction) -> None:
    injector = Injector(common_sense=anything_goes())
    some = [replace(instruction, key=str(k)) for k in range(20)]
    assert list(error_episodes(some, "all", injector, 1)) == list(error_episodes(some, "all", injector, 1))
    assert list(error_episodes(some, "all", injector, 1)) != list(error_episodes(some, "all", injector, 2))


def test_common_sense_is_kept(instruction: Instruction) -> None:
    injector = Injector(common_sense=CommonSense(rooms={"kitchen": ("hallway",)}, objects={}))
    for seed in range(10):
        wrong = list(error_episodes([instruction], "room", injector, seed))[1]
        assert (wrong.wrong[0].right, wrong.wrong[0].wrong) == ("kitchen", "hallway")
    assert list(error_episodes([instruction], "object", injector, 1)) == []


def test_matched_takes_the_likely_word(instruction: Instruction) -> None:
    """Of two replacements, one that people write there and one that nobody does, the first is taken."""
    usual = [tokenized(f"stop in the {room} next to the refrigerator") for room in ("kitchen", "patio")] * 50
    rooms = {"kitchen": ("garage", "patio"), "garage": ("kitchen",), "patio": ("kitchen",)}
    injector = Injector(common_sense=CommonSense(rooms=rooms, objects={}), wording=learn_wording(usual))
    some = [replace(instruction, key=str(k)) for k in range(100)]
    taken = [e.wrong[0].wrong for e in error_episodes(some, "room", injector, 1) if e.wrong]
    assert taken.count("patio") > 20 * max(1, taken.count("garage"))


def test_of_single_draws_rare_words_are_put_in_as_often_as_taken_out(
    instruction: Instruction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nine of ten say "patio", one says "gym": as many become gyms as gyms become patios."""
    monkeypatch.setattr(injection, "_MATCHED_TRIES", 1)
    texts = [
        tokenized(f"walk along the way and then stop in the {'patio' if k % 10 else 'gym'}")
        for k in range(400)
    ]
    common_sense = CommonSense(rooms={"patio": ("gym",), "gym": ("patio",)}, objects={})
    injector = Injector(common_sense=common_sense, wording=learn_wording(texts))
    some = [replace(instruction, key=str(k), tokens=tokens) for k, tokens in enumerate(texts)]
    wrong = [one for one in error_episodes(some, "room", injector, 1) if one.wrong]
    assert sum(one.wrong[0].wrong == "gym" for one in wrong) / len(wrong) == pytest.approx(0.5, abs=0.12)


@pytest.mark.parametrize("protocol", ["uniform", "matched"])
def test_words_put_in_are_read_as_such(instruction: Instruction, protocol: str) -> None:
    """A lounge before an area rug would be a lounge area and a rug."""
    tokens = tokenized("walk along the hallway area rug to the bed in the lounge and stop .")
    likely = CommonSense(
        rooms={"hallway": ("lounge", "kitchen"), "lounge": ("hallway",), "kitchen": ("hallway",)},
        objects={"rug": ("bathtub",), "bathtub": ("rug", "bed"), "bed": ("bathtub",)},
    )
    wording = learn_wording([]) if protocol == "matched" else None
    injector = Injector(common_sense=likely, wording=wording)
    some = [replace(instruction, key=str(k), tokens=tokens) for k in range(200)]
    found = [one for one in error_episodes(some, "room_object", injector, 1) if one.wrong]
    assert found
    for one in found:
        mentions = {(m.start, m.length, m.kind, m.concept) for m in find_mentions(one.tokens)}
        assert {(span.start, span.length, span.kind, span.wrong) for span in one.wrong} <= mentions


def test_a_given_wording_decides_in_all_homes(instruction: Instruction) -> None:
    some = [replace(instruction, key=str(k), group=f"home {k}") for k in range(40)]
    rooms = CommonSense(rooms={"kitchen": ("patio",), "patio": ("kitchen",)}, objects={})
    usual, never = (
        learn_wording([tokenized(f"walk out of the bedroom and stop in the {room}")] * 50)
        for room in ("patio", "kitchen")
    )
    found = [
        len(episodes_put_in(some, rooms, "matched", 1, wording=wording)["room"]) for wording in (usual, never)
    ]
    assert found[0] == 2 * len(some)
    assert found[1] < found[0] / 2


def test_a_plural_stays_one() -> None:
    injector = Injector(common_sense=CommonSense(rooms={}, objects={"chair": ("window",)}))
    found = injector.perturbed(tokenized("pass the chairs"), "object", np.random.default_rng(1))
    assert found is not None
    assert found[0] == ("pass", "the", "windows")


@pytest.mark.parametrize("text", ["", "🙂", "left " * 300, "налево " * 12])
def test_any_text_can_be_given(instruction: Instruction, text: str) -> None:
    odd = replace(instruction, tokens=tokenized(text))
    for error_type in ERROR_TYPES:
        for injector in (
            Injector(common_sense=anything_goes()),
            Injector(common_sense=anything_goes(), wording=learn_wording([])),
        ):
            for episode in error_episodes([odd], error_type, injector, 1):
                assert len(episode.tokens) == len(odd.tokens)


def test_common_sense_from_data(instruction: Instruction) -> None:
    derived = derive_common_sense([instruction] * 10)
    assert set(derived.rooms) == set(ROOMS)
    assert set(derived.objects) == set(OBJECTS)
    assert "kitchen" in derived.rooms["bedroom"]
    assert "refrigerator" in derived.objects["picture"]


def test_statistics(instruction: Instruction) -> None:
    rows = list(error_episodes([instruction] * 3, "all", Injector(common_sense=anything_goes()), 1))
    counted = error_statistics("all", rows)
    assert (counted.episodes, counted.errors_per_episode) == (6, 3.0)
    assert error_statistics("all", []).episodes == 0

"""The transformer over mentions: what one tells of the others, and what its file may hold."""

import numpy as np
import pytest
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.mention_data import LearnedRows
from robustnav_nodes.instruction.mention_network import (
    CATEGORIES,
    MentionNetwork,
    NetworkSettings,
    network_from_arrays,
)
from robustnav_nodes.instruction.metrics import auc

pytest.importorskip("torch")

NAMES = (*CATEGORIES, "own", "sometimes")


def instructions(seed: int, count: int = 400) -> LearnedRows:
    """Of up to six mentions, the one whose number has another sign than most is wrong."""
    rng = np.random.default_rng(seed)
    lengths = rng.integers(1, 7, count)
    values, wrong = [], []
    for length in lengths:
        sign = rng.choice([-1.0, 1.0])
        odd = (np.arange(length) == rng.integers(length)) & (length > 2) & (rng.uniform() < 0.5)
        own = sign * np.where(odd, -1.0, 1.0) * rng.uniform(0.5, 1.5, length)
        sometimes = np.where(rng.uniform(size=length) < 0.5, np.nan, rng.normal(size=length))
        categories = rng.integers(-1, 5, (length, len(CATEGORIES)))
        values.append(np.column_stack([categories, own, sometimes]))
        wrong.append(odd)
    return LearnedRows(
        values=np.concatenate(values).astype(np.float32),
        episode=np.repeat(np.arange(count), lengths),
        kind=np.zeros(lengths.sum(), dtype=np.int64),
        wrong=np.concatenate(wrong).astype(np.int64),
        label=np.array([int(odd.any()) for odd in wrong]),
        names=NAMES,
        blind=len(CATEGORIES),
    )


@pytest.fixture(scope="module")
def learned() -> MentionNetwork:
    from robustnav_nodes.instruction.mention_network_training import learn_network

    settings = NetworkSettings(width=32, epochs=30, batch=32, dropout=0.0)
    return learn_network(instructions(0), settings, blind=False, seed=1)


def odds_of(network: MentionNetwork, rows: LearnedRows) -> NDArray[np.float64]:
    ends = np.flatnonzero(np.diff(rows.episode)) + 1
    return np.concatenate([network.log_odds(values) for values in np.split(rows.values, ends)])


def test_a_mention_is_judged_by_the_others(learned: MentionNetwork) -> None:
    """The number of the wrong one is as often above 0 as below: its own row tells nothing."""
    rows = instructions(1)
    found = auc(odds_of(learned, rows), rows.wrong.astype(float))
    assert found is not None
    assert found > 0.95


def test_a_saved_network_judges_the_same(learned: MentionNetwork) -> None:
    read = network_from_arrays(learned.arrays("some/network"), "some/network", len(NAMES))
    rows = instructions(2, count=20)
    assert odds_of(read, rows) == pytest.approx(odds_of(learned, rows), abs=0.05)


def test_categories_that_were_never_seen_are_taken(learned: MentionNetwork) -> None:
    rows = np.full((3, len(NAMES)), 70.0, dtype=np.float32)
    rows[:, CATEGORIES.index("concept")] = -1.0
    assert np.isfinite(learned.log_odds(rows)).all()


@pytest.mark.parametrize("part", ["low", "categories", "out.weight", "tables.3.weight"])
def test_a_file_without_a_part_is_refused(learned: MentionNetwork, part: str) -> None:
    arrays = learned.arrays("a")
    del arrays[f"a/{part}"]
    with pytest.raises(BadFileError, match=f"does not hold together .*{part}.*: train it anew"):
        network_from_arrays(arrays, "a", len(NAMES))


def test_weights_of_another_shape_are_refused(learned: MentionNetwork) -> None:
    arrays = learned.arrays("a")
    arrays["a/inner.weight"] = arrays["a/inner.weight"][:, :-1]
    with pytest.raises(BadFileError, match="does not hold together"):
        network_from_arrays(arrays, "a", len(NAMES))


def test_columns_that_are_not_there_are_refused(learned: MentionNetwork) -> None:
    with pytest.raises(BadFileError, match="does not hold together"):
        network_from_arrays(learned.arrays("a"), "a", len(NAMES) - 1)


def test_weights_that_are_no_numbers_are_refused(learned: MentionNetwork) -> None:
    arrays = learned.arrays("a")
    arrays["a/out.bias"][:] = np.nan
    with pytest.raises(BadFileError, match="holds no numbers"):
        network_from_arrays(arrays, "a", len(NAMES))

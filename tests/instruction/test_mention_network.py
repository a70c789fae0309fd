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
        error_type=np.zeros(count, dtype=np.int64),
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
    assert odds_of(read, rows) == pytest.approx(odds_of(learned, rows), rel=0.01, abs=0.02)


def test_categories_that_were_never_seen_are_taken(learned: MentionNetwork) -> None:
    rows = np.full((3, len(NAMES)), 70.0, dtype=np.float32)
    rows[:, CATEGORIES.index("concept")] = -1.0
    assert np.isfinite(learned.log_odds(rows)).all()


def test_the_network_of_numpy_is_that_of_torch() -> None:
    """Also of instructions that are padded to the longest."""
    import torch

    from robustnav_nodes.instruction.mention_network import row_scale
    from robustnav_nodes.instruction.mention_network_training import Network, padded

    rows = instructions(3, count=40)
    scale = row_scale(rows.values, NAMES)
    torch.manual_seed(0)
    network = Network(
        len(scale.numbers) + len(scale.missing), [8] * len(CATEGORIES), NetworkSettings(width=16)
    )
    weights = {name: value.numpy() for name, value in network.state_dict().items()}
    at, absent = padded(rows.starts, np.arange(40))
    numbers, categories = scale.inputs(rows.values[at])
    network.eval()
    with torch.inference_mode():
        odds = network(
            torch.from_numpy(numbers), torch.from_numpy(categories), torch.from_numpy(absent)
        ).numpy()
    assert absent.any()
    own = odds_of(MentionNetwork(scale=scale, weights=weights), rows)
    np.testing.assert_allclose(own, odds[~absent], atol=1e-5)


BROKEN = {
    "no scale": ("low", None),
    "no columns": ("categories", None),
    "no weights": ("out.weight", None),
    "no table": ("tables.3.weight", None),
    "an empty table": ("tables.3.weight", np.zeros((0, 32))),
    "another shape": ("inner.weight", np.zeros((32, 31))),
    "a bias for all": ("layers.layers.0.linear1.bias", np.zeros(1)),
    "no number": ("out.bias", np.array([np.nan])),
    "columns that are not there": ("numbers", np.array([7, 9])),
    "columns from the end": ("numbers", np.array([7, -1])),
    "another layer": ("layers.layers.2.linear1.bias", np.zeros(64)),
    "text": ("mean", np.array(["a", "b"])),
}


@pytest.mark.parametrize(("part", "array"), BROKEN.values(), ids=BROKEN.keys())
def test_a_file_that_does_not_hold_together_is_refused(
    learned: MentionNetwork, part: str, array: NDArray[np.float64] | None
) -> None:
    arrays = learned.arrays("a")
    if array is None:
        del arrays[f"a/{part}"]
    else:
        arrays[f"a/{part}"] = array
    with pytest.raises(BadFileError, match="'a' of the model does not hold together .*: train it anew"):
        network_from_arrays(arrays, "a", len(NAMES))


def test_every_instruction_is_learned_from_once_in_an_epoch_and_like_ones_together() -> None:
    import torch

    from robustnav_nodes.instruction.small_network import batches

    lengths = np.random.default_rng(0).integers(1, 30, 1000)
    found = batches(1000, 32, lengths, torch.Generator().manual_seed(1))
    assert sorted(torch.cat(found).tolist()) == list(range(1000))
    assert len(found) == 32
    assert np.mean([np.ptp(lengths[some.numpy()]) for some in found]) < 5

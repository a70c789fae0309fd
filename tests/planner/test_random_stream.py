import numba
import numpy as np
import pytest

from robustnav_nodes.planner.random_stream import below, bits, stream_from, uniform


@numba.njit
def drawn(stream, count, below_what):
    found = np.zeros(count, dtype=np.int64)
    for index in range(count):
        found[index] = below(stream, below_what)
    return found


def test_it_is_splitmix64():
    """The first numbers of seed 1234567, from the reference implementation (Vigna, splitmix64.c)."""
    stream = np.array([1234567], dtype=np.uint64)
    known = [6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431]
    assert [int(bits(stream)) for _ in known] == known


@pytest.mark.parametrize("count", [1, 2, 3, 12, 1000])
def test_below_is_uniform(count):
    """A chi-squared far from its mean (5 standard deviations) would be a fault."""
    found = np.bincount(drawn(np.array([1], dtype=np.uint64), 100_000, count), minlength=count)
    assert len(found) == count
    expected = 100_000 / count
    chi_squared = float(((found - expected) ** 2 / expected).sum())
    assert abs(chi_squared - (count - 1)) <= 5.0 * np.sqrt(2.0 * count)


def test_uniform_lies_in_the_unit_interval():
    stream = stream_from(np.random.default_rng(0))
    found = np.array([uniform(stream) for _ in range(10_000)])
    assert found.min() >= 0.0
    assert found.max() < 1.0
    assert found.mean() == pytest.approx(0.5, abs=0.01)


def test_a_generator_decides_the_stream():
    one, other = (stream_from(np.random.default_rng(5)) for _ in range(2))
    assert bits(one) == bits(other)
    rng = np.random.default_rng(5)
    assert stream_from(rng)[0] != stream_from(rng)[0]

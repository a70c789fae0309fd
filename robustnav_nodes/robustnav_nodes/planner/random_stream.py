"""Chance in compiled loops: splitmix64 (Steele et al. 2014), a few operations a number.

A stream is one 64-bit counter in an array, so that compiled functions can move it on. Only integers decide,
so a seed gives the same numbers on every machine.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.search_space.compiled import compiled_into_callers

Stream = NDArray[np.uint64]  # [1]

# numba turns a sum of signed and unsigned integers into a float, so every constant is unsigned.
_GAMMA = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_11, _27, _30, _31, _32 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31), np.uint64(32)
_TO_UNIT = 2.0**-53


def stream_from(rng: np.random.Generator) -> Stream:
    """A stream that begins where `rng` says; moves `rng` on by one number."""
    return rng.integers(0, 2**64, size=1, dtype=np.uint64)


@compiled_into_callers
def bits(stream: Stream) -> Any:
    """The next 64 random bits, uint64."""
    stream[0] += _GAMMA
    mixed = stream[0]
    mixed = (mixed ^ (mixed >> _30)) * _MIX_1
    mixed = (mixed ^ (mixed >> _27)) * _MIX_2
    return mixed ^ (mixed >> _31)


@compiled_into_callers
def uniform(stream: Stream) -> float:
    """Uniform in [0, 1), a multiple of 2^-53."""
    return float(bits(stream) >> _11) * _TO_UNIT


@compiled_into_callers
def below(stream: Stream, count: int) -> int:
    """Uniform in 0 .. count - 1, to one part in 2^32 / count; for 1 <= count < 2^31."""
    return int(((bits(stream) >> _32) * np.uint64(count)) >> _32)

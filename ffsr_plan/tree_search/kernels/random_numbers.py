"""Random numbers in kernels, from a state of their own: xorshift64* (Vigna 2016)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.kernels.compilation import kernel

RandomState = NDArray[np.uint64]
_RIGHT, _LEFT, _BACK, _KEPT = np.uint64(12), np.uint64(25), np.uint64(27), np.uint64(11)
_FACTOR = np.uint64(2_685_821_657_736_338_717)
_UNIT = 2.0**-53


def random_state(rng: np.random.Generator) -> RandomState:
    """(1,) a state that is not zero.

    Args:
        rng: source of randomness.
    """
    return rng.integers(1, 2**64 - 1, 1, dtype=np.uint64)


@kernel
def uniform(state: Any) -> float:  # noqa: ANN401 - (1,) of uint64
    """A number in [0, 1); the state (1,) moves on."""
    x = state[0]
    x ^= x >> _RIGHT
    x ^= x << _LEFT
    x ^= x >> _BACK
    state[0] = x
    return float((x * _FACTOR) >> _KEPT) * _UNIT


@kernel
def below(state: Any, count: int) -> int:  # noqa: ANN401 - (1,) of uint64
    """A whole number from 0 to `count` - 1; the state (1,) moves on."""
    return min(int(uniform(state) * count), count - 1)


@kernel
def normal(state: Any) -> float:  # noqa: ANN401 - (1,) of uint64
    """A number of the standard normal distribution (Box and Muller 1958); the state moves on."""
    size = math.sqrt(-2.0 * math.log(1.0 - uniform(state)))
    return size * math.cos(2.0 * math.pi * uniform(state))

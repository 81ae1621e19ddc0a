"""Normalisation: what has been normalised once stays as it is, bit for bit."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.checks import normalised, unit_quaternion


@pytest.mark.parametrize("size", [2, 4])
def test_a_normalised_vector_stays_bit_for_bit(size):
    vectors = np.random.default_rng(size).normal(size=(20_000, size))
    for vector in vectors:
        once = normalised(vector)
        assert abs(np.linalg.norm(once) - 1.0) < 1e-15
        assert np.array_equal(normalised(once), once)


def test_a_quaternion_printed_with_eight_digits_becomes_a_unit():
    quat = unit_quaternion("attitude", [0.70710678, 0.0, 0.70710678, 0.0])
    assert np.linalg.norm(quat) == pytest.approx(1.0, abs=1e-15)
    assert np.linalg.norm(np.round(quat, 8)) != pytest.approx(1.0, abs=1e-10)


def test_another_norm_is_refused():
    with pytest.raises(fp.InvalidInput, match=r"unit quaternion.*norm is 1\.1"):
        unit_quaternion("attitude", [1.1, 0.0, 0.0, 0.0])

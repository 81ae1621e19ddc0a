"""Random numbers of kernels have a state of their own."""

import numpy as np

from ffsr_plan.tree_search.kernels.random_numbers import below, normal, random_state, uniform


def drawn(function, seed, count, *more):
    state = random_state(np.random.default_rng(seed))
    return np.array([function(state, *more) for _ in range(count)])


def test_numbers_fill_the_unit_interval_evenly():
    values = drawn(uniform, 1, 20_000)
    assert values.min() >= 0.0
    assert values.max() < 1.0
    counts = np.histogram(values, 20, (0.0, 1.0))[0]
    assert np.all(np.abs(counts - 1000) < 5.0 * np.sqrt(1000))
    assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 0.03


def test_normal_numbers_have_mean_zero_and_variance_one():
    values = drawn(normal, 2, 20_000)
    assert abs(values.mean()) < 0.03
    assert abs(values.var() - 1.0) < 0.05
    assert abs(np.mean(values**3)) < 0.1


def test_whole_numbers_are_below_their_count():
    values = drawn(below, 3, 5000, 7)
    assert set(values.tolist()) == set(range(7))


def test_the_same_seed_gives_the_same_numbers():
    assert np.array_equal(drawn(uniform, 5, 50), drawn(uniform, 5, 50))
    assert not np.array_equal(drawn(uniform, 5, 50), drawn(uniform, 6, 50))

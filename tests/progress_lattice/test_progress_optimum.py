"""The optimum of lattices with progress, against all paths."""

import pytest

from benchmarks.studies.moving.all_paths import agree, small_problem


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("seed", range(5))
def test_the_optimum_with_progress_is_the_best_of_all_paths(seed, mode):
    equal, _ = agree(small_problem(seed, mode, waits=True))
    assert equal


@pytest.mark.parametrize("seed", [0, 2])
def test_the_optimum_with_progress_past_debris_is_the_best_of_all_paths(seed):
    equal, found = agree(small_problem(seed, waits=True, debris=True))
    assert equal
    assert found

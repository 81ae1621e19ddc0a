"""The optimum of lattices with progress, against all paths."""

from dataclasses import replace

import pytest

import ffsr_plan as fp
from benchmarks.studies.moving.all_paths import agree, small_problem
from tests.helpers.moving_scenes import problem_past


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


def test_bodies_and_debris_together_are_passed_as_bodies_are():
    box = fp.MovingBody([fp.Box([0.2] * 3)], fp.Drift((0.0, -0.02, 0.0)), (1.0, 2.0, 0.0))
    place, velocity = (2.0, -3.0, 0.0), (0.0, 0.06, 0.0)
    ball = fp.MovingBody([fp.Ball(0.3)], fp.Drift(velocity), place)
    cloud = fp.DebrisCloud([place], [0.3], [velocity])
    lattice = fp.Lattice(12, fp.Axis(3, 0.3), progress=fp.Progress(8, 1, 1))
    both = replace(problem_past(box, ball), lattice=lattice)
    mixed = replace(both, scene=fp.Scene(bodies=[box], debris=[cloud]))
    plans = [fp.plan(each, "lattice-optimum") for each in (both, mixed)]
    assert plans[0].objective == pytest.approx(plans[1].objective, rel=1e-12)
    assert plans[1].verify().ok

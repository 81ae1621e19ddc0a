"""Times of plans among bodies that move, and of plans that wait."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.moving.debris import COUNTS, debris, problem_in


def drifting(count):
    """Balls that drift in the paper's plane."""
    rng, bodies = np.random.default_rng(0), []
    for _ in range(count):
        motion = fp.Drift(rng.normal(size=3) * (0.05, 0.05, 0.0))
        place = rng.uniform(1.0, 9.0), rng.uniform(-4.0, 4.0), 0.0
        bodies.append(fp.MovingBody([fp.Ball(0.3)], motion, place))
    return bodies


@pytest.mark.parametrize("bodies", [0, 6])
def test_optimum_of_the_paper_with_bodies(benchmark, problem, bodies):
    scene = replace(problem.scene, bodies=drifting(bodies))
    moved = replace(problem, scene=scene, duration=200.0)
    fp.plan(moved, fp.LatticeOptimum(), refine=False)
    benchmark(lambda: fp.plan(moved, fp.LatticeOptimum(), refine=False))


@pytest.mark.parametrize("scenario", ["crossing", "door", "tumbling"])
def test_scenario_with_bodies(benchmark, scenario):
    problem = fp.load_scenario(scenario)
    fp.plan(problem)
    benchmark(lambda: fp.plan(problem))


@pytest.mark.parametrize("count", [1000, 10_000])
def test_optimum_of_the_paper_through_debris(benchmark, count):
    problem = problem_in(debris(0, count, COUNTS[count]))
    fp.plan(problem, "lattice-optimum", refine=False)
    benchmark(lambda: fp.plan(problem, "lattice-optimum", refine=False))


def test_verification_of_a_plan_through_debris(benchmark):
    plan = fp.plan(problem_in(debris(0, 10_000, COUNTS[10_000])), "lattice-optimum", refine=False)
    plan.verify()
    benchmark(plan.verify)

"""Eqs. 6 to 9 in closed form, through the very same code, on a robot that is a point."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.roadmap import Roadmap
from tests.helpers.urdf_builders import random_scene


def point_problem(point, seed, **changes):
    rng = np.random.default_rng(seed)
    scene = random_scene(rng, 5, (1, -2, -0.3), (9, 2, 0.3), (0.05, 0.2))
    start, goal = point.configuration(), point.configuration((10.0, 0.0, 0.0))
    settings = {
        "delta": float(rng.uniform(0, 6)),
        "length_unit": float(rng.uniform(0.1, 2)),
        "lattice": fp.Lattice(divisions=12, lateral=fp.Axis(5, 0.25), normal=fp.Axis(1, 0.3)),
    } | changes
    return fp.Problem(point, scene, start, goal, **settings), scene


@given(st.integers(0, 10_000))
@settings(max_examples=40)
def test_clearance_length_and_objective_have_closed_forms(seed):
    point = fp.load_robot("point")
    problem, scene = point_problem(point, seed)
    plan = fp.plan(problem, fp.AntSystem(ants=3, cycles=2), seed, refine=False)
    lateral, normal = plan.nodes.T
    length, nearness = 0.0, 0.0
    for i in range(13):
        place = (10.0 * i / 12, 0.25 * lateral[i], 0.3 * normal[i])
        d = min(math.dist(place, c) - r for c, r in zip(scene.centers, scene.radii, strict=True))
        assert abs(plan.clearances[i] - d) < 1e-12
        if 0 < i < 12:
            nearness += problem.length_unit / d
        if i:
            step = (0.25 * (lateral[i] - lateral[i - 1]), 0.3 * (normal[i] - normal[i - 1]))
            length += math.sqrt((10.0 / 12) ** 2 + step[0] ** 2 + step[1] ** 2)
    assert plan.length == pytest.approx(length, abs=1e-12)
    expected = length / problem.length_unit + problem.delta * nearness
    assert plan.objective == pytest.approx(expected, rel=1e-12)


def test_the_cap_bounds_the_clearance_term(point):
    far = fp.Scene([[5, 100, 0]], [1])
    start, goal = point.configuration(), point.configuration((10, 0, 0))
    lattice = fp.Lattice(divisions=4, lateral=fp.Axis(1, 1.0))
    capped = fp.Problem(point, far, start, goal, lattice=lattice, delta=2.0, clearance_cap=0.5)
    straight = Roadmap(capped).objective(np.ones(5, dtype=int))
    assert straight == pytest.approx(10.0 + 2.0 * 3 / 0.5)


def test_without_obstacles_the_objective_is_the_length(point):
    start, goal = point.configuration(), point.configuration((10, 0, 0))
    problem = fp.Problem(point, fp.Scene(), start, goal, delta=6.0, length_unit=0.1,
                         lattice=fp.Lattice(4, fp.Axis(2, 0.5)))  # fmt: skip
    plan = fp.plan(problem)
    assert plan.objective == pytest.approx(plan.length / 0.1)
    assert np.all(np.isinf(plan.clearances))


def test_a_weighed_metre_counts_the_same_along_and_across(point):
    start, goal = point.configuration(), point.configuration((4, 0, 0))
    problem = fp.Problem(point, fp.Scene(), start, goal, position_weight=3.0,
                         lattice=fp.Lattice(2, fp.Axis(1, 1.5)))  # fmt: skip
    roadmap = Roadmap(problem)
    assert roadmap.path_length(np.array([1, 2, 1])) == pytest.approx(2 * 3 * 2.5)

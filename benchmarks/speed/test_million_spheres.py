"""A million spheres: tree, table, plan and verification, as ratios to the same reference."""

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.speed.reference import Reference, record
from ffsr_plan.scene.shapes.sphere_tree import sphere_tree

COUNT = 1_000_000


@pytest.fixture(scope="module")
def reference(problem):
    return Reference(problem)


@pytest.fixture(scope="module")
def spheres():
    """Debris in a cube of 80 m around a free corridor along x: centres and radii."""
    rng = np.random.default_rng(1)
    centers = rng.uniform(-40.0, 40.0, (2 * COUNT, 3))
    beside = np.maximum(np.abs(centers[:, 0]) - 2.5, 0.0)
    apart = np.hypot(np.hypot(centers[:, 1], centers[:, 2]), beside)
    radii = np.exp(rng.uniform(np.log(0.01), np.log(0.1), COUNT))
    return centers[apart > 3.2][:COUNT], radii


@pytest.fixture(scope="module")
def among_them(spheres):
    """A flight through the corridor; the tree is not built yet."""
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration((-2.5, 0.0, 0.0), joints={"left_1": -0.6, "right_1": 0.2})
    goal = robot.configuration((2.5, 0.0, 0.0), joints={"left_1": 0.7})
    lattice = fp.Lattice(40, fp.Axis(20, 0.1))

    def problem():
        return fp.Problem(robot, fp.Scene(*spheres), start, goal, lattice=lattice, delta=0.02)

    return problem


def test_tree_over_a_million_spheres(benchmark, spheres, reference):
    sphere_tree(*spheres)  # compiles
    benchmark.pedantic(lambda: sphere_tree(*spheres), rounds=3)
    record(benchmark, reference)


def test_table_of_a_million_spheres(benchmark, spheres, reference, tmp_path):
    fp.Scene(*spheres).to_csv(tmp_path / "debris.csv")
    scene = benchmark.pedantic(lambda: fp.Scene.from_csv(tmp_path / "debris.csv"), rounds=2)
    assert np.array_equal(scene.centers, spheres[0])
    record(benchmark, reference)


def test_plan_past_a_million_spheres(benchmark, among_them, reference):
    """Scene and tree included."""
    fp.plan(among_them())  # compiles
    plan = benchmark.pedantic(lambda: fp.plan(among_them(), seed=0), rounds=3)
    benchmark.extra_info["objective"] = plan.objective
    record(benchmark, reference)


def test_verification_among_a_million_spheres(benchmark, among_them, reference):
    plan = fp.plan(among_them(), seed=0)
    assert plan.verify().ok  # compiles
    benchmark.pedantic(plan.verify, rounds=3)
    record(benchmark, reference)

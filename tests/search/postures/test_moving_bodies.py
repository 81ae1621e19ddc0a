"""Lattices with posture axes among bodies that move."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.debris.distances_in_time import distances_in_time
from ffsr_plan.search.postures.cost_kernels import CostedPath, path_cost
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.path_proof import corners, prove_path
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid
from ffsr_plan.time_limit.deadline import Deadline

QUICK = fp.PostureAnnealing(annealing_shifts=5_000, cycles=20)


def gate(motion, duration=100.0):
    """A way through a gate whose posts move towards the arms when the robot is there."""
    robot = fp.load_robot("planar_dual_arm")
    post = [fp.Box((0.3, 0.6, 1.0))]
    bodies = [
        fp.MovingBody(post, motion, (2.0, side * 1.55, 0.0), name=f"post {side}")
        for side in (-1, 1)
    ]
    still = [fp.Box((0.3, 0.6, 1.0), (3.4, 1.5, 0.0))]
    axis = fp.PostureAxis({"left_1": -1.0, "right_1": 1.0}, 4, 0.25)
    return fp.Problem(
        robot, fp.Scene(shapes=still, bodies=bodies), robot.neutral(),
        robot.configuration((5.0, 0.0, 0.0)),
        lattice=fp.Lattice(20, fp.Axis(2, 0.2), postures=[axis]),
        delta=0.1, clearance_cap=1.0, duration=duration, ramp=0.2,
    )  # fmt: skip


def costed(lattice, rng):
    """A random path of the lattice with its costs."""
    grid, m = posture_grid(lattice), lattice.problem.lattice.divisions
    nodes = np.tile(grid.origin, (m + 1, 1))
    for i in range(1, m):
        steps = [s for s in lattice.successors[nodes[i - 1, 1]] if s >= 0 and lattice.allowed[0, s]]
        nodes[i] = rng.integers(len(lattice.base.offsets)), rng.choice(steps)
    nodes[m // 2 :, 1] = nodes[m // 2, 1]
    path = CostedPath(
        nodes, np.zeros(m), np.zeros((m + 1, 4)), np.full(m + 1, np.inf), np.zeros(m + 1),
        np.zeros(m + 1),
    )  # fmt: skip
    assert np.isfinite(path_cost(grid, path, 1.0))
    return path


def test_nodes_have_their_clearance_at_the_time_of_their_layer():
    problem = gate(fp.Spin((0.0, 0.0, 0.05), (0.004, 0.0, 0.0)))
    lattice, rng = PostureLattice(problem, Deadline()), np.random.default_rng(0)
    times = problem.pace(20).instants(np.arange(21.0))
    for _ in range(5):
        path = costed(lattice, rng)
        motion = prove_path(lattice, *corners(lattice, path.nodes)).motion
        q = motion.configurations()
        found = distances_in_time(problem.robot, problem.obstacles, q, times)
        assert path.clearances[1:] == pytest.approx(found[1:], abs=1e-8)
        assert np.ptp(found) > 0.5


def test_bodies_at_rest_are_obstacles_at_rest():
    moving = gate(fp.Drift((0.0, 0.0, 0.0)))
    still = replace(moving, scene=moving.scene.at(0.0), duration=None, ramp=0.0)
    one, other = (fp.plan(each, QUICK, seed=3) for each in (moving, still))
    assert np.array_equal(one.nodes, other.nodes)
    assert one.objective == pytest.approx(other.objective, rel=1e-12)


def test_arms_give_way_to_bodies_that_close_in():
    problem = gate(fp.Spin((0.0, 0.0, 0.03)))
    plan = fp.plan(problem, QUICK, seed=0)
    report = plan.verify()
    assert report.ok
    assert plan.optimum <= plan.objective
    bare = replace(problem, scene=problem.scene.at_rest, duration=None, ramp=0.0)
    assert lower_bound(PostureLattice(bare, Deadline())) <= plan.optimum


def test_the_lower_bound_counts_bodies_where_they_are():
    problem = gate(fp.Drift((0.0, 0.0, 0.0)))
    late = [fp.MovingBody([fp.Ball(0.3)], fp.Drift((0.0, 0.05, 0.0)), (2.5, -2.5, 0.0))]
    problem = replace(problem, scene=fp.Scene(bodies=late), ramp=0.0)
    lattice = PostureLattice(problem, Deadline())
    middle = problem.start[:3] + 0.5 * problem.base_displacement
    assert np.linalg.norm(problem.scene.at(50.0).shapes[0].position - middle) < 1e-9
    passed = replace(problem, scene=problem.scene.at(0.0), duration=None)
    assert lower_bound(lattice) > lower_bound(PostureLattice(passed, Deadline()))

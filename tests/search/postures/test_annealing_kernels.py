"""Shifts of path segments: what they cost is worked out from what changes, and bounded first."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.search.postures.annealing_kernels import anneal, shift, trial_cost, uncosted_path
from ffsr_plan.search.postures.cost_kernels import (
    COLLISION_COST,
    DEPTH_COST,
    new_workspace,
    node_cost,
    path_cost,
)
from ffsr_plan.search.postures.path_proof import corners, prove_path
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid, without_edge
from tests.helpers.spatial_robot import spatial_problem

WEIGHT = 100.0


def spatial_among_obstacles():
    problem = spatial_problem(20, (1, 1, 0), divisions=20, levels=2)
    scene = fp.Scene([[1.4, 1.0, 0.3], [-1.1, 0.4, 1.2], [0.2, -1.9, -0.4]], [0.2, 0.3, 0.25])
    return replace(problem, scene=scene, delta=0.02)


def floating_among_obstacles():
    problem = spatial_among_obstacles()
    return replace(problem, mode="free-floating")


PROBLEMS = {
    "gate": lambda: fp.load_scenario("gate"),
    "spatial": spatial_among_obstacles,
    "floating": floating_among_obstacles,
    "no obstacles": lambda: spatial_problem(20, (0, 0, 1), divisions=20, levels=2),
}


@cache
def ground_and_path(name):
    """A lattice and a path on it that wanders."""
    lattice = PostureLattice(PROBLEMS[name]())
    grid = posture_grid(lattice)
    start = np.tile(grid.origin, (len(grid.rows), 1))
    path = np.empty_like(start)
    rng, weights = np.random.default_rng(1), np.array([5.0, WEIGHT])
    anneal(grid, rng, start, 500, 5.0, 2.0, weights, path)
    return grid, path


def shifts(grid, path, rng, count):
    """(first, last, the nodes shifted) of random possible shifts."""
    m, axes, trial = len(path) - 1, grid.indices.shape[1], path.copy()
    kinds = 2 * axes + grid.neighbours.shape[1] + 2
    while count:
        first, kind = int(rng.integers(1, m)), int(rng.integers(kinds))
        last = min(first + int(rng.integers(1, m)), m)
        trial[:] = path
        if shift(grid.successors, grid.neighbours, axes, path, trial, first, last, kind):
            count -= 1
            yield first, last, trial.copy()


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_cost_of_a_shift_is_that_of_its_whole_path(name):
    grid, path = ground_and_path(name)
    current, workspace, told = uncosted_path(path), new_workspace(), 0
    path_cost(grid, current, WEIGHT)
    for first, last, nodes in shifts(grid, path, np.random.default_rng(2), 400):
        whole = uncosted_path(nodes)
        cost = path_cost(grid, whole, WEIGHT)

        def tried(limit, nodes=nodes, first=first, last=last):
            trial = uncosted_path(nodes)
            found = trial_cost(grid, current, trial, first, last, WEIGHT, limit, workspace)
            return found, trial

        if not np.isfinite(cost):
            assert tried(np.inf)[0] == np.inf
            continue
        margin, told = 1e-9 * cost, told + 1
        found, trial = tried(cost + margin)
        assert found == pytest.approx(cost, rel=1e-12)
        np.testing.assert_allclose(trial.quats[first:], whole.quats[first:], atol=1e-12)
        np.testing.assert_allclose(trial.clearances[first:], whole.clearances[first:], atol=1e-9)
        assert tried(cost - margin)[0] == np.inf
    assert told > 50


@pytest.mark.parametrize("name", PROBLEMS)
def test_annealing_returns_the_cost_of_the_path_it_returns(name):
    grid, path = ground_and_path(name)
    weights, before = np.array([WEIGHT, WEIGHT]), path_cost(grid, uncosted_path(path), WEIGHT)
    for seed in range(8):
        rng, found = np.random.default_rng(seed), np.empty_like(path)
        cost = anneal(grid, rng, path.copy(), 3000, 0.5, 1e-3, weights, found)
        assert cost == pytest.approx(path_cost(grid, uncosted_path(found), WEIGHT), rel=1e-9)
        assert cost <= before * (1.0 + 1e-9)


def test_a_refused_edge_is_not_taken_again():
    grid, path = ground_and_path("no obstacles")
    layer = 10
    refused = without_edge(grid, layer, path)
    assert path_cost(grid, uncosted_path(path), WEIGHT) < np.inf
    assert path_cost(refused, uncosted_path(path), WEIGHT) == np.inf
    aside = path.copy()
    found, rng = np.empty_like(path), np.random.default_rng(4)
    weights = np.array([5.0, WEIGHT])
    cost = anneal(refused, rng, aside, 3000, 0.5, 1e-3, weights, found)
    assert cost < np.inf
    assert not np.array_equal(found[layer : layer + 2], path[layer : layer + 2])


def test_node_costs_follow_from_coals_clearances():
    grid, path = ground_and_path("gate")
    current = uncosted_path(path)
    path_cost(grid, current, WEIGHT)
    lattice = PostureLattice(PROBLEMS["gate"]())
    exact = prove_path(lattice, *corners(lattice, path)).clearances
    assert current.clearances[1:] == pytest.approx(exact[1:], abs=1e-9)
    for clearance, cost in zip(exact[1:-1], current.costs[1:-1], strict=True):
        assert cost == pytest.approx(node_cost(grid.clearance_cost, clearance, True))
    assert node_cost(grid.clearance_cost, -0.1, False) == COLLISION_COST + 0.1 * DEPTH_COST
    assert node_cost(grid.clearance_cost, 0.1, True) == pytest.approx(
        grid.clearance_cost.weight / 0.1
    )


def test_the_searchs_cost_is_the_objective_of_its_plan():
    plan = fp.plan(fp.load_scenario("gate"), fp.PostureAnnealing(ants=5, cycles=5), seed=0)
    assert plan.certificate.edges_refused == 0  # else the last search is not in the history
    assert plan.history.best[-1] == pytest.approx(plan.lattice_objective, rel=1e-9)

"""The dynamic programme that the colony is held to among obstacles in the plane."""

import math
from functools import cache

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.attitude.yaw_dynamic_programme import (
    cheapest_way,
    coarse_to_fine,
    least_to_go,
)
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.problem.objective import nearness
from ffsr_plan.search.postures.annealing_kernels import uncosted_path
from ffsr_plan.search.postures.colony import PostureColony
from ffsr_plan.search.postures.cost_kernels import path_cost
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid, without_edge
from ffsr_plan.search.records import SearchMonitor
from tests.helpers.closed_forms import clearances

REST = {"left_2": 0.8, "right_2": -0.8}
AXES = ({"left_1": 1, "right_1": -1}, {"left_2": 1, "right_2": 1})
SCENE = fp.Scene([[1.1, 1.3, 0.0], [0.6, -1.4, 0.0]], [0.3, 0.4])
BEFORE = 0.4  # yaw of the start [rad]
WIDE = math.radians(60)
FINE, GRADE = 4801, math.radians(120) / 4801


def lattice_towards(degrees, divisions, levels, spacing, scene=SCENE):
    """Two metres past obstacles, turned by so much on the way."""
    robot = fp.load_robot("planar_dual_arm")
    problem = fp.Problem(
        robot, scene,
        robot.configuration((0, 0, 0), (BEFORE, 0, 0), REST),
        robot.configuration((2, 0, 0), (BEFORE + math.radians(degrees), 0, 0), REST),
        lattice=fp.Lattice(
            divisions, fp.Axis(levels, 0.2),
            postures=[fp.PostureAxis(along, levels, spacing) for along in AXES],
        ),
        delta=0.05, reach_attitude=True,
    )  # fmt: skip
    return PostureLattice(problem)


@cache
def tiny(degrees, scene=SCENE):
    return lattice_towards(degrees, 4, 1, 0.9, scene)


@cache
def small(degrees):
    return lattice_towards(degrees, 12, 2, 0.4)


def every_path(lattice):
    """Least cost of all paths, tried one by one with closed forms; the states that they pass."""
    problem, base = lattice.problem, lattice.base
    m, count = problem.lattice.divisions, len(base.offsets)
    b, p = np.array([base.origin]), np.array([lattice.origin])
    yaw, cost = np.zeros(1), np.zeros(1)
    states, hit = 0, 0
    for i in range(m):
        n, step, b_on = np.meshgrid(
            np.arange(len(b)), np.arange(lattice.successors.shape[1]), np.arange(count),
            indexing="ij",
        )  # fmt: skip
        n, step, b_on = n.ravel(), step.ravel(), b_on.ravel()
        on = lattice.successors[p[n], step]
        there = (on >= 0) & lattice.allowed[lattice.rows[i + 1], on]
        if i == m - 1:
            there &= (on == lattice.origin) & (b_on == base.origin)
        n, b_on, on = n[there], b_on[there], on[there]
        tail, head = lattice.joint_values[i, p[n]], lattice.joint_values[i + 1, on]
        turned = Reaction(problem.robot, tail, head - tail).increments
        yaw = yaw[n] + 2.0 * np.arctan2(turned[:, 2], turned[:, 3])
        moved = base.offsets[b_on] - base.offsets[b[n]]
        bent = head - tail - np.diff(base.nominal.joint_values[i : i + 2], axis=0)
        cost = cost[n] + np.sqrt(
            problem.delta_d**2 + np.sum(moved**2, axis=1) + np.sum(bent**2, axis=1)
        )
        angles = np.stack([BEFORE + yaw, 0 * yaw, 0 * yaw], axis=1)
        places = base.nominal.positions[i + 1] + base.offsets[b_on]
        q = np.hstack([places, rotations.from_angles(angles), head])
        states += len(np.unique(np.stack([b_on, on, np.floor(yaw / GRADE + 0.5)]), axis=1).T)
        apart = clearances(problem.robot, problem.scene, q)
        free = apart > 0.0
        hit += int(np.sum(~free))
        b, p, yaw, cost = b_on[free], on[free], yaw[free], cost[free]
        if i < m - 1:
            cost = cost + nearness(problem, apart[free])
    wanted = rotations.to_angles(problem.goal[3:7])[0] - BEFORE
    missed = np.maximum(0.0, np.abs(yaw - wanted) - math.radians(0.5))
    return float(np.min(cost + 100.0 * missed)), states, hit


@pytest.mark.parametrize("degrees", [0, 3, -6])
def test_the_programme_agrees_with_all_paths_when_tiny(degrees):
    lattice = tiny(degrees)
    cost, states, hit = every_path(lattice)
    way = cheapest_way(lattice, FINE, WIDE)
    assert hit > 0
    assert way.cost == pytest.approx(cost, rel=1e-9)
    assert way.queries == states
    nothing_there = cheapest_way(tiny(degrees, fp.Scene()), FINE, WIDE)
    assert nothing_there.cost < way.cost - 0.05


@pytest.mark.parametrize("degrees", [0, 5, -8])
@pytest.mark.parametrize("bins", [11, 41, 401])
def test_the_programmes_value_is_the_cost_of_its_path(degrees, bins):
    lattice = small(degrees)
    way = cheapest_way(lattice, bins)
    again = path_cost(posture_grid(lattice), uncosted_path(way.path), 100.0)
    assert again == pytest.approx(way.cost, rel=1e-12)


@pytest.mark.parametrize("degrees", [5, -8])
def test_the_colony_is_below_the_programme_by_bins_at_most(degrees):
    lattice = small(degrees)
    least = cheapest_way(lattice, 1601).cost
    assert cheapest_way(lattice, 801).cost == pytest.approx(least, rel=2e-3)
    for seed in range(2):
        rng = np.random.default_rng(seed)
        settings = fp.PostureAnnealing(ants=10, cycles=20)
        colony = PostureColony(lattice, posture_grid(lattice), settings, rng)
        found = colony.search(SearchMonitor())
        assert least * (1 - 2e-3) <= found.cost <= 1.1 * least


@pytest.mark.parametrize("degrees", [0, 5, -8])
def test_a_known_cost_spares_queries_and_changes_nothing(degrees):
    lattice = small(degrees)
    plain = cheapest_way(lattice, 201)
    below = cheapest_way(lattice, 201, ceiling=plain.cost)
    assert below.cost == plain.cost
    assert np.array_equal(below.path, plain.path)
    assert below.queries < 0.9 * plain.queries
    assert cheapest_way(lattice, 201, ceiling=plain.cost - 1e-6).cost == np.inf
    ladder = coarse_to_fine(lattice, (11, 41, 201))
    assert ladder.cost <= plain.cost
    assert below.queries < ladder.queries < plain.queries


def test_the_base_origins_cost_to_go_is_a_lower_bound():
    lattice = small(5)
    grid = posture_grid(lattice)
    ahead, m = least_to_go(lattice, grid), len(grid.rows) - 1
    assert ahead[0].max() > 2.0  # the way is two metres long
    for bins in (11, 41, 401):
        way = cheapest_way(lattice, bins)
        current = uncosted_path(way.path)
        total = path_cost(grid, current, 100.0)
        costs = np.cumsum(np.append(0.0, current.lengths) + current.costs)
        to_go = ahead[np.arange(m + 1), way.path[:, 0], way.path[:, 1]]
        assert np.all(to_go <= total - costs + 1e-12)


def test_a_refused_edge_is_not_taken_again():
    lattice = small(5)
    grid = posture_grid(lattice)
    way = cheapest_way(lattice, 201, grid=grid)
    refused = without_edge(grid, 5, way.path)
    other = cheapest_way(lattice, 201, grid=refused)
    assert way.cost < other.cost < np.inf
    assert not np.array_equal(way.path[5:7], other.path[5:7])

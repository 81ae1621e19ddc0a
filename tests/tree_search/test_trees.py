"""Trees whose nodes carry the attitude that the way to them brings about."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings
from tests.helpers.free_scenes import beside_a_box, gap, scattered


def searched(problem, reaches=(1.6,), checks=60_000, seed=0):
    space = SearchSpace(problem, 1e-3)
    restarts = Restarts(
        space, np.random.default_rng(seed), TreeSettings(reaches=reaches, joint_range=None)
    )
    return space, restarts, restarts.find(checks)


def check_branch(space, trees, side, node):
    """The way from the root to a node is clear and brings about its attitude."""
    parent = trees.parents[side, node]
    arrival = np.zeros(4)
    share = fly(
        space.arrays, trees.states[side, parent], trees.attitudes[side, parent].copy(),
        trees.states[side, node], arrival, True,
    )  # fmt: skip
    assert share == 1.0
    assert angle_between(arrival, trees.attitudes[side, node]) < 1e-5


@pytest.mark.parametrize("reach", [1.6, -1.6])
def test_every_edge_of_the_trees_is_clear_at_its_attitude(robot, reach):
    space, restarts, _ = searched(gap(robot, 0), (reach,), 8_000)
    trees = restarts.trees
    sides = (0, 1) if reach > 0.0 else (0,)
    for side in sides:
        count = trees.counts[side]
        assert count > 20
        for node in range(1, count, 7):
            if trees.parents[side, node] >= 0:
                check_branch(space, trees, side, node)


@pytest.mark.parametrize("reach", [2.5, 1.0, -1.6])
def test_a_path_leads_from_start_to_goal_at_true_attitudes(robot, reach):
    for seed in (0, 1, 2, 43):  # of the last, a branch is refused on its last edge
        space, _, path = searched(scattered(robot, seed), (reach,))
        states, attitudes = path
        assert np.array_equal(states[0], space.start)
        assert np.array_equal(states[-1], space.goals[0])
        for k in range(len(states) - 1):
            arrival = np.zeros(4)
            way = states[k], attitudes[k].copy(), states[k + 1], arrival
            assert fly(space.arrays, *way, True) == 1.0
            assert angle_between(arrival, attitudes[k + 1]) < 1e-5


def test_new_roots_assume_the_attitudes_of_refused_branches(robot):
    for seed in range(20):
        _, restarts, _ = searched(scattered(robot, seed), (1.0,), 30_000)
        trees = restarts.trees
        roots = trees.roots[: trees.counts[2]]
        if len(roots) > 2:
            break
    else:
        pytest.fail("no branch was refused")
    assert np.all(trees.parents[1, roots] == -1)
    apart = [
        float(angle_between(trees.attitudes[1, a], trees.attitudes[1, b]))
        for k, a in enumerate(roots)
        for b in roots[k + 1 :]
    ]
    assert min(apart) > 0.01


def test_no_more_is_checked_than_allowed(robot):
    space, _, path = searched(gap(robot, 0, width=0.3), checks=5000)
    assert path is None
    assert 5000 <= space.arrays.setup["checks"][0] < 5100


def test_tries_double_in_length_after_each_round(robot):
    space = SearchSpace(gap(robot, 0, width=0.3), 1e-3)
    settings = TreeSettings(reaches=(1.0, -1.0), first_checks=1000, roots=4)
    restarts = Restarts(space, np.random.default_rng(0), settings)
    begun = []
    for _ in range(60):
        restarts.find(250)
        begun.append(restarts.meetings.tries)
    changes = np.flatnonzero(np.diff(begun)) + 1
    assert 1.5 < np.mean(np.diff(changes)[2:4]) / np.mean(np.diff(changes)[:2]) < 2.5


def test_the_same_seed_grows_the_same_trees():
    problem = beside_a_box(fp.load_robot("satellite_ur5"), 0)
    first, second = (searched(problem, seed=4) for _ in range(2))
    assert np.array_equal(first[2].states, second[2].states)
    assert np.array_equal(first[1].trees.states, second[1].trees.states)


def test_samples_and_nodes_stay_in_the_box(robot):
    space, restarts, _ = searched(gap(robot, 2, width=0.3), checks=8000)
    low, high = space.arrays.box
    for side in (0, 1):
        states = restarts.trees.states[side, : restarts.trees.counts[side]]
        assert np.all(states >= low - 1e-12)
        assert np.all(states <= high + 1e-12)


def test_after_very_many_tries_the_trees_still_fit_into_memory(point):
    goal = point.configuration((4.0, 0.0, 0.0))
    problem = fp.Problem(point, fp.Scene([[2.0, 0.0, 0.0]], [0.5]), point.configuration(), goal)
    _, restarts, _ = searched(problem)
    restarts.meetings = restarts.meetings._replace(tries=1000)
    assert restarts.find(1000) is not None or restarts.trees.states.shape[1] <= 500_000
    assert restarts.trees.states.nbytes < 1e8

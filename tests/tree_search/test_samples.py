"""Samples of the trees: near the postures of start and goal, and where short paths can lie."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.search.records import SearchMonitor
from ffsr_plan.tree_search.kernels.flight import distance
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.kernels.samples import draw_nearer
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_rounds import SearchRounds
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings
from tests.helpers.free_scenes import gap, scattered


def beyond(restarts, space):
    """How far joints of the trees lie outside the values between start and goal [rad]."""
    ends = np.vstack([space.start, space.goals])[:, JOINTS:]
    low, high = ends.min(axis=0), ends.max(axis=0)
    states = np.vstack(
        [restarts.trees.states[k, : restarts.trees.counts[k], JOINTS:] for k in (0, 1)]
    )
    return float(np.max([low - states, states - high]))


@pytest.mark.parametrize("joint_range", [0.4, None])
def test_every_other_search_keeps_joints_near_those_of_start_and_goal(robot, joint_range):
    space = SearchSpace(gap(robot, 0, width=0.3), 1e-3)
    settings = TreeSettings(first_checks=1500, joint_range=joint_range)
    restarts, far = Restarts(space, np.random.default_rng(0), settings), {}
    while restarts.meetings.tries < 5:
        restarts.find(250)
        far[restarts.meetings.tries] = beyond(restarts, space)
    near = [far[k] <= 0.4 + 1e-12 for k in (1, 2, 3, 4)]
    assert near == ([True, False, False, True] if joint_range else [False] * 4)


def way_through(space, state):
    goal, weights = space.goals[0], space.arrays.weights
    return distance(weights, 1, space.start, state) + distance(weights, 1, state, goal)


def test_no_sample_lies_where_a_path_through_it_would_be_too_long(robot):
    space = SearchSpace(scattered(robot, 0), 1e-3)
    restarts = Restarts(space, np.random.default_rng(0), TreeSettings())
    low, high = space.arrays.box
    straight, random, moved = (
        way_through(space, space.start),
        random_state(np.random.default_rng(1)),
        0,
    )
    for sample in np.random.default_rng(2).uniform(low, high, (300, len(low))):
        most, given = 1.2 * straight, sample.copy()
        draw_nearer(space.arrays, restarts.trees, random, most, sample)
        assert way_through(space, sample) <= most + 1e-12
        assert np.all((sample >= low - 1e-12) & (sample <= high + 1e-12))
        inside = way_through(space, given) <= most
        assert np.array_equal(sample, given) == inside
        moved += not inside
    assert moved > 100


def test_all_samples_may_be_used_while_no_path_is_known(robot):
    space = SearchSpace(scattered(robot, 0), 1e-3)
    trees = Restarts(space, np.random.default_rng(0), TreeSettings()).trees
    random, sample = random_state(np.random.default_rng(1)), space.arrays.box[1].copy()
    for most in (np.inf, 0.5 * way_through(space, space.start)):
        draw_nearer(space.arrays, trees, random, most, sample)
        assert np.array_equal(sample, space.arrays.box[1])


def test_searches_look_for_paths_about_as_short_as_the_best_that_is_known(robot, monkeypatch):
    rounds = SearchRounds(
        scattered(robot, 1), TreeSettings(), np.random.default_rng(0), SearchMonitor()
    )
    asked, find = [], rounds._restarts.find

    def noting(checks, expired, known):
        asked.append((known, [path.cost for path in rounds._paths]))
        return find(checks, expired, known)

    monkeypatch.setattr(rounds._restarts, "find", noting)
    rounds.run(150_000, first=False)
    assert asked[0][0] == np.inf
    assert len({known for known, _ in asked}) > 2
    assert all(known == min(costs, default=np.inf) for known, costs in asked)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, "far"])
def test_a_joint_range_is_a_positive_number_or_none(wrong):
    with pytest.raises(fp.InvalidInput, match="joint_range"):
        fp.TreePlanner(joint_range=wrong)

"""Paths that are improved stay clear, keep their ends and never cost more."""

import itertools

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.tree_search.kernels.flight import fly_path
from ffsr_plan.tree_search.kernels.layered_search import LANES, LAYERS, shortest
from ffsr_plan.tree_search.kernels.path_cost import nearness
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.path_improvement import ImprovedPath
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings
from tests.helpers.free_scenes import beside_a_box, gap, scattered

SETTINGS = TreeSettings(reaches=(1.6,), first_checks=100_000, joint_range=None)


def found(problem, seed=0):
    space = SearchSpace(problem, 1e-3)
    path = Restarts(space, np.random.default_rng(seed), SETTINGS).find(400_000)
    return space, ImprovedPath(space, *path), random_state(np.random.default_rng(seed))


def problems():
    planar, arm = fp.load_robot("planar_dual_arm"), fp.load_robot("satellite_ur5")
    yield scattered(planar, 0)
    yield scattered(planar, 1, delta=0.05, clearance_cap=0.5)
    yield gap(planar, 0)
    yield beside_a_box(arm, 0)


def is_clear(space, path, problem):
    states = path.states
    attitudes = np.zeros((len(states), 4))
    attitudes[0] = problem.start[3:7]
    return fly_path(space.arrays, states, attitudes, 0, path.last) == path.last


@pytest.mark.parametrize("number", range(4))
def test_each_step_keeps_the_path_clear_and_costs_no_more(number):
    problem = next(itertools.islice(problems(), number, None))
    space, path, random = found(problem)
    start, goal, cost = path.states[0], path.states[-1], path.cost
    first, corners = cost, path.last
    for _ in range(3):
        for step in (
            lambda: path.move(random, 8000),
            lambda: path.thin(20_000),
            lambda: path.search_around(random, 20_000),
        ):
            step()
            assert path.cost <= cost + 1e-6
            cost = path.cost
            assert is_clear(space, path, problem)
            assert np.array_equal(path.states[0], start)
            assert np.array_equal(path.states[-1], goal)
    assert path.cost < 0.8 * first
    assert path.last < max(corners, 20)


def test_corners_on_a_straight_line_are_left_out(robot):
    goal = robot.configuration((3.0, 0.0, 0.0), joints={"left_1": 0.4})
    space = SearchSpace(fp.Problem(robot, fp.Scene(), robot.configuration(), goal), 1e-3)
    shares = np.linspace(0.0, 1.0, 9)[:, None]
    states = space.start + shares * (space.goals[0] - space.start)
    attitudes = np.zeros((9, 4))
    attitudes[0, 3] = 1.0
    fly_path(space.arrays, states, attitudes, 0, 8)
    path = ImprovedPath(space, states, attitudes)
    path.thin(10_000)
    assert path.last == 1


def test_more_corners_change_neither_length_nor_nearness(robot):
    problem = scattered(robot, 2, delta=1.0)
    space, path, random = found(problem)
    path.move(random, 4000)
    states = path.states
    finer = np.repeat(states, 3, axis=0)[:-2]
    for k in range(len(states) - 1):
        for j in (1, 2):
            finer[3 * k + j] = states[k] + j / 3.0 * (states[k + 1] - states[k])
    values = []
    for corners in (states, finer):
        attitudes = np.zeros((len(corners), 4))
        attitudes[0] = problem.start[3:7]
        last = len(corners) - 1
        assert fly_path(space.arrays, corners, attitudes, 0, last) == last
        values.append(nearness(space.arrays, corners, attitudes, last))
    assert values[0] == pytest.approx(values[1], rel=1e-6)


def test_the_shortest_path_is_that_of_all_paths():
    rng = np.random.default_rng(3)
    steps = rng.uniform(1.0, 2.0, (LAYERS + 1, LANES, LANES))
    barred = np.ones(steps.shape, dtype=np.bool_)
    barred[:, :2, :2] = rng.random((LAYERS + 1, 2, 2)) < 0.2  # two lanes that can be listed
    lanes = np.zeros(LAYERS + 2, dtype=np.int64)
    value = shortest(steps, barred, lanes)
    best = np.inf
    for way in itertools.product(range(2), repeat=LAYERS):
        nodes = np.array([0, *way, 0])
        edges = np.arange(LAYERS + 1), nodes[:-1], nodes[1:]
        if not barred[edges].any():
            best = min(best, float(steps[edges].sum()))
    assert value == pytest.approx(best)
    edges = np.arange(LAYERS + 1), lanes[:-1], lanes[1:]
    assert steps[edges].sum() == pytest.approx(value)


def test_a_path_that_is_not_clear_any_more_is_led_around(point):
    scene = fp.Scene([[2.0, 0.56, 0.0]], [0.5])
    window = ((0.0, -1.0, 0.0), (4.0, 1.0, 0.0))
    ends = point.configuration(), point.configuration((4.0, 0, 0))
    space = SearchSpace(fp.Problem(point, scene, *ends, window=window), 1e-3)
    attitudes = np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))
    path = ImprovedPath(space, np.stack([space.start, space.goals[0]]), attitudes)
    random = random_state(np.random.default_rng(0))
    assert path.repair(random, 10_000)
    assert path.last == 1
    bar = np.array([[2.0, 0.0, 0.0, 0.0, 0.4, 0.1]])
    space.arrays = space.arrays._replace(bars=bar)
    assert path.repair(random, 40_000)
    assert path.last > 1
    assert is_clear(space, path, space.problem)

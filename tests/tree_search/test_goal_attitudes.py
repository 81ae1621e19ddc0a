"""Closed loops of the joints bring the base to the attitude that is demanded, proven free."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.tree_search.kernels.closed_loops import ENOUGH, draw_sides, lay_loop
from ffsr_plan.tree_search.kernels.flight import fly_path
from ffsr_plan.tree_search.kernels.path_moves import PathMemory
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.path_improvement import ImprovedPath
from ffsr_plan.tree_search.search_space import SearchSpace


def turned(robot, angles, mode="free-flying"):
    """Past two spheres to a goal turned by ZYX angles."""
    scene = fp.Scene([[1.5, 0.2, 0.0], [1.5, 1.5, 0.0]], [0.3, 0.3])
    goal = robot.configuration(
        (3.0, 0.0, 0.0) if mode == "free-flying" else (0.0, 0.0, 0.0), angles
    )
    if mode == "free-floating":
        scene = fp.Scene([[2.5, 0.0, 0.0]], [0.3])
    return fp.Problem(robot, scene, robot.neutral(), goal, mode, reach_attitude=True)


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
@pytest.mark.parametrize(
    ("name", "angles"),
    [("planar_dual_arm", (0.5, 0.0, 0.0)), ("spatial_dual_arm", (0.2, -0.2, 0.2))],
)
def test_an_attitude_that_is_demanded_is_met_and_proven(name, angles, mode):
    problem = turned(fp.load_robot(name), angles, mode)
    for seed in range(2):
        plan = fp.plan(problem, seed=seed, until="first")
        assert plan.arrival_attitude_error < 1e-8
        assert plan.verify().ok


def test_the_path_with_its_loops_is_improved_and_the_attitude_kept(robot):
    problem = turned(robot, (0.5, 0.0, 0.0))
    first, plan = fp.plan(problem, until="first"), fp.plan(problem, fp.TreePlanner(checks=200_000))
    assert plan.length < first.length
    assert plan.arrival_attitude_error < 1e-8
    assert plan.verify().ok


def test_a_loop_comes_back_to_its_corner_and_leaves_the_others(robot):
    space = SearchSpace(turned(robot, (0.5, 0.0, 0.0)), 1e-3)
    states = np.linspace(space.start, space.goals[0], 4)
    memory = PathMemory(np.zeros((2, 20, states.shape[1])), np.zeros((2, 20, 4)), np.zeros(20))
    memory.states[0, :4], memory.attitudes[0, 0, 3] = states, 1.0
    sides, random = np.zeros((2, states.shape[1])), random_state(np.random.default_rng(0))
    for corner in range(4):
        draw_sides(sides, random)
        lay_loop(space.arrays, memory, 3, corner, sides)
        new = memory.states[1, :8]
        assert np.array_equal(new[: corner + 1], states[: corner + 1])
        assert np.array_equal(new[corner + 4 :], states[corner:])
        assert np.array_equal(new[corner : corner + 5, :3], np.tile(states[corner, :3], (5, 1)))
        assert np.all(space.arrays.box[0] <= new)
        assert np.all(new <= space.arrays.box[1])


def test_loops_end_near_the_attitude_and_are_flown_truthfully(robot):
    problem = turned(robot, (0.5, 0.0, 0.0))
    space = SearchSpace(replace(problem, scene=fp.Scene()), 1e-3)
    states, attitudes = np.stack([space.start, space.goals[0]]), np.zeros((2, 4))
    attitudes[0, 3] = 1.0
    fly_path(space.arrays, states, attitudes, 0, 1)
    path = ImprovedPath(space, states, attitudes)
    assert path.missed > 0.4
    path.turn(random_state(np.random.default_rng(0)), 400_000)
    assert path.missed <= ENOUGH
    flown = np.zeros((path.last + 1, 4))
    flown[0, 3] = 1.0
    assert fly_path(space.arrays, path.states, flown, 0, path.last) == path.last
    assert np.array_equal(path.states[-1], space.goals[0])


def test_a_pose_that_is_wanted_is_reached_after_a_detour():
    robot = fp.load_robot("satellite_ur5")
    start = robot.configuration(joints="stowed")
    problem = fp.Problem(
        robot, fp.Scene([[0.8, 0.0, 1.2]], [0.1]), start, robot.neutral(), "free-floating"
    ).reaching("arm_tool0", [1.0, 0.3, 0.9])
    assert problem.reach_attitude
    plan = fp.plan(problem, until="first")
    assert plan.verify().ok
    assert plan.arrival_attitude_error < 1e-8
    assert np.linalg.norm(plan.configurations[-1] - problem.goal) < 1e-6


def test_an_attitude_out_of_time_is_reported_with_what_may_help(robot):
    problem = turned(robot, (3.0, 0.0, 0.0))
    with pytest.raises(fp.PathNotFound, match="a goal attitude nearer to that of the start"):
        fp.plan(problem, fp.TreePlanner(checks=3_000))

"""Closed loops of the joints bring the base to the attitude that is demanded, proven free."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.tree_search.kernels.attitude_keeping import Part, displace, fill_slopes, solve
from ffsr_plan.tree_search.kernels.closed_loops import ENOUGH, draw_sides, lay_loop
from ffsr_plan.tree_search.kernels.flight import fly_path
from ffsr_plan.tree_search.kernels.path_moves import PathMemory
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS
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


def test_without_a_path_to_the_attitude_the_error_says_by_how_much_it_is_missed(robot):
    with pytest.raises(
        fp.PathNotFound, match="the best path misses the goal's attitude by"
    ) as info:
        fp.plan(turned(robot, (2.9, 0.0, 0.0)), fp.TreePlanner(checks=3_000))
    assert 0.01 < info.value.attitude_missed <= np.pi
    assert "a goal attitude nearer to that of the start" in info.value.advice
    both = replace(info.value, on_lattice="layer 3 cannot be passed")
    assert str(both).endswith("On the lattice: layer 3 cannot be passed")
    assert "misses the goal's attitude" in str(both)


def on_the_spot(robot, degrees, **options):
    """The base turns where it is, by the arms alone."""
    goal = robot.configuration((0.0, 0.0, 0.0), (np.radians(degrees), 0.0, 0.0))
    return fp.Problem(robot, fp.Scene(), robot.neutral(), goal, reach_attitude=True, **options)


@pytest.mark.parametrize(("degrees", "best"), [(-10, 4.83), (20, 6.41)])
def test_a_turn_on_the_spot_is_as_short_as_on_a_lattice_made_for_it(robot, degrees, best):
    """The best lengths are those of docs/benchmarks/turning.md, found with posture axes."""
    plan = fp.plan(on_the_spot(robot, degrees), fp.TreePlanner(checks=500_000))
    assert plan.length < 1.05 * best


def bent_path(name, scene=None):
    """A path with random corners, flown, on the way to the attitude at which it arrives."""
    robot, rng = fp.load_robot(name), np.random.default_rng(3)
    problem = replace(turned(robot, (0.2, 0.1, 0.1)), scene=scene or fp.Scene())
    space = SearchSpace(problem, 1e-3)
    states = np.linspace(space.start, space.goals[0], 9)
    states[1:-1, JOINTS:] += rng.normal(0.0, 0.1, (7, states.shape[1] - JOINTS))
    attitudes = np.zeros((9, 4))
    attitudes[0, 3] = 1.0
    assert fly_path(space.arrays, states, attitudes, 0, 8) == 8
    goal = robot.assemble(problem.goal[:3], attitudes[-1], robot.joint_values(problem.goal))
    space = SearchSpace(replace(problem, goal=goal), 1e-3)
    return space, states, attitudes


def part_of(memory, first, last, held=()):
    shape = memory.states.shape[1:]
    flags = np.zeros(shape[0], dtype=np.bool_)
    flags[[first, last, *held]] = True
    return Part(
        first, last, flags, np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape),
        np.zeros((3, 3)),
    )  # fmt: skip


def memory_of(states, attitudes):
    memory = PathMemory(np.zeros((2, 60, states.shape[1])), np.zeros((2, 60, 4)), np.zeros(60))
    memory.states[0, : len(states)], memory.attitudes[0, : len(states)] = states, attitudes
    return memory


@pytest.mark.parametrize("name", ["planar_dual_arm", "spatial_dual_arm"])
def test_slopes_are_how_the_arrival_turns_with_each_joint_of_each_corner(name):
    space, states, attitudes = bent_path(name)
    memory = memory_of(states, attitudes)
    part = part_of(memory, 0, 8)
    fill_slopes(space.arrays, memory, part)
    robot, step = space.problem.robot, 1e-4
    for corner in (1, 4, 7):
        for joint in range(robot.nd):
            ends = []
            for sign in (-1.0, 1.0):
                joints = states[:, JOINTS:].copy()
                joints[corner, joint] += sign * step
                reaction = Reaction.along(robot, joints)
                ends.append(reaction.attitudes(space.problem.start[3:7])[-1])
            turn = rotations.log(rotations.multiply(ends[1], rotations.inverse(ends[0])))
            expected = turn / (2.0 * step)
            assert np.allclose(part.slopes[corner, JOINTS + joint], expected, atol=2e-4)


@pytest.mark.parametrize("held", [(), (3, 4)])
def test_the_step_solves_the_stated_programme(held):
    """Least change in the metric of A that goes towards the line and turns the arrival by e."""
    space, states, attitudes = bent_path("spatial_dual_arm")
    space.arrays.box[:, JOINTS:] = [[-1e3], [1e3]]  # no limits
    memory = memory_of(states, attitudes)
    part = part_of(memory, 0, 8, held)
    fill_slopes(space.arrays, memory, part)
    solve(space.arrays, memory, part)
    error, share = np.array([0.02, -0.01, 0.03]), 0.3
    bend = share * part.line
    bend[list(part.held.nonzero()[0])] = 0.0
    changed = memory.states[0].copy()
    displace(space.arrays, part, bend.copy(), error, changed)
    free = [c for c in range(1, 8) if c not in held]
    lengths = np.linalg.norm((states[1:] - states[:-1]) * space.arrays.weights[1], axis=1)
    a = np.diag(1 / lengths[:-1] + 1 / lengths[1:])
    a -= np.diag(1 / lengths[1:-1], 1) + np.diag(1 / lengths[1:-1], -1)
    rows = np.array(free) - 1
    a = a[np.ix_(rows, rows)]
    count, joints = len(free), states.shape[1] - JOINTS
    whole = np.kron(a, np.eye(joints))
    slopes = part.slopes[free][:, JOINTS:].reshape(count * joints, 3).T
    aim = whole @ (share * part.line[free][:, JOINTS:]).ravel()
    system = np.block([[whole, slopes.T], [slopes, np.zeros((3, 3))]])
    expected = np.linalg.solve(system, np.append(aim, error))[: count * joints]
    found = (changed[: len(states)] - states)[free][:, JOINTS:].ravel()
    assert np.linalg.norm(found - expected) < 1e-3 * np.linalg.norm(expected)
    assert np.allclose(slopes @ found, error, atol=1e-4)
    assert np.array_equal(changed[[0, 8, *held]], states[[0, 8, *held]])


@pytest.mark.parametrize("name", ["planar_dual_arm", "spatial_dual_arm"])
def test_straightening_shortens_a_path_and_arrives_as_before(name):
    scene = fp.Scene([[1.5, 2.0, 0.0]], [0.3])
    space, states, attitudes = bent_path(name, scene)
    path = ImprovedPath(space, states, attitudes)
    before = path.cost
    path.straighten(random_state(np.random.default_rng(0)), 60_000)
    assert path.cost < 0.8 * before
    assert path.missed <= 0.002
    flown = np.zeros((path.last + 1, 4))
    flown[0, 3] = 1.0
    assert fly_path(space.arrays, path.states, flown, 0, path.last) == path.last
    assert angle_between(flown[-1], attitudes[-1]) == pytest.approx(path.missed, abs=1e-6)

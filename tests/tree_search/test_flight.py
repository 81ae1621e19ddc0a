"""Compiled flight of edges agrees with the motion that is proven, and stops in time."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery, SelfQuery
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.tree_search.kernels.flight import fly, locate, observe
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, TURN
from ffsr_plan.tree_search.search_space import SearchSpace

MODES = ("free-flying", "attitude-held", "free-floating")


def ends(robot, rng):
    """Two configurations with random joints, at most 3 rad from zero, and random base poses."""
    postures = rng.uniform(robot.lower, robot.upper, (2, robot.nd)).clip(-3.0, 3.0)
    return [
        robot.configuration(
            rng.normal(size=3), rng.normal(size=3),
            dict(zip(robot.joint_names, posture, strict=True)),
        )
        for posture in postures
    ]  # fmt: skip


def states_between(space, rng, count):
    low, high = space.arrays.box
    return rng.uniform(low, high, (count, len(low)))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", ["planar_dual_arm", "spatial_dual_arm", "satellite_ur5"])
def test_the_attitude_on_arrival_is_that_of_the_motion(name, mode):
    robot, rng = fp.load_robot(name), np.random.default_rng(3)
    for _ in range(5):
        start, goal = ends(robot, rng)
        space = SearchSpace(fp.Problem(robot, fp.Scene(), start, goal, mode), 1e-3)
        arrival = np.zeros(4)
        begin, end = space.start, space.goals[0]
        assert fly(space.arrays, begin, start[3:7].copy(), end, arrival, False) == 1.0
        motion = Motion(
            robot, mode, start, goal, np.stack([begin[:3], end[:3]]),
            np.stack([begin[JOINTS:], end[JOINTS:]]),
        )  # fmt: skip
        assert angle_between(motion.attitudes[-1], arrival) < 3e-5


def placed(space, begin, end, share, quat):
    """(nq,) configuration where a flight ended, from the exact motion."""
    problem = space.problem
    robot, stop = problem.robot, begin + share * (end - begin)
    first = robot.assemble(begin[:3], quat, begin[JOINTS:])
    last = robot.assemble(stop[:3], quat, stop[JOINTS:])
    motion = Motion(
        robot, problem.mode, first, last, np.stack([begin[:3], stop[:3]]),
        np.stack([begin[JOINTS:], stop[JOINTS:]]),
    )  # fmt: skip
    times = np.linspace(0.0, 1.0, 60)
    return motion.at(np.zeros(60, dtype=np.int64), times)


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
def test_flights_that_are_clear_touch_nothing(mode):
    robot, rng = fp.load_robot("satellite_ur5"), np.random.default_rng(5)
    scene = fp.Scene(rng.uniform([-0.5, -3, -3], [5.5, 3, 3], (40, 3)), rng.uniform(0.1, 0.3, 40))
    start = robot.configuration(joints="stowed")
    goal = robot.configuration((1.0, 0.0, 0.0))
    space = SearchSpace(fp.Problem(robot, scene, start, goal, mode), 1e-3)
    obstacles, links = ObstacleQuery(robot, scene), SelfQuery(robot)
    whole = cut = 0
    for end in states_between(space, rng, 200):
        if mode == "free-floating":
            end[:3] = space.start[:3]
        arrival, quat = np.zeros(4), start[3:7].copy()
        share = fly(space.arrays, space.start, quat, end, arrival, True)
        whole, cut = whole + (share == 1.0), cut + (0.0 < share < 1.0)
        if share == 0.0:
            continue
        q = placed(space, space.start, end, share, quat)
        assert obstacles.distances(q).min() > 0.0
        assert min(links.distance(each) for each in q[::6]) > 0.0
        assert angle_between(q[-1, 3:7], arrival) < 1e-5
    assert whole > 5
    assert cut > 20


def test_flights_stop_only_where_something_is_near(point):
    scene = fp.Scene([[2.0, 0.0, 0.0]], [0.5])
    problem = fp.Problem(point, scene, point.configuration(), point.configuration((4.0, 0, 0)))
    space, arrival = SearchSpace(problem, 1e-3), np.zeros(4)
    start = problem.start[3:7].copy()
    share = fly(space.arrays, space.start, start, space.goals[0], arrival, True)
    reached = point.configuration((4.0 * share, 0.0, 0.0))
    assert 0.0 < fp.clearance(point, scene, reached) < 0.02


def test_a_robot_at_rest_that_is_clear_may_stay(robot):
    scene = fp.Scene([[0.0, 3.0, 0.0]], [0.5])
    goal = robot.configuration((1.0, 0, 0))
    space = SearchSpace(fp.Problem(robot, scene, robot.configuration(), goal), 1e-3)
    quat, arrival = np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(4)
    assert fly(space.arrays, space.start, quat, space.start, arrival, True) == 1.0
    assert np.array_equal(arrival, quat)


def test_wheels_turn_the_base_with_their_coordinate(robot):
    goal = robot.configuration((1.0, 0, 0), (0.0, 0.0, 1.0))
    space = SearchSpace(fp.Problem(robot, fp.Scene(), robot.configuration(), goal, MODES[1]), 1e-3)
    middle = space.start.copy()
    middle[TURN] = 0.5 * space.goals[0, TURN]
    quat, arrival = np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(4)
    fly(space.arrays, space.start, quat, middle, arrival, True)
    assert angle_between(arrival, quat) == pytest.approx(0.5)


def test_more_room_is_kept_near_barred_edges(point):
    scene = fp.Scene([[2.0, 0.52, 0.0]], [0.5])
    problem = fp.Problem(point, scene, point.configuration(), point.configuration((4.0, 0, 0)))
    space, arrival = SearchSpace(problem, 1e-3), np.zeros(4)
    ways = space.arrays, space.start, problem.start[3:7].copy(), space.goals[0], arrival, True
    assert fly(*ways) == 1.0
    bar = np.array([[2.0, 0.0, 0.0, 0.0, 0.3, 0.03]])
    barred = space.arrays._replace(bars=bar)
    assert fly(barred, *ways[1:]) < 1.0
    bar[0, 1] = 1.0
    assert fly(barred, *ways[1:]) == 1.0


def test_ends_close_to_something_leave_a_smaller_margin(point):
    scene = fp.Scene([[2.0, 0.0, 0.0], [0.0, 0.5004, 0.0]], [0.5, 0.5])
    problem = fp.Problem(point, scene, point.configuration(), point.configuration((4.0, 0, 0)))
    space = SearchSpace(problem, 1e-3)
    assert space.arrays.setup["margin"][0] == pytest.approx(2e-4)
    assert fp.plan(problem, fp.TreePlanner(checks=60_000)).verify().ok


def test_links_near_each_other_at_an_end_are_left_to_the_proof():
    robot = fp.load_robot("satellite_ur5")
    goal = robot.configuration((3.0, 0.0, 0.0), joints="stowed")
    problem = fp.Problem(robot, fp.Scene(), robot.configuration(joints="stowed"), goal)
    pairs = [len(SearchSpace(problem, margin).arrays.pairs) for margin in (1e-3, 0.1, 10.0)]
    assert pairs[0] > pairs[1] > pairs[2] == 0
    assert fp.plan(problem, until="first").verify().ok


def test_a_floating_base_is_where_the_centre_of_mass_leaves_it():
    robot, rng = fp.load_robot("satellite_ur5"), np.random.default_rng(1)
    start, goal = ends(robot, rng)
    space = SearchSpace(fp.Problem(robot, fp.Scene(), start, goal, "free-floating"), 1e-3)
    begin, end, quat, times = space.start, space.goals[0], start[3:7].copy(), np.linspace(0, 1, 7)
    motion = Motion(
        robot, "free-floating", start, goal, np.stack([start[:3]] * 2),
        np.stack([begin[JOINTS:], end[JOINTS:]]),
    )  # fmt: skip
    for time, q in zip(times, motion.at(np.zeros(7, dtype=np.int64), times), strict=True):
        position, velocity, quat = np.zeros(3), np.zeros(3), q[3:7].copy()
        observe(space.arrays, begin, end, float(time))
        locate(space.arrays, begin, end, float(time), quat, position, velocity)
        assert np.allclose(position, q[:3], atol=1e-9)

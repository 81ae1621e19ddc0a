"""Runs in time along a path with corners, against all runs."""

from itertools import product

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.debris.distances_in_time import distances_in_time
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.free_objective import edge_lengths
from ffsr_plan.progress_lattice.progress_roadmap import ProgressRoadmap
from ffsr_plan.progress_lattice.progress_search import ProgressSearch
from ffsr_plan.progress_lattice.side_steps import SideSteps
from ffsr_plan.progress_lattice.ways import LargestStep, PathWay
from ffsr_plan.time_limit.deadline import Deadline

LAYERS = 5


def bent(seed, mode):
    """A problem without a lattice among moving bodies, and a path with a corner."""
    rng, robot = np.random.default_rng(seed), fp.load_robot("planar_dual_arm")
    bodies = []
    for _ in range(int(rng.integers(1, 3))):
        place = np.array([*rng.uniform((0.4, -1.0), (3.4, 1.6)), 0.0])
        velocity = rng.normal(size=3) * (0.06, 0.06, 0.0)
        shapes = [fp.Box(rng.uniform(0.1, 0.4, 3)), fp.Ball(0.1, (0.3, 0.0, 0.0))]
        motion = fp.Spin((0.0, 0.0, rng.uniform(-0.2, 0.2)), velocity)
        bodies.append(fp.MovingBody(shapes, motion, place - 20.0 * velocity))
    goal = robot.configuration((2.0, 1.6, 0.0), (0.5, 0.0, 0.0), {"left_1": 0.7})
    problem = fp.Problem(
        robot, fp.Scene(bodies=bodies), robot.neutral(), goal, mode, delta=0.3,
        window=((-0.6, -0.6, 0.0), (3.0, 2.0, 0.0)), duration=40.0,
        ramp=float(rng.choice([0, 0.2])),
    )  # fmt: skip
    positions = np.array([(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.6, 0.0)])
    start, end = robot.joint_values(robot.neutral()), robot.joint_values(goal)
    joints = np.array([start, 0.3 * start + 0.7 * end, end])
    joints[1, 1] += 0.4
    turns = np.array([0.0, 0.4, 1.0]) if mode == "attitude-held" else None
    return problem, Motion(robot, mode, robot.neutral(), goal, positions, joints, turns)


def runs(way, sides):
    """All sequences of nodes from start to goal."""
    nodes = list(product(range(len(way.values)), range(len(sides.offsets))))
    for inner in product(nodes, repeat=LAYERS - 1):
        run = np.array([(0, sides.origin), *inner, (way.goal, sides.origin)])
        if np.abs(np.diff(run[:, 0])).max() > 1:
            continue
        if all(
            head in sides.heads[tail] for tail, head in zip(run[:-1, 1], run[1:, 1], strict=True)
        ):
            yield run


def best_of_all(problem, way, sides):
    """F of the best run, edges sampled, and the least distance from contact that was met."""
    best, closest, low, high = np.inf, np.inf, *problem.base_window
    known = {}
    for run in runs(way, sides):
        motion = way.motion(run[:, 0], sides.offsets[run[:, 1]])
        if np.any((motion.positions < low - 1e-9) | (motion.positions > high + 1e-9)):
            continue
        cost = edge_lengths(problem, motion).sum()
        if cost >= best:
            continue
        for k in range(LAYERS):
            key = (k, *run[k], *run[k + 1])
            if key not in known:
                time = np.linspace(0.0, 1.0, 101)
                q = motion.at(np.full(101, k), time)
                instants = problem.pace(LAYERS).instants(k + time)
                found = distances_in_time(problem.robot, problem.obstacles, q, instants)
                known[key] = found.min(), found[-1]
            closest = min(closest, abs(known[key][0]))
            if known[key][0] <= 0.0:
                break
            cost += problem.delta / known[key][1] if k < LAYERS - 1 else 0.0
        else:
            best = min(best, cost)
    return best, closest


@pytest.mark.parametrize(
    ("mode", "aside", "seed"),
    [
        ("free-flying", False, 19),
        ("free-flying", False, 10),  # without a run
        ("free-flying", True, 0),
        ("free-flying", True, 14),
        ("free-flying", True, 19),
        ("attitude-held", False, 1),
        ("attitude-held", True, 22),
        ("attitude-held", True, 26),
    ],
)
def test_a_run_along_a_path_is_the_best_of_all_runs(seed, mode, aside):
    problem, path = bent(seed, mode)
    way = PathWay(problem, path, LargestStep(np.inf) if aside else LargestStep(1.2))
    sides = SideSteps.around(np.array([1]), 1, 0.4) if aside else SideSteps.none()
    search = ProgressSearch(ProgressRoadmap(problem, way, sides, LAYERS, Deadline()), Deadline())
    nodes, (best, closest) = search.path(), best_of_all(problem, way, sides)
    found = np.inf
    if nodes is not None:
        motion = way.motion(nodes[:, 0], sides.offsets[nodes[:, 1]])
        instants = problem.pace(LAYERS).instants(np.arange(1.0, LAYERS))
        inner = motion.configurations()[1:-1]
        near = distances_in_time(problem.robot, problem.obstacles, inner, instants)
        found = edge_lengths(problem, motion).sum() + problem.delta * np.sum(1.0 / near)
    assert closest > 1e-3
    assert found == pytest.approx(best, rel=1e-12)


def test_a_place_of_a_path_has_one_configuration_whichever_way_it_is_reached():
    problem, path = bent(0, "free-flying")
    way = PathWay(problem, path, LargestStep(0.3))
    last = way.goal
    places = np.array([*range(last), *range(last, 2, -1), *range(2, last + 1)])
    motion = way.motion(places, np.zeros((len(places), 3)))
    assert np.abs(motion.attitudes - motion.attitudes[0]).max() > 0.01
    for place in range(last + 1):
        same = np.flatnonzero(places == place)
        assert rotations.angle_between(
            motion.attitudes[same[0]], motion.attitudes[same]
        ).max() < 1e-9  # fmt: skip


def test_steps_along_a_path_are_no_larger_than_allowed():
    problem, path = bent(0, "free-flying")
    for largest in (LargestStep(0.5), LargestStep(9.0, 0.3), LargestStep(9.0, 9.0, 0.05)):
        way = PathWay(problem, path, largest)
        motion = way.motion(way.values, np.zeros((len(way.values), 3)))
        assert edge_lengths(problem, motion).max() <= largest.length * (1 + 1e-9)
        assert np.linalg.norm(motion.base_steps(), axis=1).max() <= largest.base * (1 + 1e-9)
        assert np.abs(np.diff(motion.joint_values, axis=0)).max() <= largest.joint * (1 + 1e-9)
        assert edge_lengths(problem, motion).sum() == pytest.approx(
            edge_lengths(problem, path).sum(), rel=1e-12
        )


def test_offsets_from_a_path_stay_in_the_window():
    problem, path = bent(0, "free-flying")
    way = PathWay(problem, path, LargestStep(1.2))
    offsets = np.array([(0.0, 0.0, 0.0), (0.0, -0.5, 0.0), (0.0, 0.7, 0.0), (0.7, 0.0, 0.0)])
    held, low, high = way.holds(offsets), *problem.base_window
    for place in range(len(way.values)):
        for k, offset in enumerate(offsets):
            there = way.motion(np.array([place, place]), np.tile(offset, (2, 1))).positions[0]
            assert held[place, k] == np.all((there >= low) & (there <= high))
    assert 0 < np.count_nonzero(held) < held.size

"""Family `clutter`: random postures among spheres, in the plane and in space, without a lattice."""

from __future__ import annotations

import numpy as np

from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SATELLITE,
    Draft,
    Family,
    joints,
    nearest_turn,
    posture,
    robot_of,
    spheres,
)


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: every other one in space.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    return _in_space(rng) if number % 2 else _in_the_plane(rng)


def _in_the_plane(rng: np.random.Generator) -> Draft:
    robot, count = robot_of(PLANAR), int(rng.integers(8, 15))
    centers = rng.uniform([0.6, -2.2, 0.0], [4.4, 2.2, 0.0], (count, 3))
    radii = rng.uniform(0.12, 0.4, count)
    start, goal = rng.uniform(robot.lower, robot.upper, (2, robot.nd))
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "start": {"joints": joints(robot, start)},
        "goal": {"position": [5.0, 0.0, 0.0], "joints": joints(robot, goal)},
        "window": {"low": [-1.0, -3.0, 0.0], "high": [6.0, 3.0, 0.0]},
        "obstacles": spheres(centers, radii),
    }
    return Draft(f"planar, {count} spheres", tables, 0.03)


def _in_space(rng: np.random.Generator) -> Draft:
    robot, count = robot_of(SATELLITE), int(rng.integers(15, 40))
    centers = rng.uniform([1.7, -3.0, -2.0], [3.5, 3.0, 2.2], (count, 3))
    radii = rng.uniform(0.1, 0.3, count)
    names = sorted(robot.postures)
    start = posture(robot, names[int(rng.integers(len(names)))]) + rng.normal(0.0, 0.2, robot.nd)
    goal = rng.uniform([-2.5, -2.8, -2.5, -2.0, -2.0, -1.0], [2.5, 0.2, 2.5, 2.0, 2.0, 1.0])
    goal = nearest_turn(robot, start, goal)
    tables = {
        "robot": {"urdf": SATELLITE, "mode": "free-flying"},
        "start": {"joints": joints(robot, start)},
        "goal": {"position": [5.0, 0.0, 0.0], "joints": joints(robot, goal)},
        "window": {"low": [-1.0, -3.0, -3.0], "high": [6.0, 3.0, 3.0]},
        "obstacles": spheres(centers, radii),
    }
    return Draft(f"satellite with a UR5, {count} spheres", tables, 0.015)


FAMILY = Family(
    "clutter", "5 m through clutter, postures at random, in the plane and in space", 30, 10.0, draw
)

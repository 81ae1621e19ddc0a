"""Family `traps`: starts and goals in cups, whose way out leads away from the other end."""

from __future__ import annotations

import numpy as np

from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SPATIAL,
    Draft,
    Family,
    box,
    joints,
    posture,
    robot_of,
    spheres,
)
from ffsr_plan.problem_set.families.gates import row


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: out of a cup, into a cup, and out of a case in space, in turn.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    if number % 3 == 2:
        return _case(rng)
    return _cup(rng, number % 3 == 1)


def _cup(rng: np.random.Generator, mirrored: bool) -> Draft:
    """A cup of spheres about the start; mirrored, about the goal."""
    robot = robot_of(PLANAR)
    radius, half, depth = rng.uniform(0.12, 0.25), rng.uniform(1.25, 1.6), rng.uniform(1.3, 1.8)
    back = rng.uniform(-1.0, 0.2)
    centers = np.concatenate(
        [
            row((depth, -half), (depth, half), radius),
            row((back, half), (depth, half), radius),
            row((back, -half), (depth, -half), radius),
        ]
    )
    folded = np.array([1.0, 1.6, 0.0, -1.0, -1.6, 0.0]) * rng.uniform()
    inside = joints(robot, folded + rng.normal(0.0, 0.5, robot.nd))
    outside = joints(robot, 0.6 * rng.uniform(robot.lower, robot.upper))
    if mirrored:  # the cup is about the goal and opens away from the start
        centers[:, 0] = 5.0 - centers[:, 0]
        inside, outside = outside, inside
    low, high = (-3.0, 6.5) if not mirrored else (-1.5, 8.0)
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "start": {"joints": inside},
        "goal": {"position": [5.0, 0.0, 0.0], "joints": outside},
        "window": {"low": [low, -4.0, 0.0], "high": [high, 4.0, 0.0]},
        "obstacles": spheres(centers, np.full(len(centers), radius)),
    }
    return Draft("into a cup" if mirrored else "out of a cup", tables, 0.03)


def _case(rng: np.random.Generator) -> Draft:
    """A case of five plates about the start that opens backwards."""
    robot = robot_of(SPATIAL)
    half, front, back = rng.uniform(1.2, 1.6), rng.uniform(1.2, 1.6), rng.uniform(-0.8, 0.0)
    length, middle, thick = front - back, 0.5 * (front + back), 0.1
    plates = [box((thick, 2.0 * half, 2.0 * half), (front, 0.0, 0.0), "bottom")]
    for side, name in ((1.0, "left"), (-1.0, "right")):
        plates.append(box((length, thick, 2.0 * half), (middle, side * half, 0.0), name))
    for side, name in ((1.0, "upper"), (-1.0, "lower")):
        plates.append(box((length, 2.0 * half, thick), (middle, 0.0, side * half), name))
    start = posture(robot, "stowed") + rng.normal(0.0, 0.1, robot.nd)
    goal = posture(robot, "rest") + rng.normal(0.0, 0.3, robot.nd)
    tables = {
        "robot": {"urdf": SPATIAL, "mode": "free-flying"},
        "start": {"joints": joints(robot, start)},
        "goal": {"position": [5.0, 0.0, 0.0], "joints": joints(robot, goal)},
        "window": {"low": [-3.5, -4.0, -4.0], "high": [6.5, 4.0, 4.0]},
        "obstacles": plates,
    }
    return Draft("out of a case in space", tables)


FAMILY = Family(
    "traps", "traps: out of a cup or into one, in the plane and in space", 30, 10.0, draw
)

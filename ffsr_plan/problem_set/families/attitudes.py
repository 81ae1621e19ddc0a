"""Family `attitudes`: the arms bring the base to a goal attitude, in the plane and in space."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SPATIAL,
    Draft,
    Family,
    Tables,
    angles,
    joints,
    posture,
    robot_of,
    spheres,
)


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: in the plane, in space, and in the plane on the spot, in turn.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    planar, flies = number % 3 != 1, number % 3 != 2
    robot = robot_of(PLANAR if planar else SPATIAL)
    if planar:
        low, high = ([0.8, -2.0, 0.0], [2.2, 2.0, 0.0])
        count = int(rng.integers(2, 6))
        vector = np.array([0.0, 0.0, float(rng.choice([-1.0, 1.0]))])
        rest, widest = np.zeros(6), 45.0
    else:
        low, high = ([0.8, -2.0, -1.5], [2.2, 2.0, 1.5])
        count, vector = int(rng.integers(4, 10)), rng.normal(size=3)
        rest, widest = posture(robot, "rest"), 40.0
    degrees = rng.uniform(10.0, widest)
    vector *= math.radians(degrees) / float(np.linalg.norm(vector))
    begin, end = rest + rng.normal(0.0, 0.4, (2, 6))
    tables: Tables = {
        "robot": {"urdf": robot.name, "mode": "free-flying" if flies else "free-floating"},
        "start": {"joints": joints(robot, begin)},
        "goal": {"attitude": angles(vector), "joints": joints(robot, end)},
        "obstacles": spheres(rng.uniform(low, high, (count, 3)), rng.uniform(0.12, 0.35, count)),
    }
    if flies:
        depth = 0.0 if planar else 2.5
        tables["goal"]["position"] = [3.0, 0.0, 0.0]
        tables["window"] = {"low": [-1.0, -2.5, -depth], "high": [4.0, 2.5, depth]}
    where = "in the plane" if planar else "in space"
    how = "in flight" if flies else "on the spot"
    return Draft(f"{degrees:.0f} degrees {where}, {how}", tables, 0.03 if planar else 0.008)


FAMILY = Family(
    "attitudes",
    "goal attitudes that the arms bring about, past a few spheres or on the spot",
    30,
    20.0,
    draw,
)

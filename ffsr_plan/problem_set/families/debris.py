"""Family `debris`: through clouds of a hundred to a hundred thousand spheres."""

from __future__ import annotations

import numpy as np

from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SPATIAL,
    Draft,
    Family,
    joints,
    posture,
    robot_of,
)
from ffsr_plan.problem_set.families.paper import GOAL, START

CLOUDS = {
    100: (8.0, 1.7, 2.0),
    1_000: (14.0, 3.8, 2.0),
    10_000: (22.0, 9.5, 2.0),
    100_000: (38.0, 22.0, 2.0),
}
"""By number of spheres: length and half width of the cloud, and free distance at its ends [m]."""


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: seven of each size, of two robots in turn. The spheres follow from a seed.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    count = list(CLOUDS)[number % 4]
    length, half, spared = CLOUDS[count]
    planar = (number // 4) % 2 == 0
    robot = robot_of(PLANAR if planar else SPATIAL)
    begin, end = START, GOAL
    if not planar:
        begin, end = (
            joints(robot, posture(robot, name) + rng.normal(0.0, 0.15, robot.nd))
            for name in ("rest", "stowed")
        )
    cloud = {
        "seed": int(rng.integers(2**31)),
        "count": count,
        "low": [1.0, -half, -half],
        "high": [1.0 + length, half, half],
        "radii": [0.02, 0.3],
        "spared": spared,
    }
    tables = {
        "robot": {"urdf": robot.name, "mode": "free-flying"},
        "start": {"joints": begin},
        "goal": {"position": [length + 2.0, 0.0, 0.0], "joints": end},
        "clouds": [cloud],
        "lattice": {
            "divisions": 40,
            "lateral": {"half_count": 10, "spacing": 0.25},
            "normal": {"half_count": 10, "spacing": 0.25},
        },
        "objective": {"delta": 0.02, "clearance_cap": 1.0},
    }
    return Draft(f"{robot.name} past {count} spheres", tables)


FAMILY = Family("debris", "through clouds of 100 to 100 000 spheres", 28, 20.0, draw)

"""Family `flights`: flights of 10 m in space past spheres, on a lattice with two offsets."""

from __future__ import annotations

import numpy as np

from ffsr_plan.problem_set.families.drafts import (
    SATELLITE,
    SPATIAL,
    Draft,
    Family,
    Tables,
    angles,
    joints,
    numbers,
    posture,
    robot_of,
    spheres,
)

POSTURES = {SPATIAL: ("rest", "stowed", "reach"), SATELLITE: ("stowed", "ready", "reach")}


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: of both robots in turn, every fifth with an attitude that wheels hold.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    name = (SPATIAL, SATELLITE)[number % 2]
    robot, count = robot_of(name), int(rng.integers(15, 46))
    centers = rng.uniform([2.0, -2.5, -2.5], [8.0, 2.5, 2.5], (count, 3))
    radii = rng.uniform(0.1, 0.35, count)
    chosen = rng.integers(0, 3, 2)
    start, goal = (
        posture(robot, POSTURES[name][int(k)]) + rng.normal(0.0, 0.2, robot.nd) for k in chosen
    )
    held = number % 5 == 4
    place = numbers([10.0, *rng.uniform(-0.8, 0.8, 2)])
    tables: Tables = {
        "robot": {"urdf": name, "mode": "attitude-held" if held else "free-flying"},
        "start": {"joints": joints(robot, start)},
        "goal": {"position": place, "joints": joints(robot, goal)},
        "obstacles": spheres(centers, radii),
        "lattice": {
            "divisions": 40,
            "lateral": {"half_count": 8, "spacing": 0.25},
            "normal": {"half_count": 8, "spacing": 0.25},
        },
        "objective": {"delta": 0.05, "clearance_cap": 1.0},
    }
    if held:
        tables["goal"]["attitude"] = angles(rng.normal(0.0, 0.3, 3))
    kind = ", attitude held" if held else ""
    return Draft(f"{robot.name} past {count} spheres{kind}", tables)


FAMILY = Family("flights", "flights of 10 m in space past 15 to 45 spheres", 30, 10.0, draw)

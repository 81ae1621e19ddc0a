"""Family `gates`: openings that only tucked arms pass, in the plane and in space."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.problem_set.families.drafts import (
    PLANAR,
    SPATIAL,
    Draft,
    Family,
    joints,
    robot_of,
    spheres,
)

ELBOWS = {"joints": {"left_2": 1.0, "right_2": 1.0}, "half_count": 4, "spacing": 0.3}
STOWED = {"towards": "stowed", "levels": 6}


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem: gates with a goal attitude, rings in space, and walls with gaps, in turn.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    return (_gates, _ring, _walls)[number % 3](rng)


def _gates(rng: np.random.Generator) -> Draft:
    places = [5.0] if rng.random() < 0.6 else [3.3, 6.7]
    centers, radii = [], []
    for place in places:
        x, y = place + rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4)
        opening, radius = rng.uniform(1.3, 1.5), rng.uniform(0.7, 1.1)
        half = 0.5 * opening + radius
        centers += [[x, y + half, 0.0], [x, y - half, 0.0]]
        radii += [radius, radius]
    yaw = round(math.radians(rng.uniform(-10.0, 10.0)), 6)
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "goal": {"position": [10.0, 0.0, 0.0], "attitude": [yaw, 0.0, 0.0]},
        "obstacles": spheres(centers, radii),
        "lattice": {
            "divisions": 40,
            "lateral": {"half_count": 10, "spacing": 0.15},
            "postures": [STOWED, ELBOWS],
        },
        "objective": {"delta": 0.05},
    }
    many = "a gate" if len(places) == 1 else "two gates"
    return Draft(f"{many} and {math.degrees(yaw):.1f} degrees", tables)


def _ring(rng: np.random.Generator) -> Draft:
    radius, size = rng.uniform(1.9, 2.1), rng.uniform(0.75, 0.9)
    middle = np.array([rng.uniform(4.0, 6.0), *rng.uniform(-0.4, 0.4, 2)])
    turns = rng.uniform(0.0, math.pi / 4.0) + np.arange(8) * math.pi / 4.0
    around = np.column_stack([np.zeros(8), np.cos(turns), np.sin(turns)])
    tables = {
        "robot": {"urdf": SPATIAL, "mode": "free-flying"},
        "goal": {"position": [10.0, 0.0, 0.0]},
        "obstacles": spheres(middle + radius * around, np.full(8, size)),
        "lattice": {
            "divisions": 40,
            "lateral": {"half_count": 6, "spacing": 0.2},
            "normal": {"half_count": 6, "spacing": 0.2},
            "postures": [STOWED],
        },
        "objective": {"delta": 0.05},
    }
    return Draft(f"a ring with an opening of {2.0 * (radius - size):.2f} m", tables)


def _walls(rng: np.random.Generator) -> Draft:
    robot, rows, radii = robot_of(PLANAR), [], []
    walls = [2.0] if rng.random() < 0.5 else [1.6, 3.4]
    for x in walls:
        middle, gap = rng.uniform(-0.6, 0.6), rng.uniform(0.95, 1.25)
        radius = rng.uniform(0.15, 0.3)
        for side in (-1.0, 1.0):
            first = middle + side * (0.5 * gap + radius)
            rows.append(row((x, first), (x, side * 3.6), radius))
            radii.append(np.full(len(rows[-1]), radius))
    held = joints(robot, rng.normal(0.0, 0.25, robot.nd))
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "start": {"joints": held},
        "goal": {"position": [5.0, 0.0, 0.0], "joints": held},
        "window": {"low": [-1.0, -3.0, 0.0], "high": [6.0, 3.0, 0.0]},
        "obstacles": spheres(np.concatenate(rows), np.concatenate(radii)),
    }
    return Draft(f"{len(walls)} walls with a gap", tables, 0.03)


def row(begin: tuple[float, float], end: tuple[float, float], radius: float) -> Array:
    """(k, 3) centres of spheres in the plane z = 0, 1.2 radii apart at most.

    Args:
        begin: x and y of the first one [m].
        end: x and y of the last one [m].
        radius: of the spheres [m].
    """
    way = np.subtract(end, begin)
    count = max(2, int(np.ceil(np.linalg.norm(way) / (1.2 * radius))) + 1)
    centers = np.zeros((count, 3))
    centers[:, :2] = begin + np.linspace(0.0, 1.0, count)[:, None] * way
    return centers


FAMILY = Family("gates", "gates, rings and gaps in walls that need tucked arms", 30, 20.0, draw)

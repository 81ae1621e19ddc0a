"""Family `paper`: the paper's robot in the plane, 10 m past a few spheres, on its lattice."""

from __future__ import annotations

import numpy as np

from ffsr_plan.problem_set.families.drafts import PLANAR, Draft, Family, spheres

START = {
    "left_1": -0.6,
    "left_2": -0.9,
    "left_3": -0.3,
    "right_1": 0.2,
    "right_2": 0.9,
    "right_3": 0.5,
}
GOAL = {
    "left_1": 0.7,
    "left_2": -1.7,
    "left_3": -0.4,
    "right_1": 0.5,
    "right_2": 0.5,
    "right_3": 0.6,
}
FIG2 = (
    (3.0, 0.25, 0.35),
    (6.4, -0.3, 0.4),
    (4.6, 2.9, 0.4),
    (4.4, -2.8, 0.4),
    (8.0, 2.2, 0.3),
    (1.2, 2.3, 0.3),
)
"""x, y and radius of the spheres of the scenarios `fig2a` and `fig2b` [m]."""
OBJECTIVES = (
    {"delta": 6.0, "length_unit": 0.1},
    {"delta": 2.0, "length_unit": 0.1},
    {"delta": 0.0},
    {"delta": 0.1},
)


def draw(rng: np.random.Generator, number: int) -> Draft:
    """A problem; the first two are those of Fig. 2.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    count = int(rng.integers(4, 12))
    x, y = rng.uniform(1.8, 8.2, count), rng.uniform(-3.0, 3.0, count)
    rows = np.column_stack([x, y, rng.uniform(0.15, 0.5, count)])
    if number < 2:
        rows = np.array(FIG2)
    centers = np.column_stack([rows[:, :2], np.zeros(len(rows))])
    objective = OBJECTIVES[number % 4]
    half, spacing = (40, 0.075) if number < 2 else (20, 0.15)
    tables = {
        "robot": {"urdf": PLANAR, "mode": "free-flying"},
        "start": {"joints": START},
        "goal": {"position": [10.0, 0.0, 0.0], "joints": GOAL},
        "obstacles": spheres(centers, rows[:, 2]),
        "lattice": {"divisions": 40, "lateral": {"half_count": half, "spacing": spacing}},
        "objective": objective,
    }
    scene = f"Fig. 2({'ab'[number]})" if number < 2 else f"{len(rows)} spheres"
    delta = f"delta = {objective['delta']:g}"
    return Draft(f"{scene}, {delta}", tables)


FAMILY = Family("paper", "the paper's robot, 10 m past 4 to 11 spheres in the plane", 30, 5.0, draw)

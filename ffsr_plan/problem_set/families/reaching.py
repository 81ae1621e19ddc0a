"""Family `reaching`: a free-floating arm puts its tool beside or behind a target."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.problem_set.families.drafts import (
    SATELLITE,
    Draft,
    Family,
    box,
    clear,
    joints,
    nearest_turn,
    posture,
    robot_of,
)
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import Box

LOW, HIGH = (-np.pi, -np.pi, -2.8, -np.pi, -np.pi, -1.0), (np.pi, 0.5, 2.8, np.pi, np.pi, 1.0)
_TRIES = 400


def draw(rng: np.random.Generator, number: int) -> Draft | None:
    """A problem: a box, every other one with a panel; None if no posture reaches it.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    robot = robot_of(SATELLITE)
    half = rng.uniform([0.12, 0.2, 0.15], [0.25, 0.4, 0.35])
    middle = rng.uniform([0.9, -0.3, 0.9], [1.1, 0.3, 1.2])
    turn = rotations.exp(rng.normal(0.0, 0.3, 3))
    attitude = np.round(rotations.to_angles(turn), 6)
    shapes = [("target", 2.0 * half, middle)]
    if number % 2:
        side = float(rng.choice([-1.0, 1.0]))
        aside = rotations.rotate(turn, np.array([0.0, side * (half[1] + 0.5), 0.0]))
        shapes.append(("panel", np.array([0.5, 0.9, 0.02]), middle + aside))
    tables = [box(size, place, name, attitude) for name, size, place in shapes]
    scene = Scene(shapes=[Box(t["box"]["size"], t["box"]["position"], attitude) for t in tables])
    postures = rng.uniform(LOW, HIGH, (_TRIES, robot.nd))
    tools = robot.tree.poses(postures).origins[:, -1]
    local = (tools - middle) @ rotations.matrix(turn)
    near = (np.max(np.abs(local) - half, axis=1) < 0.35) & (local[:, 0] > 0.0)
    for values in postures[near]:
        q = robot.configuration(joints=joints(robot, values))
        if clear(robot, scene, q, 0.02):
            start = posture(robot, "stowed")
            goal = nearest_turn(robot, start, values)  # as no other is the straight way
            made = {
                "robot": {"urdf": SATELLITE, "mode": "free-floating"},
                "start": {"joints": joints(robot, start)},
                "goal": {"joints": joints(robot, goal)},
                "obstacles": tables,
            }
            panel = " with a panel" if number % 2 else ""
            return Draft(f"beside a box{panel}", made, 0.015, apart=True)
    return None


FAMILY = Family("reaching", "a free-floating UR5 reaches beside or behind a target", 30, 10.0, draw)

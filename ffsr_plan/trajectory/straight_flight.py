"""The flight along a straight line, with which the fuel of others is compared."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.robots.robot import SpaceRobot


def change_of_place(robot: SpaceRobot, ends: Array) -> Array:
    """(3,) displacement of the centre of mass between two configurations (2, nq) [m]."""
    centers = ends[:, :3] + rotations.rotate(
        ends[:, 3:7], centers_of_mass(robot, robot.joint_values(ends))
    )
    change: Array = centers[1] - centers[0]
    return change


def straight_delta_v(change: Array, duration: float, strength: float) -> float:
    """Least delta-v of a flight from rest to rest [m/s].

    One push, a coast and one push against it: a coast at the speed w between pushes of w / a covers
    d = w (t - w / a).

    Args:
        change: (3,) change of place of the centre of mass [m].
        duration: t, no shorter than possible [s].
        strength: a, limit on thrust / mass; may be infinite [m/s^2].
    """
    distance = float(np.linalg.norm(change))
    root = np.sqrt(max(duration**2 - 4.0 * distance / strength, 0.0))
    return 4.0 * distance / (duration + float(root))

"""Motions of random robots, and flights of them: without a planner, so that anything can bend."""

import numpy as np

from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.trajectory.flight_limits import read_limits
from ffsr_plan.trajectory.timed_motion import timed
from tests.helpers.urdf_builders import random_configuration, random_robot

ALL = (
    "joint_velocity", "joint_acceleration", "joint_jerk", "joint_torque", "base_velocity",
    "thruster_acceleration", "thruster_jerk", "turn_velocity", "turn_acceleration",
)  # fmt: skip
USUAL = {"joint_acceleration": 0.05, "thruster_acceleration": 0.02, "turn_acceleration": 0.01}


def read(robot, **given):
    jump = given.pop("velocity_jump", 0.0)
    return read_limits(robot, velocity_jump=jump, **(dict.fromkeys(ALL) | given))


def flown(motion, clearance=np.inf, **given):
    return timed(motion, read(motion.robot, **given), clearance)


def bent_motion(seed, mode, edges=4, joints_bend=False, depth=3):
    """A random robot on a path with corners of the base and, if asked for, of the joints."""
    robot, rng = random_robot(seed, depth=depth), np.random.default_rng(seed)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    way = np.linspace(start[:3], goal[:3], edges + 1)
    way[1:-1] += rng.normal(size=(edges - 1, 3))
    values = None
    if joints_bend:
        travel = robot.joint_change(start, goal)
        values = robot.joint_values(start) + np.linspace(0, 1, edges + 1)[:, None] * travel
        values[1:-1] += 0.3 * rng.normal(size=(edges - 1, robot.nd))
    return Motion(robot, mode, start, goal, way, values)


def straight_motion(robot, points, mode="free-flying"):
    """The base along straight lines between points (m + 1, 3), the joints at rest."""
    start, goal = (robot.configuration(p) for p in (points[0], points[-1]))
    return Motion(robot, mode, start, goal, np.array(points, dtype=float))


def inside(flight, count=30, share=1e-3):
    """Times (N,) and steps h (N,) [s]: from t - h to t + h the acceleration does not jump.

    `share` is that of h in the length of the piece.
    """
    rng, ends = np.random.default_rng(0), flight.switch_times
    piece = np.sort(rng.integers(0, len(ends) - 1, count))
    length = np.diff(ends)[piece]
    return ends[piece] + rng.uniform(2 * share, 1.0 - 2 * share, count) * length, share * length


__all__ = ["USUAL", "bent_motion", "flown", "inside", "read", "straight_motion"]

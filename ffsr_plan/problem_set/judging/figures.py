"""Figures of a trajectory: L, F, velocity change and clearance, the same for every planner.

L is the weighted length in base position, wheels' turn and joints, and F of the whole motion is
L + delta times the sum over 40 pieces at equal steps of L of 1 / least clearance, each sampled at
17 places. Neither depends on a lattice or on how densely a trajectory is written down.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ffsr_plan.certification.trajectory_report import TrajectoryReport
from ffsr_plan.collision.debris.distances_in_time import distances_in_time
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.rotations import angle_between, rotate
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.problem.free_objective import STATIONS
from ffsr_plan.problem.objective import motion_objective
from ffsr_plan.problem.problem import Problem

_SAMPLES = 16  # steps of a piece between two stations
_PARTS = {"linear": 4, "cubic": 16}  # of a piece of the trajectory, for lengths and velocities


class Figures(NamedTuple):
    """What a trajectory costs.

    Attributes:
        length: L [m].
        objective: F of the whole motion [length units].
        delta_v: sum of all changes of the velocity of the centre of mass, from rest to rest, in the
            trajectory's own time [m/s]; 0 where nothing moves the base.
        clearance: least of the sampled distances from obstacles [m]; infinite without any.
    """

    length: float
    objective: float
    delta_v: float
    clearance: float


def figures_of(problem: Problem, report: TrajectoryReport) -> Figures:
    """Figures of a trajectory that was judged.

    Args:
        problem: the problem.
        report: of `certify`.
    """
    given = report.trajectory
    parts = _PARTS[given.interpolation]
    places = np.arange(given.pieces * parts + 1) / parts
    times = np.interp(places, np.arange(len(given.times)), given.times)
    q = report.at(times)
    steps = _steps(problem, q)
    length = float(steps.sum())
    distances = _distances(problem, report, times, steps)
    least = [distances[k * _SAMPLES : (k + 1) * _SAMPLES + 1].min() for k in range(STATIONS + 1)]
    return Figures(
        length,
        motion_objective(problem, length, np.array(least)),
        _velocity_change(problem, q, times) if problem.mode.has_thrusters else 0.0,
        float(distances.min()),
    )


def _steps(problem: Problem, q: Array) -> Array:
    """(n,) lengths between configurations (n + 1, nq) [m]."""
    robot, slide = problem.robot, problem.robot.prismatic
    changes = np.array([robot.joint_change(a, b) for a, b in pairwise(q)])
    changes = changes.reshape(len(q) - 1, robot.nd)
    base = np.diff(q[:, :3], axis=0) if problem.mode.has_thrusters else np.zeros((len(q) - 1, 3))
    metres = np.hstack([base, changes[:, slide]]) * problem.position_weight
    radians = changes[:, ~slide]
    if problem.mode.has_wheels:
        radians = np.column_stack([radians, angle_between(q[:-1, 3:7], q[1:, 3:7])])
    radians = radians * problem.rotation_weight
    lengths: Array = np.sqrt(np.sum(metres**2, axis=1) + np.sum(radians**2, axis=1))
    return lengths


def _distances(problem: Problem, report: TrajectoryReport, times: Array, steps: Array) -> Array:
    """Distances from obstacles at all samples of all pieces, ends included [m]."""
    share = np.linspace(0.0, 1.0, (STATIONS + 1) * _SAMPLES + 1)
    passed = np.append(0.0, np.cumsum(steps))
    if problem.scene.moves or passed[-1] == 0.0:
        at = times[0] + share * (times[-1] - times[0])
    else:
        at = np.interp(share * passed[-1], passed, times)
    q, robot, scene = report.at(np.clip(at, times[0], times[-1])), problem.robot, problem.obstacles
    if not len(scene):
        return np.full(len(share), math.inf)
    if scene.moves:
        return distances_in_time(robot, scene, q, at)
    return ObstacleQuery(robot, scene).distances(q)


def _velocity_change(problem: Problem, q: Array, times: Array) -> float:
    """Sum of the changes of the velocity of the centre of mass [m/s]."""
    robot = problem.robot
    values = np.array([robot.joint_values(each) for each in q])
    centers = q[:, :3] + rotate(q[:, 3:7], centers_of_mass(robot, values))
    velocities = np.diff(centers, axis=0) / np.diff(times)[:, None]
    rest = np.zeros((1, 3))
    changes = np.diff(np.vstack([rest, velocities, rest]), axis=0)
    return float(np.linalg.norm(changes, axis=1).sum())

"""Smooth curves flown from their control points alone, by SciPy and a small integrator."""

import numpy as np
import pinocchio as pin
from scipy.interpolate import BSpline

from tests.helpers.dense_flight import STILL, UPRIGHT, product, turned


def spline(control):
    """The uniform cubic B-spline (m + 1, k) whose ends are reflected, on [0, m]."""
    phantom = np.vstack([2 * control[0] - control[1], control, 2 * control[-1] - control[-2]])
    return BSpline(np.arange(len(phantom) + 4) - 3.0, phantom, 3)


def base_rates(robot, joints, rates):
    """(N, 3) angular velocity of the base in its axes at zero angular momentum."""
    data, found = robot.model.createData(), []
    for q, rate in zip(robot.assemble(STILL, UPRIGHT, joints), rates, strict=True):
        angular = pin.computeCentroidalMap(robot.model, data, q)[3:]
        found.append(-np.linalg.solve(angular[:, 3:6], angular[:, 6:] @ rate))
    return np.array(found)


def attitudes(robot, joints, start, steps):
    """(N + 1, 4) attitudes at N equal steps of a joint spline on [0, m], by Runge-Kutta."""
    end = joints.t[-4]
    times = np.linspace(0.0, end, 2 * steps + 1)
    halves = 0.5 * base_rates(robot, joints(times), joints(times, 1))
    halves = np.column_stack([halves, np.zeros(len(halves))])
    h, found = end / steps, [np.array(start)]
    for begin, middle, last in zip(halves[:-1:2], halves[1::2], halves[2::2], strict=True):
        a = begin
        b = product(UPRIGHT + 0.5 * h * a, middle)
        c = product(UPRIGHT + 0.5 * h * b, middle)
        d = product(UPRIGHT + h * c, last)
        quat = product(found[-1], UPRIGHT + h / 6.0 * (a + 2.0 * b + 2.0 * c + d))
        found.append(quat / np.linalg.norm(quat))
    return np.array(found)


def flown(problem, control, steps):
    """(N + 1, nq) configurations along a curve, N equal steps."""
    robot, mode = problem.robot, problem.mode
    joints, end = spline(control.joint_values), len(control.shares) - 1.0
    times = np.linspace(0.0, end, steps + 1)
    if mode == "attitude-held":
        x, y, z, w = problem.start[3:7]
        whole = product(np.array([-x, -y, -z, w]), problem.goal[3:7])
        whole = whole if whole[3] >= 0.0 else -whole
        size = np.linalg.norm(whole[:3])
        half = np.arctan2(size, whole[3]) * spline(control.shares[:, None])(times)
        axis = whole[:3] / max(size, 1e-300)
        quats = product(problem.start[3:7], np.hstack([np.sin(half) * axis, np.cos(half)]))
    else:
        quats = attitudes(robot, joints, problem.start[3:7], steps)
    values = joints(times)
    if mode == "free-floating":
        data, still = robot.model.createData(), robot.assemble(STILL, UPRIGHT, values)
        centers = np.array([pin.centerOfMass(robot.model, data, q).copy() for q in still])
        centers = turned(quats, centers)
        positions = problem.start[:3] + centers[0] - centers
    else:
        positions = spline(control.positions)(times)
    return robot.assemble(positions, quats, values)

"""Plans flown by a small integrator and sampled densely, by neither the planner nor `verify`.

Attitudes follow from Pinocchio's centroidal map by Runge-Kutta steps, distances to spheres from the
URDF's text (`urdf_distances`), contacts of links from Coal's collision test.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from tests.helpers.urdf_distances import least_distances

JOINT_STEP, BASE_STEP = 0.02, 0.01  # [rad] and [m] between samples
AT_ONCE = 200_000  # pairs of a sample and a sphere, to limit memory
STILL, UPRIGHT = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])


class Flown(NamedTuple):
    """Configurations (N, nq) all along a plan, and which of them (m + 1,) are its corners."""

    path: np.ndarray
    corners: np.ndarray


def product(first, second):
    """Quaternions (..., 4), xyzw, multiplied."""
    a, b, c, d = np.moveaxis(first, -1, 0)
    x, y, z, w = np.moveaxis(second, -1, 0)
    rows = [
        d * x + a * w + b * z - c * y,
        d * y + b * w + c * x - a * z,
        d * z + c * w + a * y - b * x,
        d * w - a * x - b * y - c * z,
    ]
    return np.stack(rows, axis=-1)


def turned(quats, vectors):
    """Vectors (N, 3) rotated by quaternions (N, 4)."""
    axis, w = quats[..., :3], quats[..., 3:]
    twice = 2.0 * np.cross(axis, vectors)
    return vectors + w * twice + np.cross(axis, twice)


def rates(robot, joints, steps):
    """(N, 3) angular velocity of the base in its axes at zero angular momentum."""
    data = robot.model.createData()
    maps = []
    for q in robot.assemble(STILL, UPRIGHT, joints):
        maps.append(pin.computeCentroidalMap(robot.model, data, q)[3:].copy())
    angular = np.array(maps)
    return -np.linalg.solve(angular[:, :, 3:6], angular[:, :, 6:] @ steps[:, None])[..., 0]


def small_turns(robot, values, steps, count):
    """(count, 4) turns of the base over equal parts of an edge from joints `values` (nd,)."""
    times = np.linspace(0.0, 1.0, 2 * count + 1)[:, None]
    omegas = rates(robot, values + times * steps, steps)
    halves = 0.5 * np.concatenate([omegas, np.zeros((len(omegas), 1))], axis=1)
    begins, middles, ends, h = halves[:-1:2], halves[1::2], halves[2::2], 1.0 / count
    a = begins
    b = product(UPRIGHT + 0.5 * h * a, middles)
    c = product(UPRIGHT + 0.5 * h * b, middles)
    d = product(UPRIGHT + h * c, ends)
    return UPRIGHT + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)


def wheel_turns(problem, shares, count):
    """(count, 4) turns of a held base, of equal angles, between two shares of the whole turn."""
    x, y, z, w = problem.start[3:7]
    whole = product(np.array([-x, -y, -z, w]), problem.goal[3:7])
    whole = whole if whole[3] >= 0.0 else -whole
    size = np.linalg.norm(whole[:3])
    if size == 0.0:
        return np.tile(UPRIGHT, (count, 1))
    half = np.arctan2(size, whole[3]) * (shares[1] - shares[0]) / count
    return np.tile([*np.sin(half) * whole[:3] / size, np.cos(half)], (count, 1))


def flown(plan, reacts=True):
    """A plan's configurations, from its corners alone; `reacts` False holds the base's attitude."""
    problem, robot = plan.problem, plan.problem.robot
    joints, places = plan.motion.joint_values, plan.motion.positions
    shares = plan.motion.turn_shares
    shares = np.linspace(0.0, 1.0, len(joints)) if shares is None else shares
    quats, rows, moved, corners = [np.array(problem.start[3:7])], [joints[:1]], [places[:1]], [0]
    for k in range(len(joints) - 1):
        steps, way = joints[k + 1] - joints[k], places[k + 1] - places[k]
        parts = max(np.abs(steps).max() / JOINT_STEP, np.linalg.norm(way) / BASE_STEP)
        count = max(4, int(np.ceil(parts)))
        if problem.mode == "attitude-held":
            turns = wheel_turns(problem, shares[k : k + 2], count)
        else:
            turns = small_turns(robot, joints[k], steps, count)
        for turn in turns if reacts else np.tile(UPRIGHT, (count, 1)):
            quat = product(quats[-1], turn)
            quats.append(quat / np.linalg.norm(quat))
        times = np.arange(1, count + 1)[:, None] / count
        rows.append(joints[k] + times * steps)
        moved.append(places[k] + times * way)
        corners.append(corners[-1] + count)
    attitudes, values, positions = np.array(quats), np.concatenate(rows), np.concatenate(moved)
    if problem.mode == "free-floating":
        data, still = robot.model.createData(), robot.assemble(STILL, UPRIGHT, values)
        centers = np.array([pin.centerOfMass(robot.model, data, q).copy() for q in still])
        centers = turned(attitudes, centers)
        positions = problem.start[:3] + centers[0] - centers
    return Flown(robot.assemble(positions, attitudes, values), np.array(corners))


def least_gap(plan, path):
    """Least distance of configurations (N, nq) to an obstacle [m], and whether any links touch."""
    problem, robot = plan.problem, plan.problem.robot
    centers, radii = problem.scene.centers, problem.scene.radii
    least, parts = np.inf, 1 + len(path) * len(centers) // AT_ONCE
    for some in np.array_split(path, parts):
        values = dict(zip(robot.joint_names, robot.joint_values(some).T, strict=True))
        gaps = least_distances(robot.urdf, some[:, :3], some[:, 3:7], values, centers, radii)
        least = min(least, float(gaps.min()))
    geometry, data = robot.collision_model, robot.model.createData()
    shapes = geometry.createData()
    touching = any(
        pin.computeCollisions(robot.model, data, geometry, shapes, q, True) for q in path
    )
    return least, touching

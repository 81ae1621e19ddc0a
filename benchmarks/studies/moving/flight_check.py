"""Flights among bodies that move, looked at every millisecond by code that shares none with them.

Of a plan, positions and joints at its corners are read, of a problem its URDF, shapes, motions and
times. Kinematics, the base's reaction, poses of bodies, the pace and separations are worked out
here: from the URDF's text, with SciPy's rotations and integrators.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from benchmarks.studies.moving.separation_kernels import least_separation, link_frames, tumbled

MILLISECOND = 1e-3  # [s]
FAR = 1.0  # [m] separations beyond it are not told apart
_GRID = 2000  # of the attitude along the joints' way


class Least(NamedTuple):
    """The least separation of a flight [m], `FAR` if it is larger, and when [s]."""

    separation: float
    time: float


def _numbers(element, name, default="0 0 0"):
    """The numbers of an attribute; of a default where element or attribute is missing."""
    text = default if element is None else element.get(name, default)
    return np.array([float(word) for word in text.split()])


def _origin(element):
    """(3, 3) turn and (3,) place of an element's origin [m]."""
    origin = element.find("origin")
    turn = Rotation.from_euler("xyz", _numbers(origin, "rpy")).as_matrix()
    return turn, _numbers(origin, "xyz")


class UrdfRobot:
    """Kinematics, masses and collision boxes of a robot of revolute joints, from its URDF."""

    def __init__(self, text, joint_names):
        """Read a URDF whose collision shapes are boxes; `joint_names` give the joints' order."""
        root = ET.fromstring(text)
        links = {link.get("name"): link for link in root.findall("link")}
        above = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
        names = [name for name in links if name not in above]
        for name in names:  # grows: parents come first
            names += [c for c, j in above.items() if j.find("parent").get("link") == name]
        size, self.slots = len(names), np.zeros(len(joint_names), dtype=np.int64)
        parents, axes = np.zeros(size, dtype=np.int64), np.zeros((size, 3))
        turns, places = np.tile(np.eye(3), (size, 1, 1)), np.zeros((size, 3))
        for k, name in enumerate(names[1:], start=1):
            joint = above[name]
            parents[k] = names.index(joint.find("parent").get("link"))
            turns[k], places[k] = _origin(joint)
            if joint.get("type") == "fixed":
                continue
            assert joint.get("type") in ("revolute", "continuous"), joint.get("type")
            axes[k] = _numbers(joint.find("axis"), "xyz", "1 0 0")
            self.slots[list(joint_names).index(joint.get("name"))] = k
        self.tree, self.parents, self.axes = (parents, turns, places, axes), parents, axes
        self._read_masses([links[name] for name in names])
        self._read_boxes([links[name] for name in names])

    def _read_masses(self, links):
        self.masses, self.centers = np.zeros(len(links)), np.zeros((len(links), 3))
        self.inertias = np.zeros((len(links), 3, 3))
        for k, link in enumerate(links):
            inertial = link.find("inertial")
            if inertial is None:
                continue
            turn, self.centers[k] = _origin(inertial)
            self.masses[k] = float(inertial.find("mass").get("value"))
            rows = [["ixx", "ixy", "ixz"], ["ixy", "iyy", "iyz"], ["ixz", "iyz", "izz"]]
            read = inertial.find("inertia")
            tensor = np.array([[float(read.get(name)) for name in row] for row in rows])
            self.inertias[k] = turn @ tensor @ turn.T

    def _read_boxes(self, links):
        rows = [(k, each) for k, link in enumerate(links) for each in link.findall("collision")]
        sizes = [_numbers(each.find("geometry").find("box"), "size") for _, each in rows]
        origins = [_origin(each) for _, each in rows]
        self.boxes = (
            np.array([k for k, _ in rows]),
            np.array([turn for turn, _ in origins]),
            np.array([place for _, place in origins]),
            0.5 * np.array(sizes),
        )

    def angles(self, joints):
        """(n, L) angles of all links' joints for joint values (n, nd) [rad]."""
        spread = np.zeros((len(joints), len(self.parents)))
        spread[:, self.slots] = joints
        return spread

    def reaction(self, joints, change):
        """(3,) the base's rotation per unit of joints that change; no angular momentum.

        Args:
            joints: (nd,) [rad].
            change: (nd,) per unit [rad].
        """
        turns, places = (each[0] for each in link_frames(*self.tree, self.angles(joints[None])))
        rates, speeds = np.zeros_like(places), np.zeros_like(places)
        moved = self.angles(change[None])[0]
        for k, p in enumerate(self.parents[1:], start=1):
            rates[k] = rates[p] + turns[k] @ self.axes[k] * moved[k]
            speeds[k] = speeds[p] + np.cross(rates[p], places[k] - places[p])
        arms = np.einsum("kij,kj->ki", turns, self.centers)
        centers, speeds = places + arms, speeds + np.cross(rates, arms)
        inertias = turns @ self.inertias @ np.swapaxes(turns, 1, 2)
        apart = centers - self.masses @ centers / self.masses.sum()
        carried = np.einsum("kij,kj->i", inertias, rates)
        carried = carried + self.masses @ np.cross(apart, speeds)
        squares = np.einsum("ki,ki->k", apart, apart)[:, None, None] * np.eye(3)
        outer = np.einsum("ki,kj->kij", apart, apart)
        whole = (inertias + self.masses[:, None, None] * (squares - outer)).sum(axis=0)
        return -np.linalg.solve(whole, carried)

    def attitudes(self, attitude, joints, change, grid=_GRID):
        """A spline of the base's attitude (xyzw) over shares of a straight joint path."""
        grid = np.linspace(0.0, 1.0, grid + 1)

        def slope(share, q):
            x, y, z = self.reaction(joints + share * change, change)
            a, b, c, d = q
            turned = (d * x + b * z - c * y, d * y + c * x - a * z, d * z + a * y - b * x)
            return 0.5 * np.array([*turned, -a * x - b * y - c * z])

        found = solve_ivp(slope, (0.0, 1.0), attitude, "DOP853", grid, rtol=1e-11, atol=1e-12)
        return CubicSpline(grid, found.y.T)


@lru_cache(maxsize=4)
def _robot(text, joint_names):
    return UrdfRobot(text, joint_names)


@lru_cache(maxsize=4)
def _attitudes(text, joint_names, attitude, joints, change):
    """The attitudes along a joint path, which many flights share."""
    ends = (np.array(each) for each in (attitude, joints, change))
    return _robot(text, joint_names).attitudes(*ends)


def share_run(times, duration, ramp):
    """(n,) share of the path run at times: the integral of a trapezoid of speed."""
    u = np.clip(times / duration, 0.0, 1.0)
    if ramp == 0.0:
        return u
    late = np.maximum(u - 1.0 + ramp, 0.0)
    run = 0.5 * np.minimum(u, ramp) ** 2 / ramp + np.maximum(u - ramp, 0.0) - 0.5 * late**2 / ramp
    return run / (1.0 - ramp)


def body_poses(body, count, step):
    """(count + 1, 3, 3) turns and (count + 1, 3) places of a body at even times from zero on."""
    motion, times = body.motion, step * np.arange(count + 1)
    if hasattr(motion, "times"):  # a table
        places = [np.interp(times, motion.times, column) for column in motion.positions.T]
        turns = Slerp(motion.times, Rotation.from_quat(motion.attitudes))
        return turns(np.minimum(times, motion.times[-1])).as_matrix(), np.column_stack(places)
    places = body.position + times[:, None] * np.asarray(motion.velocity)
    begin = Rotation.from_quat(np.array(body.attitude))
    if hasattr(motion, "inertia"):
        inertia = np.array(motion.inertia)
        turned = tumbled(inertia, np.linalg.inv(inertia), np.array(motion.rate), count, step)
        return (begin * Rotation.from_quat(turned)).as_matrix(), places
    rate = getattr(motion, "rate", np.zeros(3))
    turns = begin * Rotation.from_rotvec(times[:, None] * np.asarray(rate))
    return np.ascontiguousarray(turns.as_matrix()), places


def _shape_arrays(shapes):
    """Arrays of boxes and balls; see `least_separation`."""
    turns, places = np.tile(np.eye(3), (len(shapes), 1, 1)), np.zeros((len(shapes), 3))
    halves, radii = np.zeros((len(shapes), 3)), np.zeros(len(shapes))
    for k, shape in enumerate(shapes):
        places[k] = shape.position
        if hasattr(shape, "size"):
            halves[k] = 0.5 * np.asarray(shape.size)
            turns[k] = Rotation.from_quat(np.array(shape.attitude)).as_matrix()
        else:
            radii[k] = shape.radius
    return turns, places, halves, radii


class Obstacles:
    """What a flight meets: shapes with their poses at even times, each found once."""

    def __init__(self, scene, duration, step=MILLISECOND):
        """The obstacles of a scene of boxes and balls, from time zero to the duration [s]."""
        self.step, self.count = step, round(duration / step)
        self.groups = [
            (_shape_arrays(body.shapes), body_poses(body, self.count, step))
            for body in scene.bodies
        ]
        if scene.shapes:
            still = np.tile(np.eye(3), (self.count + 1, 1, 1)), np.zeros((self.count + 1, 3))
            self.groups.append((_shape_arrays(scene.shapes), still))

    def least(self, robot, base, joints):
        """The least separation of a robot on a flight.

        Args:
            robot: a `UrdfRobot`.
            base: (n, 3, 3) turns and (n, 3) places at the times of the obstacles [m].
            joints: (n, nd) joint values [rad].
        """
        angles, best = robot.angles(joints), Least(FAR, 0.0)
        for shapes, poses in self.groups:
            found, n = least_separation(
                robot.tree, robot.boxes, base, angles, poses, shapes, best.separation
            )
            if n >= 0:
                best = Least(float(found), n * self.step)
        return best


def check_flight(plan, obstacles):
    """The least separation of a plan's flight from what it meets.

    Args:
        plan: a plan in the mode free-flying.
        obstacles: `Obstacles` of its scene.
    """
    problem, motion = plan.problem, plan.motion
    names = tuple(problem.robot.joint_names)
    robot = _robot(problem.robot.urdf, names)
    corners, places = np.array(motion.joint_values), np.array(motion.positions)
    times = obstacles.step * np.arange(obstacles.count + 1)
    at = share_run(times, problem.duration, problem.ramp) * (len(places) - 1)
    every = np.arange(len(places))
    here = np.column_stack([np.interp(at, every, column) for column in places.T])
    joints = np.column_stack([np.interp(at, every, column) for column in corners.T])
    begin, change = corners[0], corners[-1] - corners[0]
    shares = (corners - begin) @ change / max(change @ change, 1e-300)
    if np.abs(begin + shares[:, None] * change - corners).max() < 1e-9:  # one straight line
        given = tuple(problem.start[3:7].tolist()), tuple(begin.tolist()), tuple(change.tolist())
        spline = _attitudes(problem.robot.urdf, names, *given)
        turns = spline(np.interp(at, every, shares))
    else:
        turns = _edge_by_edge(robot, np.array(problem.start[3:7]), corners, at)
    base = np.ascontiguousarray(Rotation.from_quat(turns).as_matrix()), here
    return obstacles.least(robot, base, joints)


def _edge_by_edge(robot, attitude, corners, at):
    """(n, 4) attitudes at places on a joint path with corners, its edges integrated in turn."""
    turns = np.empty((len(at), 4))
    edges = np.minimum(at.astype(np.int64), len(corners) - 2)
    for k, (begin, end) in enumerate(pairwise(corners)):
        here = edges == k
        turns[here] = attitude
        if np.any(begin != end):
            spline = robot.attitudes(attitude, begin, end - begin, grid=60)
            turns[here], attitude = spline(at[here] - k), spline(1.0)
    return turns

"""A checker of motions that uses neither the planner's code nor that of `verify`.

MuJoCo computes poses, the joint-space inertia and distances from MJCF that the test wrote itself.
The attitude of the base is integrated here, by Runge-Kutta steps of zero angular momentum.
"""

from typing import NamedTuple

import mujoco
import numpy as np

from tests.helpers.random_satellites import mjcf

FAR = 1e3  # [m], beyond which distances are not computed
NEAR = 0.02  # [m], below which the least distance along a motion is searched for


class Contact(NamedTuple):
    """Least distances at one configuration or along a motion [m].

    Attributes:
        obstacle: of a link to an obstacle; infinite without any.
        links: of two links that must not touch; infinite without any.
    """

    obstacle: float
    links: float


class Checker:
    """A satellite among spheres."""

    def __init__(self, satellite, centers, radii):
        self.satellite = satellite
        self._model = mujoco.MjModel.from_xml_string(mjcf(satellite, radii))
        self._data = mujoco.MjData(self._model)
        self._data.mocap_pos[:] = np.reshape(centers, (-1, 3))
        model, bodies = self._model, satellite.bodies
        geoms = [
            [model.geom(f"{body.name}_{n}").id for n in range(len(body.solids))] for body in bodies
        ]
        spheres = [model.geom(f"obstacle_{n}").id for n in range(len(radii))]
        self._against_obstacles = [(g, s) for link in geoms for g in link for s in spheres]
        self._against_links = [
            (g, h) for a, b in satellite.checked_pairs() for g in geoms[a] for h in geoms[b]
        ]
        joints = [model.joint(f"joint_{body.name}") for body in satellite.moving]
        self.names = [f"joint_{body.name}" for body in satellite.moving]
        self._places = [int(joint.qposadr[0]) for joint in joints]
        self._dofs = [int(joint.dofadr[0]) for joint in joints]

    def contact(self, position, quat, joints):
        """Least distances at a base position (3,), an attitude (xyzw) and joint values (nd,)."""
        self._put(position, quat, joints)
        return Contact(self._least(self._against_obstacles), self._least(self._against_links))

    def center_of_mass(self, position, quat, joints):
        """(3,) of the whole satellite, world axes [m]."""
        self._put(position, quat, joints)
        mujoco.mj_comPos(self._model, self._data)
        return self._data.subtree_com[1].copy()

    def spin(self, joints, rates):
        """(3,) angular velocity of the base, base axes, for joint rates (nd,), without momentum."""
        self._put(np.zeros(3), (0.0, 0.0, 0.0, 1.0), joints)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_crb(self._model, self._data)
        inertia = np.zeros((self._model.nv, self._model.nv))
        mujoco.mj_fullM(self._model, self._data, inertia)
        base = np.linalg.solve(inertia[:6, :6], -inertia[:6, self._dofs] @ rates)
        return base[3:]

    def _put(self, position, quat, joints):
        self._data.qpos[:3], self._data.qpos[3:7] = position, np.roll(quat, 1)
        self._data.qpos[self._places] = joints
        mujoco.mj_kinematics(self._model, self._data)

    def _least(self, pairs):
        least = FAR
        for a, b in pairs:  # a pair farther apart than the least distance so far returns that
            least = mujoco.mj_geomDistance(self._model, self._data, a, b, least, None)
        return least if pairs else np.inf


class Course:
    """Motion along straight joint segments; what the base does follows from the mode.

    Attributes:
        edges: number of segments.
    """

    def __init__(self, checker, mode, start, goal_quat, positions, joints, parts=16):
        """A motion through corners.

        Args:
            checker: the satellite.
            mode: `free-flying`, `attitude-held` or `free-floating`.
            start: base position (3,) and attitude (4,) xyzw at the start.
            goal_quat: (4,) attitude at the end; counts where wheels hold the attitude.
            positions: (m + 1, 3) base positions where thrusters move it [m].
            joints: (m + 1, nd) joint values [rad or m].
            parts: steps of the integration on each segment.
        """
        self._checker, self._mode, self.edges = checker, mode, len(joints) - 1
        self._positions, self._joints, self._parts = positions, joints, parts
        self._start, self._whole = start, _vector(_product(_inverse(start[1]), goal_quat))
        self._rest = checker.center_of_mass(*start, joints[0])
        self._quats = [np.array(start[1], dtype=float)]
        if mode != "attitude-held":
            for k in range(self.edges * parts):
                self._quats.append(self._stepped(k, 1.0))

    def __call__(self, s):
        """Base position, attitude (xyzw) and joint values at a path parameter from 0 to 1."""
        edge, share = self._split(s * self.edges, self.edges)
        joints = (1.0 - share) * self._joints[edge] + share * self._joints[edge + 1]
        if self._mode == "attitude-held":
            quat = _turned(self._start[1], s * self._whole)
        else:
            part, rest = self._split(s * self.edges * self._parts, self.edges * self._parts)
            quat = self._stepped(part, rest)
        if self._mode == "free-floating":
            there = self._checker.center_of_mass(np.zeros(3), quat, joints)
            return self._rest - there, quat, joints
        ends = self._positions[edge], self._positions[edge + 1]
        return (1.0 - share) * ends[0] + share * ends[1], quat, joints

    def _stepped(self, k, share):
        """Attitude after a share of the k-th part: a fourth-order Magnus step."""
        edge = k // self._parts
        change = (self._joints[edge + 1] - self._joints[edge]) / self._parts
        begin = self._joints[edge] + (k % self._parts) * change
        first, middle, last = (
            share * self._checker.spin(begin + t * share * change, change) for t in (0.0, 0.5, 1.0)
        )
        vector = (first + 4.0 * middle + last) / 6.0 + np.cross(first, last) / 12.0
        return _turned(self._quats[k], vector)

    @staticmethod
    def _split(value, count):
        whole = min(int(value), count - 1)
        return whole, value - whole


def least_along(checker, pose, count):
    """Least distances along a motion: samples, and a search around the least of them.

    Args:
        checker: the checker.
        pose: function of a time in [0, 1] that returns position, attitude and joint values.
        count: number of samples.
    """
    times = np.linspace(0.0, 1.0, count)
    found = [checker.contact(*pose(t)) for t in times]
    best = []
    for k in range(2):
        values = np.array([contact[k] for contact in found])
        least = float(values.min())
        n = int(values.argmin())
        if abs(least) < NEAR:  # golden-section search
            low, high = times[max(n - 1, 0)], times[min(n + 1, count - 1)]
            for _ in range(20):
                a, b = low + 0.382 * (high - low), low + 0.618 * (high - low)
                at_a, at_b = (checker.contact(*pose(t))[k] for t in (a, b))
                low, high = (low, b) if at_a < at_b else (a, high)
                least = min(least, at_a, at_b)
        best.append(least)
    return Contact(*best)


def _turned(quat, vector):
    """(4,) attitude (xyzw) rotated by a rotation vector (3,) in base axes."""
    angle = np.linalg.norm(vector)
    axis = vector / angle if angle > 0.0 else vector
    turned = _product(quat, np.append(np.sin(0.5 * angle) * axis, np.cos(0.5 * angle)))
    return turned / np.linalg.norm(turned)


def _product(p, q):
    """(4,) product of quaternions (xyzw)."""
    vector = p[3] * q[:3] + q[3] * p[:3] + np.cross(p[:3], q[:3])
    return np.append(vector, p[3] * q[3] - p[:3] @ q[:3])


def _inverse(quat):
    return np.append(-np.asarray(quat[:3]), quat[3])


def _vector(quat):
    """(3,) rotation vector of a quaternion (xyzw), by at most half a turn."""
    quat = quat if quat[3] >= 0.0 else -quat
    size = np.linalg.norm(quat[:3])
    return quat[:3] * (2.0 * np.arctan2(size, quat[3]) / size if size > 0.0 else 2.0)

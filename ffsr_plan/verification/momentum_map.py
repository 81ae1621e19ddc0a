"""Angular momentum about the centre of mass by joint rates, and the inertia against it.

Base axes; the base itself is taken to be at rest. What is below a joint moves as one rigid body
when that joint moves alone, so the sums of mass, first and second moments are taken once, from the
tips to the base.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.urdf_reading import Bodies


class MomentumMap(NamedTuple):
    """What joints and base contribute to the angular momentum about the centre of mass.

    Attributes:
        reactions: (N, 3, nd) angular velocity of the base by a unit rate of each joint, if the
            momentum is to vanish, base axes [rad per rad or m].
        least_inertia: (N,) smallest principal inertia of the whole robot, joints locked [kg m^2].
        centers: (N, 3) centre of mass from the base origin, base axes [m].
    """

    reactions: Array
    least_inertia: Array
    centers: Array

    def at(self, samples: IntArray) -> MomentumMap:
        """The map of some samples (n,)."""
        return MomentumMap(*(column[samples] for column in self))

    def followed_by(self, other: MomentumMap) -> MomentumMap:
        """The map of these samples and of others behind them."""
        return MomentumMap(*map(np.concatenate, zip(self, other, strict=True)))


def momentum_map(bodies: Bodies, names: Sequence[str], poses: dict[str, Array]) -> MomentumMap:
    """The momentum map of configurations.

    Args:
        bodies: the robot, from its URDF.
        names: of the moving joints, in the order of the result.
        poses: (N, 4, 4) of each link by name, link axes to base axes.
    """
    count = len(poses[bodies.root])
    moments = {link: _moments(bodies, link, pose) for link, pose in poses.items()}
    columns = np.zeros((count, 3, len(names)))
    linear = np.zeros((count, 3, len(names)))
    for joint in reversed(bodies.joints):
        mass, first, second = moments[joint.child]
        if joint.moves:
            frame, k = poses[joint.child], names.index(joint.name)
            axis = frame[:, :3, :3] @ joint.axis
            if joint.slides:
                columns[:, :, k], linear[:, :, k] = np.cross(first, axis), mass * axis
            else:
                origin = frame[:, :3, 3]
                linear[:, :, k] = np.cross(axis, first - mass * origin)
                columns[:, :, k] = np.einsum("nij,nj->ni", second, axis)
                columns[:, :, k] -= np.cross(first, np.cross(axis, origin))
        above = moments[joint.parent]
        moments[joint.parent] = (above[0] + mass, above[1] + first, above[2] + second)
    mass, first, second = moments[bodies.root]
    centers = first / mass
    columns -= np.cross(centers[:, :, None], linear, axis=1)
    inertia = second - mass * _second(centers)
    reactions = np.asarray(-np.linalg.solve(inertia, columns), dtype=np.float64)
    least = np.asarray(np.linalg.eigvalsh(inertia)[:, 0], dtype=np.float64)
    return MomentumMap(reactions, least, centers)


def _moments(bodies: Bodies, link: str, pose: Array) -> tuple[float, Array, Array]:
    """Mass, and first (N, 3) and second (N, 3, 3) moments of a link about the base origin."""
    inertial = bodies.inertials.get(link)
    if inertial is None:
        return 0.0, np.zeros((len(pose), 3)), np.zeros((len(pose), 3, 3))
    frame = pose @ (np.eye(4) if inertial.origin is None else inertial.origin)
    turn, place, mass = frame[:, :3, :3], frame[:, :3, 3], float(inertial.mass)
    second = turn @ inertial.inertia @ np.swapaxes(turn, 1, 2) + mass * _second(place)
    return mass, mass * place, second


def _second(points: Array) -> Array:
    """(N, 3, 3) inertia of unit masses at points (N, 3) about the origin."""
    square = np.sum(points * points, axis=1)
    return square[:, None, None] * np.eye(3) - points[:, :, None] * points[:, None, :]

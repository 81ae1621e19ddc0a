"""Poses and velocities of all links relative to the base, for many configurations at once.

Links are numbered as in Pinocchio, the base being 0: link k + 1 hangs on joint k of the arms, and a
body that a fixed joint ties to another counts as part of it. All vectors are in base axes. Writing
p for the parent of link j, s_j for its axis, q_j for its joint value and d_j for the offset of its
origin in the parent:

    R_j = R_p P_j exp(s_j q_j)           revolute and continuous; R_p P_j if prismatic
    o_j = o_p + R_p d_j                  d_j constant, or growing by P_j s_j q_j if prismatic
    w_j = w_p + R_j s_j q_j'             revolute and continuous
    o_j' = o_p' + w_p x R_p d_j          + R_j s_j q_j' if prismatic

Apart from R, these are sums along the way from the base to the link: one matrix product each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.rotations import cross


class Poses(NamedTuple):
    """Where the n links are, base frame; K configurations."""

    rotations: Array
    """(K, n, 3, 3), link axes to base axes."""
    origins: Array
    """(K, n, 3) [m]."""


class Velocities(NamedTuple):
    """How the n links move, base frame; per unit of the parameter of the joint rates."""

    angular: Array
    """(K, n, 3) [rad]."""
    linear: Array
    """(K, n, 3) of the links' origins [m]."""


class Tree:
    """The links of a robot that hang on its base.

    Attributes:
        parents: (n,) parent of each link; the base is its own.
        levels: links by their distance from the base, which is left out, counted in joints.
        prismatic: (n,) whether the link slides on its parent.
        axes: (n, 3) joint axis in the link's frame, zero for the base.
    """

    def __init__(self, model: pin.Model) -> None:
        """Read what is constant from a model whose first joint is the free-flyer."""
        placements = [model.jointPlacements[j] for j in range(2, model.njoints)]
        self.parents: IntArray = np.array([0, *(p - 1 for p in list(model.parents)[2:])])
        depth = np.zeros(len(self.parents), dtype=np.int64)
        above = np.eye(len(self.parents))
        for j in range(1, len(self.parents)):
            depth[j] = depth[self.parents[j]] + 1
            above[j] += above[self.parents[j]]
        self._above = above  # 1 where the column's link lies on the way from the base to the row's
        self.levels = [np.flatnonzero(depth == level + 1) for level in range(int(depth.max()))]
        subspaces = np.array([np.zeros(6), *_motion_subspaces(model)])
        self.prismatic: Flags = np.any(subspaces[:, :3] != 0.0, axis=1)
        self.axes: Array = subspaces[:, :3] + subspaces[:, 3:]
        self._turning, self._sliding = subspaces[:, 3:], subspaces[:, :3]
        rotations = np.array([np.eye(3), *(p.rotation for p in placements)])
        self._offsets = np.array([np.zeros(3), *(p.translation for p in placements)])
        skew = np.array([pin.skew(s) for s in self._turning])
        # Rodrigues: exp(s q) = 1 + sin(q) [s] + (1 - cos(q)) [s]^2
        self._fixed, self._sine = rotations, rotations @ skew
        self._versine = rotations @ skew @ skew
        self._slide = np.einsum("nij,nj->ni", rotations, self._sliding)

    def offsets(self, joint_values: Array) -> Array:
        """(K, n, 3) origin of each link in its parent's frame [m], from joint values (K, nd)."""
        offsets: Array = self._offsets + self._slide * _with_base(joint_values)[..., None]
        return offsets

    def poses(self, joint_values: Array) -> Poses:
        """All poses at joint values (K, nd)."""
        q = _with_base(joint_values)[..., None, None]
        rotations = self._fixed + np.sin(q) * self._sine + (1.0 - np.cos(q)) * self._versine
        for level in self.levels:
            rotations[:, level] = rotations[:, self.parents[level]] @ rotations[:, level]
        steps = turned(rotations[:, self.parents], self.offsets(joint_values))
        return Poses(rotations, self._above @ steps)

    def velocities(self, poses: Poses, joint_rates: Array) -> Velocities:
        """All velocities at joint rates (K, nd)."""
        rates = _with_base(joint_rates)[..., None]
        angular = self._above @ (turned(poses.rotations, self._turning) * rates)
        steps = poses.origins - poses.origins[:, self.parents]
        slides = turned(poses.rotations, self._sliding) * rates
        return Velocities(angular, self._above @ (cross(angular[:, self.parents], steps) + slides))


def turned(rotations: Array, vectors: Array) -> Array:
    """Vectors (..., 3) turned by rotation matrices (..., 3, 3)."""
    return np.asarray((rotations @ vectors[..., None])[..., 0])


def _with_base(values: Array) -> Array:
    """(K, n): a zero for the base before the arms' joints."""
    return np.concatenate([np.zeros((len(values), 1)), values], axis=1)


def _motion_subspaces(model: pin.Model) -> list[Array]:
    """(6,) for each joint of the arms: linear and angular velocity at unit rate, link axes."""
    found = []
    neutral = pin.neutral(model)
    for joint in list(model.joints)[2:]:
        data = joint.createData()
        joint.calc(data, neutral)
        found.append(np.array(data.S, dtype=np.float64).ravel())
    return found

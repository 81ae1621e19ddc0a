"""Poses and velocities of all links relative to the base, for many configurations at once.

Links are numbered as in Pinocchio: the base is 0, link k + 1 is moved by joint k of the arms, and a
body on a fixed joint is part of its parent. All vectors are in base axes. With p the parent of link
j, s_j its axis, q_j its joint value and d_j the offset of its origin in the parent:

    R_j = R_p P_j exp(s_j q_j)           revolute and continuous; R_p P_j if prismatic
    o_j = o_p + R_p d_j                  d_j constant, or growing by P_j s_j q_j if prismatic
    w_j = w_p + R_j s_j q_j'             revolute and continuous
    o_j' = o_p' + w_p x R_p d_j          + R_j s_j q_j' if prismatic

Apart from R, these are sums over the links between the base and the link: one matrix product each.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import (
    Array,
    Flags,
    IntArray,
    Records,
    equal_by_content,
    frozen,
    records,
)
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.rotations import cross


class Poses(NamedTuple):
    """Poses of the n links in the base frame, at K configurations.

    Attributes:
        rotations: (K, n, 3, 3) link axes to base axes.
        origins: (K, n, 3) origins of the links [m].
    """

    rotations: Array
    origins: Array


class Velocities(NamedTuple):
    """Velocities of the n links in the base frame, per unit of the parameter of the joint rates.

    Attributes:
        angular: (K, n, 3) [rad].
        linear: (K, n, 3) of the links' origins [m].
    """

    angular: Array
    linear: Array


BODY = np.dtype(
    [
        ("parent", np.int64),
        ("prismatic", np.bool_),
        ("fixed", np.float64, (3, 3)),
        ("sine", np.float64, (3, 3)),
        ("versine", np.float64, (3, 3)),
        ("offset", np.float64, 3),
        ("slide", np.float64, 3),
        ("axis", np.float64, 3),
        ("mass", np.float64),
        ("lever", np.float64, 3),
        ("inertia", np.float64, (3, 3)),
        ("moments", np.float64, 2),
    ],
    align=True,
)
"""A link of a robot for compiled kernels; the base is link 0, its own parent.

A link's rotation relative to its parent is fixed + sin(q) sine + (1 - cos(q)) versine, its origin
in the parent's frame offset + q slide.

    parent      of the link
    prismatic   whether the joint above the link is
    fixed       (3, 3) rotation at joint value zero
    sine        (3, 3), zero for prismatic joints
    versine     (3, 3), zero for prismatic joints
    offset      (3,) [m]
    slide       (3,), zero for revolute joints
    axis        (3,) joint axis in the link's frame, zero for the base
    mass        [kg]
    lever       (3,) centre of mass in the link's frame [m]
    inertia     (3, 3) about the centre of mass, link axes [kg m^2]
    moments     (2,) least and largest principal moment [kg m^2]
"""


class Tree:
    """Kinematic tree of the links of a robot, the base being its root.

    Attributes:
        parents: (n,) parent of each link; the base is its own parent.
        levels: links one joint from the base, two joints from it, and so on.
        prismatic: (n,) whether the joint between the link and its parent is prismatic.
        axes: (n, 3) joint axis in the link's frame, zero for the base.
    """

    def __init__(self, model: pin.Model) -> None:
        """Precompute what does not depend on the joint values.

        Args:
            model: a model whose first joint is the free-flyer.
        """
        placements = [model.jointPlacements[j] for j in range(2, model.njoints)]
        self.parents: IntArray = np.array([0, *(p - 1 for p in list(model.parents)[2:])])
        depth = np.zeros(len(self.parents), dtype=np.int64)
        above = np.eye(len(self.parents))
        for j in range(1, len(self.parents)):
            depth[j] = depth[self.parents[j]] + 1
            above[j] += above[self.parents[j]]
        self._above = above  # 1 where the column's link is the row's link or one of its ancestors
        self.levels = [np.flatnonzero(depth == level + 1) for level in range(int(depth.max()))]
        subspaces = np.array([np.zeros(6), *_motion_subspaces(model)])
        self.prismatic: Flags = np.any(subspaces[:, :3] != 0.0, axis=1)
        self.axes: Array = subspaces[:, :3] + subspaces[:, 3:]
        self._revolute_axes, self._prismatic_axes = subspaces[:, 3:], subspaces[:, :3]
        rotations = np.array([np.eye(3), *(p.rotation for p in placements)])
        self._offsets = np.array([np.zeros(3), *(p.translation for p in placements)])
        skew = np.array([pin.skew(s) for s in self._revolute_axes])
        # Rodrigues: exp(s q) = 1 + sin(q) [s] + (1 - cos(q)) [s]^2
        self._fixed, self._sine = rotations, rotations @ skew
        self._versine = rotations @ skew @ skew
        self._slide = np.einsum("nij,nj->ni", rotations, self._prismatic_axes)

    def bodies(self, model: pin.Model) -> Records:
        """(n,) the links as records of `BODY`.

        Args:
            model: the model that the tree was made from.
        """
        inertias = list(model.inertias)[1:]
        bodies = records(BODY, len(inertias))
        columns = {
            "parent": self.parents,
            "prismatic": self.prismatic,
            "fixed": self._fixed,
            "sine": self._sine,
            "versine": self._versine,
            "offset": self._offsets,
            "slide": self._slide,
            "axis": self.axes,
            "mass": [body.mass for body in inertias],
            "lever": [body.lever for body in inertias],
            "inertia": [body.inertia for body in inertias],
        }
        for name, column in columns.items():
            bodies[name] = column
        bodies["moments"] = np.maximum(np.linalg.eigvalsh(bodies["inertia"]), 0.0)[:, [0, 2]]
        return frozen(bodies)

    def offsets(self, joint_values: Array) -> Array:
        """Origins of the links in their parents' frames.

        Args:
            joint_values: (K, nd) [rad or m].

        Returns:
            (K, n, 3) [m].
        """
        offsets: Array = self._offsets + self._slide * _with_base(joint_values)[..., None]
        return offsets

    def poses(self, joint_values: Array) -> Poses:
        """Poses of all links.

        Args:
            joint_values: (K, nd) [rad or m].
        """
        q = _with_base(joint_values)[..., None, None]
        rotations = self._fixed + np.sin(q) * self._sine + (1.0 - np.cos(q)) * self._versine
        for level in self.levels:
            rotations[:, level] = rotations[:, self.parents[level]] @ rotations[:, level]
        steps = turned(rotations[:, self.parents], self.offsets(joint_values))
        return Poses(rotations, self._above @ steps)

    def velocities(self, poses: Poses, joint_rates: Array) -> Velocities:
        """Velocities of all links.

        Args:
            poses: of the K configurations.
            joint_rates: (K, nd) [rad or m] per unit of any parameter, such as time.
        """
        rates = _with_base(joint_rates)[..., None]
        angular = self._above @ (turned(poses.rotations, self._revolute_axes) * rates)
        steps = poses.origins - poses.origins[:, self.parents]
        slides = turned(poses.rotations, self._prismatic_axes) * rates
        return Velocities(angular, self._above @ (cross(angular[:, self.parents], steps) + slides))


def turned(rotations: Array, vectors: Array) -> Array:
    """Rotate vectors by matrices.

    Args:
        rotations: (..., 3, 3) rotation matrices.
        vectors: (..., 3).

    Returns:
        (..., 3) the products.
    """
    return (rotations @ vectors[..., None])[..., 0]


def _with_base(values: Array) -> Array:
    """(K, n) the values with a zero for the base in front."""
    return np.concatenate([np.zeros((len(values), 1)), values], axis=1)


def _motion_subspaces(model: pin.Model) -> list[Array]:
    """(6,) linear and angular velocity at unit rate of each joint of the arms, link axes."""
    subspaces = []
    neutral = pin.neutral(model)
    for joint in list(model.joints)[2:]:
        data = joint.createData()
        joint.calc(data, neutral)
        subspaces.append(np.array(data.S, dtype=np.float64).ravel())
    return subspaces


@equal_by_content
class Components(NamedTuple):
    """Parts of one configuration, or of N.

    Attributes:
        position: (3,) or (N, 3) base origin in the world [m].
        attitude: (3,) or (N, 3) ZYX angles alpha, beta, gamma of Eq. 2 [rad].
        joints: joint values by name [rad, or m where prismatic]: a float each, or (N,).
    """

    position: Array
    attitude: Array
    joints: dict[str, Any]


def frame_index(model: pin.Model, frame: object) -> int:
    """Index of a frame by its name.

    A URDF may give a link and a joint the same name: the link is meant.

    Args:
        model: the model.
        frame: name of a link, joint or other frame.

    Raises:
        InvalidInput: an unknown frame, with the nearest name.
    """
    frames = model.frames
    known = isinstance(frame, str)
    named = [k for k, each in enumerate(frames) if known and each.name == frame]
    if not named:
        raise unknown_name("frame", frame, dict.fromkeys(each.name for each in frames))
    return next((k for k in named if frames[k].type == pin.FrameType.BODY), named[0])

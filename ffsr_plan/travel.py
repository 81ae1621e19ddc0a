"""How far any point of the robot can travel: the bound behind every proof that an edge is free.

Joints move linearly at |theta_j'| = t_j, the base origin at |p'|, all per unit of the edge's time.
Relative to the base and in its frame, from the base outwards (j a joint, p its parent, d_j its
offset in the parent):

    W_j = W_p + t_j              angular speed, revolute; a prismatic joint adds nothing to W
    V_j = V_p + W_p |d_j| (+t_j) speed of the joint's origin; for a prismatic joint |d_j| grows by
                                 the largest |theta_j| of the path, and V by t_j
    rho_j = rho_p + |d_j|        distance from the base origin

A point at x from the origin of its joint moves at v = V + W x at most, and no faster than
|p'| + Omega (rho + x) + v in the world, Omega being a bound on the base's angular speed.

Omega at zero momentum: the reaction minimises the kinetic energy of the motion about the centre of
mass, so I(theta) omega . omega <= sum m_i |v_i|^2 + lmax_i |w_i|^2 over the bodies' velocities
relative to the base, and I(theta) >= sum lmin_i, the least principal moments of the bodies. Hence
Omega^2 <= sum (m_i (V_i + W_i c_i)^2 + lmax_i W_i^2) / sum lmin_i, with c_i the distance of a
body's centre of mass from its joint.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.inputs import Array
from ffsr_plan.robot import SpaceRobot


class Swing(NamedTuple):
    """Bounds on speeds per unit of an edge's time, one for each collision shape (g,) [m]."""

    world: Array
    """About the base origin, base rotation included; the base's translation comes on top."""
    in_base: Array
    """Relative to the base, in its frame."""


def swing(robot: SpaceRobot, joint_step: Array, joint_reach: Array, omega: float | None) -> Swing:
    """Bound the speed of every point of each collision shape.

    Args:
        robot: the robot.
        joint_step: (nd,) change of the joint values over an edge.
        joint_reach: (nd,) largest |joint value| on the way; matters for prismatic joints only.
        omega: angular speed of the base over an edge [rad], or None where it reacts to the arms.
    """
    model = robot.model
    angular = np.zeros(model.njoints)
    linear = np.zeros(model.njoints)
    distance = np.zeros(model.njoints)
    for j in range(2, model.njoints):
        parent, k = model.parents[j], j - 2
        rate, slides = abs(joint_step[k]), robot.prismatic[k]
        offset = float(np.linalg.norm(model.jointPlacements[j].translation))
        offset += joint_reach[k] if slides else 0.0
        angular[j] = angular[parent] + (0.0 if slides else rate)
        linear[j] = linear[parent] + angular[parent] * offset + (rate if slides else 0.0)
        distance[j] = distance[parent] + offset
    if omega is None:
        omega = _reaction_speed(model, angular, linear)
    shapes = robot.collision_model.geometryObjects
    joints = np.array([g.parentJoint for g in shapes], dtype=np.int64)
    reach = np.array([_reach(g) for g in shapes])
    in_base = linear[joints] + angular[joints] * reach
    return Swing(omega * (distance[joints] + reach) + in_base, in_base)


def _reaction_speed(model: pin.Model, angular: Array, linear: Array) -> float:
    energy, inertia = 0.0, 0.0
    for j in range(1, model.njoints):
        body = model.inertias[j]
        if body.mass == 0.0:
            continue
        least, _, most = np.linalg.eigvalsh(body.inertia)
        speed = linear[j] + angular[j] * float(np.linalg.norm(body.lever))
        energy += body.mass * speed**2 + most * angular[j] ** 2
        inertia += max(least, 0.0)
    return float(np.sqrt(energy / inertia))


def _reach(geometry: pin.GeometryObject) -> float:
    """Largest distance of the shape's points from the origin of the joint that carries it."""
    placement, shape = geometry.placement, geometry.geometry
    if isinstance(shape, coal.Sphere):
        return float(np.linalg.norm(placement.translation) + shape.radius)
    if not isinstance(shape, coal.Box):  # temporary
        shape.computeLocalAABB()
        return float(np.linalg.norm(placement.act(shape.aabb_center)) + shape.aabb_radius)
    corners = np.array(list(product((-1.0, 1.0), repeat=3))) * shape.halfSide
    return float(
        np.max(np.linalg.norm(corners @ placement.rotation.T + placement.translation, axis=1))
    )

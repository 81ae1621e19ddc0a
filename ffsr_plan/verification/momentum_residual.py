"""Angular momentum of a plan's motion, body by body, from finite differences of link poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import Polynomial

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.motion_samples import base_frame_poses, base_turns
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

# central difference of eighth order: weights of the steps 1 .. 4 to either side
_STENCIL = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])
_SPACING = 0.05  # step of the differences, as a share of an edge
_LARGEST_STEP = 0.15  # [rad or m] of a joint over one step of the differences
_MANY_EDGES = 8  # with fewer edges each is longer, and the step is reduced in proportion
_SLOW_TURN = 1e-4  # [rad per edge]
_STATIONS = (0.22, 0.5, 0.78)  # times on each edge at which the momentum is computed


def momentum_residual(plan: PlanData, bodies: Bodies) -> float:
    """Largest angular momentum about the centre of mass, relative to the sum of its terms.

    Args:
        plan: the plan.
        bodies: the robot, from its URDF.
    """
    total, scale = _momentum(plan, bodies, _stations(plan))
    return _relative(total, scale)


def wheel_momentum_error(plan: PlanData, bodies: Bodies) -> float:
    """Largest sum of the plan's wheel momentum and the momentum of the bodies, relative.

    Both are compared for one quintic time law, in world axes and in base axes.

    Args:
        plan: a plan whose attitude is held by wheels.
        bodies: the robot, from its URDF.
    """
    divisions, duration = plan.edges, 10.0
    law = Polynomial([0, 0, 0, 10, -15, 6])
    grid = np.linspace(0.0, 1.0, 100 * divisions + 1)
    elapsed = np.interp(_stations(plan) / divisions, law(grid), grid)
    s, rate = law(elapsed), law.deriv()(elapsed) * divisions / duration
    total, scale = _momentum(plan, bodies, s * divisions)
    wheels = plan.wheel_momentum(duration, elapsed * duration)
    rotated = np.einsum("nij,nj->ni", base_turns(plan.at(s)), wheels.vectors)
    sums = [stored + rate[:, None] * total for stored in (rotated, wheels.world)]
    return _relative(np.concatenate(sums), rate * scale)


def _stations(plan: PlanData) -> Array:
    """Path positions in edges at which the momentum is computed; differences stay on an edge."""
    stations: Array = np.arange(plan.edges)[:, None] + np.array(_STATIONS)
    return stations.ravel()


def _relative(vectors: Array, scale: Array) -> float:
    """Largest norm of vectors (n, 3), relative to the largest scale (k,)."""
    largest = float(scale.max())
    return float(np.linalg.norm(vectors, axis=1).max()) / largest if largest > 0.0 else 0.0


def _momentum(plan: PlanData, bodies: Bodies, stations: Array) -> tuple[Array, Array]:
    """Sum of m (r - c) x (v - v_c) + I w over bodies (n, 3), and of the terms' sizes (n,).

    World axes, at `stations` (n,) counted in edges [kg m^2 rad per edge]. Places are counted from
    the base origin: the motion of that point does not change momenta about the centre of mass.
    """
    divisions = plan.edges
    spacing = _SPACING * min(1.0, divisions / _MANY_EDGES)
    fastest = float(np.max(np.abs(np.diff(plan.motion.joint_values, axis=0)), initial=0.0))
    spacing = min(spacing, _LARGEST_STEP / max(fastest, _LARGEST_STEP))
    steps = np.arange(-4, 5) * spacing
    times = stations[:, None] + steps
    q = plan.at(times.ravel() / divisions)
    turns, poses = base_turns(q), base_frame_poses(plan, bodies, q)
    masses, points, velocities, spins, scale = [], [], [], [], np.zeros(len(stations))
    for link, inertial in bodies.inertials.items():
        frame = poses[link] @ (np.eye(4) if inertial.origin is None else inertial.origin)
        frame[:, :3] = turns @ frame[:, :3]  # world axes, from the base origin
        frame = frame.reshape(len(stations), len(steps), 4, 4)
        middle = frame[:, 4]
        velocity, angular = _rates(frame, spacing)
        inertia = middle[:, :3, :3] @ inertial.inertia @ np.swapaxes(middle[:, :3, :3], 1, 2)
        spin = np.einsum("nij,nj->ni", inertia, angular)
        masses.append(inertial.mass)
        points.append(middle[:, :3, 3])
        velocities.append(velocity)
        spins.append(spin)
        scale += np.linalg.norm(spin, axis=1)
    mass = np.array(masses)[:, None, None]
    center = np.sum(mass * points, axis=0) / mass.sum()
    drift = np.sum(mass * velocities, axis=0) / mass.sum()
    arms, relative = points - center, velocities - drift
    orbital = mass * np.cross(arms, relative)
    scale += np.sum(
        mass[:, :, 0] * np.linalg.norm(arms, axis=2) * np.linalg.norm(relative, axis=2), axis=0
    )
    total = np.sum(orbital, axis=0) + np.sum(spins, axis=0)
    # where hardly anything moves only rounding errors remain: count a slow turn of the whole
    floor = _SLOW_TURN * np.sum(mass[:, :, 0] * np.sum(arms * arms, axis=2), axis=0)
    return total, np.maximum(scale, floor)


def _rates(frame: Array, spacing: float) -> tuple[Array, Array]:
    """Velocity and angular velocity (n, 3) at the middle of nine poses (n, 9, 4, 4)."""
    velocity = np.zeros((len(frame), 3))
    angular = np.zeros((len(frame), 3))
    inverse = np.swapaxes(frame[:, 4, :3, :3], 1, 2)
    for k, weight in enumerate(_STENCIL, start=1):
        for sign in (1, -1):
            other = frame[:, 4 + sign * k]
            velocity += sign * weight * other[:, :3, 3]
            angular += sign * weight * _rotation_vector(other[:, :3, :3] @ inverse)
    return velocity / spacing, angular / spacing


def _rotation_vector(r: Array) -> Array:
    """(n, 3) rotation vectors of rotations (n, 3, 3) by less than half a turn [rad]."""
    odd = np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], 1)
    sine = 0.5 * np.linalg.norm(odd, axis=1)
    cosine = 0.5 * (np.trace(r, axis1=1, axis2=2) - 1.0)
    angle = np.arctan2(sine, cosine)
    factor = np.where(sine > 1e-12, angle / np.where(sine > 1e-12, sine, 1.0), 1.0)
    vector: Array = 0.5 * factor[:, None] * odd
    return vector

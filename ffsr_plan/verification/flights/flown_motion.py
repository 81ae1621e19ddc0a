"""The motion of a flight, integrated again from rates, forces and the conservation of momentum.

From the start on, joints are the integral of their velocities, and these of their accelerations.
The centre of mass follows from thrust / mass alone. The attitude follows from the joint velocities
and the conservation of angular momentum, by the momentum map of `verification`, or where wheels
hold the base from its angular velocity. All are compared with what the flight states.

Between two switches of the law all this is smooth, so Gauss quadrature on parts of these intervals
is precise. The attitude is integrated by the Magnus series of order 4: with the angular velocities
a and b (base axes) at the two Gauss points of a part of length h, the base turns by

    exp(h (a + b) / 2 + sqrt(3) h^2 a x b / 12).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.verification.flights.flown_flight import FlownFlight
from ffsr_plan.verification.momentum_map import MomentumMap, momentum_map
from ffsr_plan.verification.motion_samples import base_frame_poses
from ffsr_plan.verification.urdf_reading import Bodies, pose

_POINTS = np.array([0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0])  # of Gauss, on [0, 1]
_FEWEST_PARTS = 2000  # of a flight
_LARGEST_STEP = 0.005  # [rad or m] of a joint on a part


class MotionErrors(NamedTuple):
    """Largest differences between a flight and its integration.

    Attributes:
        position: of the base origin [m].
        attitude: of the base [rad].
        joints: of joint values [rad or m].
        rates: of joint velocities [rad/s or m/s].
    """

    position: float
    attitude: float
    joints: float
    rates: float


def motion_errors(flight: FlownFlight, bodies: Bodies) -> MotionErrors:
    """Integrate a flight again.

    Args:
        flight: the flight.
        bodies: its robot, from the URDF.
    """
    ends = _parts(flight)
    steps = np.diff(ends)
    times = ends[:-1, None] + steps[:, None] * _POINTS
    at_ends, inside = flight.at(ends), flight.at(times.ravel())
    half = 0.5 * steps[:, None]
    joints = _pairs(inside.joint_velocities).sum(axis=1) * half
    rates = _pairs(inside.joint_accelerations).sum(axis=1) * half
    return MotionErrors(
        position=_largest(
            _positions(flight, bodies, ends, at_ends, inside) - at_ends.base_position
        ),
        attitude=_attitude_error(flight, bodies, steps, at_ends, inside),
        joints=_largest(at_ends.joints - at_ends.joints[0] - _summed(joints)),
        rates=_largest(at_ends.joint_velocities - at_ends.joint_velocities[0] - _summed(rates)),
    )


def _parts(flight: FlownFlight) -> Array:
    """(P + 1,) times between the parts [s]: the switches, pulses and what lies between."""
    edges = np.unique(np.concatenate([flight.switch_times, flight.pulse_times]))
    joints = flight.at(edges).joints
    travel = np.max(np.abs(np.diff(joints, axis=0)), axis=1, initial=0.0)
    counts = np.maximum(
        np.ceil(np.diff(edges) / flight.duration * _FEWEST_PARTS),
        np.ceil(travel / _LARGEST_STEP),
    ).astype(int)
    parts = [
        np.linspace(a, b, n, endpoint=False)
        for a, b, n in zip(edges[:-1], edges[1:], np.maximum(counts, 1), strict=True)
    ]
    return np.append(np.concatenate(parts), edges[-1])


def _positions(
    flight: FlownFlight, bodies: Bodies, ends: Array, at_ends: States, inside: States
) -> Array:
    """(P + 1, 3) base origin, from the thrust on the centre of mass [m]."""
    mass = sum(float(inertial.mass) for inertial in bodies.inertials.values())
    push = _pairs(inside.thrust) / mass
    steps = np.diff(ends)[:, None]
    gained = 0.5 * steps * push.sum(axis=1)
    velocity = _summed(gained)
    for time, change in zip(flight.pulse_times, flight.pulses, strict=True):
        velocity[np.searchsorted(ends, time) :] += change
    left = 1.0 - _POINTS[:, None]
    moved = steps * velocity[:-1] + 0.5 * steps**2 * np.sum(left * push, axis=1)
    swing = np.einsum("nij,nj->ni", _turns(at_ends), _momentum(flight, bodies, at_ends).centers)
    begin = at_ends.base_position[0] + swing[0]
    return np.asarray(begin + _summed(moved) - swing)


def _attitude_error(
    flight: FlownFlight, bodies: Bodies, steps: Array, at_ends: States, inside: States
) -> float:
    """Largest angle between the flight's attitudes and the integrated ones [rad]."""
    omega = inside.angular_velocity
    if flight.problem.mode.attitude_reacts:
        reactions = _momentum(flight, bodies, inside).reactions
        omega = np.einsum("nij,nj->ni", reactions, inside.joint_velocities)
    first, second = _pairs(omega).transpose(1, 0, 2)
    h = steps[:, None]
    vectors = 0.5 * h * (first + second) + np.sqrt(3.0) / 12.0 * h**2 * np.cross(first, second)
    turns, largest = _turns(at_ends), 0.0
    reached = turns[0]
    for k, step in enumerate(_exponentials(vectors)):
        reached = reached @ step
        apart = np.linalg.norm(reached - turns[k + 1]) / np.sqrt(8.0)
        largest = max(largest, 2.0 * float(np.arcsin(min(apart, 1.0))))
    return largest


def _exponentials(vectors: Array) -> Array:
    """(N, 3, 3) rotations by vectors (N, 3) [rad]."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    hat = np.cross(vectors[:, None], -np.eye(3))
    with np.errstate(invalid="ignore", divide="ignore"):
        one = np.where(angle > 0.0, np.sin(angle) / angle, 1.0)
    two = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    return np.asarray(np.eye(3) + one * hat + two * hat @ hat)


def _momentum(flight: FlownFlight, bodies: Bodies, states: States) -> MomentumMap:
    robot = flight.problem.robot
    poses = base_frame_poses(robot, bodies, states.configurations)
    return momentum_map(bodies, robot.joint_names, poses)


def _turns(states: States) -> Array:
    """(N, 3, 3) rotations of the base."""
    q = states.configurations
    return pose(np.zeros((len(q), 3)), q[:, 3:7])[:, :3, :3]


def _pairs(values: Array) -> Array:
    """(P, 2, k) of values (2 P, k) at the Gauss points."""
    return values.reshape(len(values) // 2, 2, values.shape[1])


def _summed(steps: Array) -> Array:
    """(P + 1, k) sums of steps (P, k) from zero on."""
    return np.vstack([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)])


def _largest(errors: Array) -> float:
    return float(np.max(np.abs(errors), initial=0.0))

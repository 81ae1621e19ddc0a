"""Forces and limits of a flight at many instants, by Pinocchio's inverse dynamics.

The recursive Newton-Euler algorithm gives the wrench on the base that positions, velocities and
accelerations need. Thrust acts through the centre of mass, so what is left of its moment has to
come from wheels, or vanish without them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.verification.flights.flown_flight import FlownFlight

PER_STEP = 100
"""Instants of each step of the law at which limits are checked."""
_MOST_INSTANTS = 200_000
_MOST_FORCES = 2_000  # instants at which forces are computed again
_LEAST_FORCE = 1e-9  # [N, N m] of a peak: smaller forces are rounding


class ForceErrors(NamedTuple):
    """Largest errors of a flight's forces, relative to the largest force of the same kind.

    Attributes:
        thrust: of the force of the thrusters.
        torques: of joint torques and forces, and of the moment of the wheels; without wheels the
            moment on the base that momentum conservation leaves.
        wheel_momentum: of the momentum that wheels store; 0 without wheels.
    """

    thrust: float
    torques: float
    wheel_momentum: float


class LimitUse(NamedTuple):
    """How much of a limit a flight uses.

    Attributes:
        name: of the limit.
        share: largest value over the limit.
        time: when [s].
    """

    name: str
    share: float
    time: float


def instants(flight: FlownFlight, most: int = _MOST_INSTANTS) -> Array:
    """(N,) times inside the steps of the law [s], `PER_STEP` in each or what `most` allows."""
    ends = flight.switch_times
    each = max(2, min(PER_STEP, most // max(1, len(ends) - 1)))
    shares = (np.arange(each) + 0.5) / each
    times = ends[:-1, None] + np.diff(ends)[:, None] * shares
    return np.asarray(times.ravel())


def force_errors(flight: FlownFlight) -> ForceErrors:
    """Compute the forces of a flight again."""
    times = instants(flight, _MOST_FORCES)
    times = times[:: max(1, len(times) // _MOST_FORCES)]
    states, model = flight.at(times), flight.problem.robot.model.copy()
    model.gravity.setZero()
    data = model.createData()
    rows = [
        _needed(model, data, q, v, a)
        for q, v, a in zip(
            states.configurations, states.velocities, states.accelerations, strict=True
        )
    ]
    thrust, moment, torques, momentum = (np.array(column) for column in zip(*rows, strict=True))
    has_wheels = flight.problem.mode.has_wheels
    peak = max(_peak(states.torques), _peak(states.wheel_torque), _LEAST_FORCE)
    stored = _peak(states.wheel_momentum)
    return ForceErrors(
        thrust=_peak(thrust - states.thrust) / max(_peak(states.thrust), _LEAST_FORCE),
        torques=max(_peak(torques - states.torques), _peak(moment - states.wheel_torque)) / peak,
        wheel_momentum=_peak(momentum + states.wheel_momentum) / max(stored, _LEAST_FORCE)
        if has_wheels
        else 0.0,
    )


def _needed(
    model: pin.Model, data: pin.Data, q: Array, v: Array, a: Array
) -> tuple[Array, Array, Array, Array]:
    """Force (world axes), moment about the centre of mass (base axes), torques; momentum too."""
    forces = np.array(pin.rnea(model, data, q, v, a))
    turn = pin.Quaternion(q[3:7]).matrix()
    pin.computeCentroidalMomentum(model, data, q, v)
    center = turn.T @ (data.com[0] - q[:3])
    moment = forces[3:6] - np.cross(center, forces[:3])
    return turn @ forces[:3], moment, forces[6:], turn.T @ np.array(data.hg.angular)


def limit_uses(flight: FlownFlight) -> list[LimitUse]:
    """The largest use of each limit that the flight has."""
    times = instants(flight)
    uses = [
        LimitUse(name, float(share.max(initial=0.0)), float(times[int(np.argmax(share))]))
        for name, share in _shares(flight, times)
    ]
    return [use for use in uses if use.share > 0.0]


def _shares(flight: FlownFlight, times: Array) -> Iterator[tuple[str, Array]]:
    """Names of limits, and (N,) the largest value over the limit at each instant."""
    states, limits = flight.at(times), flight.limits
    robot, mode = flight.problem.robot, flight.problem.mode
    mass = sum(body.mass for body in list(robot.model.inertias)[1:])
    if mode.has_thrusters:
        push = states.thrust / mass + flight.pulse_accelerations(times)
        yield "base_velocity", _norms(states.base_velocity) / limits.velocity[0]
        yield "thruster_acceleration", _norms(push) / limits.acceleration[0]
        yield "thruster_jerk", _changes(states, times, states.base_acceleration) / limits.jerk[0]
    if mode.has_wheels:
        yield "turn_velocity", _norms(states.angular_velocity) / limits.velocity[1]
        yield "turn_acceleration", _norms(states.accelerations[:, 3:6]) / limits.acceleration[1]
    for name, values, most in (
        ("joint_velocity", states.joint_velocities, limits.velocity[2:]),
        ("joint_acceleration", states.joint_accelerations, limits.acceleration[2:]),
        ("joint_torque", states.torques, limits.torque),
    ):
        yield name, np.max(np.abs(values) / most, axis=1, initial=0.0)
    low, high = robot.lower, robot.upper
    beyond = np.maximum(states.joints - high, low - states.joints)
    yield "joint limits", np.where(np.max(beyond, axis=1, initial=-1.0) > 1e-9, np.inf, 0.0)


def _changes(states: States, times: Array, values: Array) -> Array:
    """(N,) rates of change of values (N, 3) between instants of one step; 0 at its last one."""
    rates = np.zeros(len(times))
    rates[:-1] = _norms(np.diff(values, axis=0)) / np.diff(times)
    return rates


def _norms(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _peak(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))

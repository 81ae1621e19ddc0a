"""`UsedLimits`: a flight at a hundred instants of each piece, against its limits.

The same samples bound speeds over each piece, for the distances between samples: between two
neighbours a quantity goes beyond both by at most its largest rate times the time between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.verification.flights.flown import Flown

PER_PIECE = 100
"""Samples on each piece of the time law, from end to end."""
_INSIDE = 1e-9  # share of a piece between its ends, where values jump, and the samples beside them
_PIECES_AT_ONCE = 200
_SHORTEST = 1e-6  # share of the duration; differences over shorter pieces are rounding errors


class UsedLimits(NamedTuple):
    """A flight over its K pieces.

    Attributes:
        shares: largest share in use of each limit that there is, by name; 1 is all of it.
        beyond: by how much a joint leaves its range [rad or m].
        sizes: (K, nd) bounds on the joints' rates [rad/s or m/s].
        bends: (K, nd) bounds on the joints' accelerations [rad/s^2 or m/s^2].
        base_speeds: (K,) bound on the speed of the base origin [m/s].
        turn_speeds: (K,) bound on the angular velocity of the base [rad/s].
    """

    shares: dict[str, float]
    beyond: float
    sizes: Array
    bends: Array
    base_speeds: Array
    turn_speeds: Array


def used_limits(flight: Flown) -> UsedLimits:
    """Sample a flight.

    Args:
        flight: the flight.
    """
    ends = flight.switch_times
    within = np.linspace(_INSIDE, 1.0 - _INSIDE, PER_PIECE)
    blocks = []
    for begin in range(0, len(ends) - 1, _PIECES_AT_ONCE):
        some = ends[begin : begin + _PIECES_AT_ONCE + 1]
        blocks.append(_block(flight, some[:-1, None] + np.diff(some)[:, None] * within))
    shares = {name: max(each.shares[name] for each in blocks) for name in blocks[0].shares}
    rows = [np.concatenate(column) for column in zip(*(each[2:] for each in blocks), strict=True)]
    return UsedLimits(shares, max(each.beyond for each in blocks), *rows)


def _block(flight: Flown, times: Array) -> UsedLimits:
    """The same over some pieces, sampled at times (k, PER_PIECE) [s]."""
    states = flight.at(times.ravel())
    count, steps = len(times), np.diff(times, axis=1)

    def by_piece(values: Array) -> Array:
        return values.reshape(count, PER_PIECE, -1)

    def between(values: Array, rates: Array) -> Array:
        """(k, d) bound on |values| over each piece, by the sizes of their rates."""
        reserve = steps.max(axis=1)[:, None] * np.max(by_piece(rates), axis=1)
        return np.asarray(np.max(by_piece(values), axis=1) + reserve)

    rates, bends = np.abs(states.joint_velocities), np.abs(states.joint_accelerations)
    changes = np.abs(np.diff(by_piece(states.joint_accelerations), axis=1))
    robot, q = flight.problem.robot, robot_values(flight, states)
    beyond = np.maximum(robot.lower - q, q - robot.upper)
    return UsedLimits(
        shares=_shares(flight, states, times) | _jerk_shares(flight, states, times),
        beyond=float(np.max(beyond, initial=-np.inf)),
        sizes=between(rates, bends),
        bends=np.max(by_piece(bends), axis=1) + np.max(changes, axis=1),
        base_speeds=between(_sizes(states.base_velocity), _sizes(states.base_acceleration))[:, 0],
        turn_speeds=between(_sizes(states.angular_velocity), _sizes(states.accelerations[:, 3:6]))[
            :, 0
        ],
    )


def robot_values(flight: Flown, states: States) -> Array:
    """(N, nd) joint values of the configurations [rad or m]."""
    return flight.problem.robot.joint_values(states.configurations)


def _shares(flight: Flown, states: States, times: Array) -> dict[str, float]:
    limits, mode = flight.limits, flight.problem.mode
    found = {
        "joint_velocity": (np.abs(states.joint_velocities), limits.velocity[2:]),
        "joint_acceleration": (np.abs(states.joint_accelerations), limits.acceleration[2:]),
        "joint_torque": (np.abs(states.torques), limits.torque),
    }
    if mode.has_thrusters:
        pushes = states.thrust / flight.problem.robot.mass
        pushes = pushes + flight.pulse_accelerations(times.ravel())
        found["thruster_acceleration"] = _sizes(pushes), limits.acceleration[0]
        found["base_velocity"] = _sizes(states.base_velocity), limits.velocity[0]
    if mode.has_wheels:
        found["turn_velocity"] = _sizes(states.angular_velocity), limits.velocity[1]
        found["turn_acceleration"] = _sizes(states.accelerations[:, 3:6]), limits.acceleration[1]
    return {
        name: float(np.max(_divided(values, limit), initial=0.0))
        for name, (values, limit) in found.items()
        if np.any(np.isfinite(limit))
    }


def _divided(values: Array, limit: Array) -> Array:
    """Values by limits; what is zero may have a limit of zero."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(values == 0.0, 0.0, values / limit)


def _jerk_shares(flight: Flown, states: States, times: Array) -> dict[str, float]:
    """By differences of accelerations on each piece."""
    limits = flight.limits.jerk
    long = times[:, -1] - times[:, 0] > _SHORTEST * flight.duration
    steps = np.diff(times[long], axis=1)[..., None]
    found = {}
    for name, values, limit in (
        ("joint_jerk", states.joint_accelerations, limits[2:]),
        ("thruster_jerk", states.base_acceleration, limits[0]),
    ):
        if not np.any(np.isfinite(limit)):
            continue
        jerk = np.diff(values.reshape(*times.shape, -1)[long], axis=1) / steps
        each = np.abs(jerk) if name == "joint_jerk" else np.linalg.norm(jerk, axis=2)
        found[name] = float(np.max(each / limit, initial=0.0))
    return found


def _sizes(vectors: Array) -> Array:
    """(N, 1) norms of vectors (N, 3)."""
    return np.linalg.norm(vectors, axis=1, keepdims=True)

"""Velocities and accelerations of a flight, integrated over time, against its own motion.

A base that reacts turns by what conservation of momentum makes of the joints' rates: w = A theta',
with A from the URDF's bodies (`momentum_map`). Its attitude is the product of the turns of short
steps, each the fourth-order Magnus term B0 + B0 x B1 of the moments of w about the middle (Iserles
et al. 2000, in base axes). Other integrals are by Gauss quadrature with three points.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.flights.used_limits import UsedLimits
from ffsr_plan.verification.momentum_map import MomentumMap, momentum_map
from ffsr_plan.verification.motion_samples import base_frame_poses, base_turns
from ffsr_plan.verification.urdf_reading import Bodies

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_JOINT_STEP = 0.05  # [rad or m] of a joint over one step
_INSIDE = 1e-9  # share of a step by which its first and last instants lie inside
_KINK = 1e-8  # of the largest velocity: error of a step from which on it is halved
_HALVINGS = 14
_MOST_STEPS = 8  # times as many as without halving
_LEAST = 1e-12  # peaks below count as this much
_STILL = 1e-8  # share of the joints' rates; a base that turns more slowly turns by rounding alone


_NO_MOMENTUM = MomentumMap(np.zeros((0, 3, 0)), np.zeros(0), np.zeros((0, 3)))


class Steps(NamedTuple):
    """A flight in n short steps, none of which contains a jump.

    Attributes:
        lengths: (n,) [s].
        nodes: (n, 3) instants of the quadrature [s].
        first: states just behind the begin of each step, (n,).
        last: states just before its end, (n,).
        inner: states at the nodes, (3 n,).
        momentum: at the nodes, (3 n,).
        ends: configurations (n + 1, nq) at the begins and at the very end.
        ends_momentum: there, (n + 1,).
    """

    lengths: Array
    nodes: Array
    first: States
    last: States
    inner: States
    momentum: MomentumMap
    ends: Array
    ends_momentum: MomentumMap

    def missed(self) -> Array:
        """(n, 6 + nd) changes of the velocities less the integrals of accelerations."""
        change = self.last.velocities - self.first.velocities
        return np.asarray(change - self.integrals(self.inner.accelerations))

    def integrals(self, rates: Array) -> Array:
        """(n, d) of rates (3 n, d) over the steps."""
        by_step = rates.reshape(len(self.lengths), 3, -1)
        return np.asarray(0.5 * self.lengths[:, None] * np.einsum("k,nkd->nd", _WEIGHTS, by_step))


class MotionErrors(NamedTuple):
    """Differences between a flight and its integrals.

    Attributes:
        attitude: of the base [rad].
        position: of the base origin [m].
        joints: of joint values [rad or m].
        velocities: of velocities from the integrals of accelerations, of jumps from pulses, and of
            the base's angular velocity from what momentum wants, relative to the peaks.
        delta_v: of the integral of |thrust| / mass, relative.
    """

    attitude: float
    position: float
    joints: float
    velocities: float
    delta_v: float


def steps_of(flight: Flown, bodies: Bodies, used: UsedLimits) -> Steps:
    """A flight in steps in which no joint moves far.

    A step over which accelerations do not add up to the change of velocity is halved: along a curve
    with a limit on jerk, the jerk jumps inside of a piece.

    Args:
        flight: the flight.
        bodies: the robot, from its URDF.
        used: bounds on its speeds.
    """
    ends = flight.switch_times
    lengths = np.diff(ends)
    ways = np.max(used.sizes, axis=1, initial=0.0) * lengths
    parts = np.maximum(np.ceil(ways / _JOINT_STEP), 1.0).astype(np.int64)
    piece = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts)
    width = (lengths / parts)[piece]
    begins, most = ends[piece] + part * width, _MOST_STEPS * len(piece)
    for _ in range(_HALVINGS):
        found = _sampled(flight, begins, width)
        apart = np.abs(found.missed())
        peaks = np.maximum(np.max(np.abs(found.inner.velocities), axis=0), _LEAST)
        kinked = np.any(apart > _KINK * np.max(peaks), axis=1)
        if not np.any(kinked) or len(begins) + np.sum(kinked) > most:
            break
        count = 1 + kinked.astype(np.int64)
        second = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        width = np.repeat(width / count, count)
        begins = np.repeat(begins, count) + second * width
    poses = [
        momentum_map(bodies, flight.problem.robot.joint_names, base_frame_poses(flight, bodies, q))
        for q in (found.inner.configurations, found.ends)
    ]
    return found._replace(momentum=poses[0], ends_momentum=poses[1])


def _sampled(flight: Flown, begins: Array, width: Array) -> Steps:
    """Steps that begin at times (n,) and take (n,) seconds, without momentum."""

    def states(shares: Array) -> tuple[Array, States]:
        times = begins[:, None] + width[:, None] * shares
        return times, flight.at(np.clip(times.ravel(), 0.0, flight.duration))

    nodes, inner = states(0.5 * (1.0 + _POINTS * (1.0 - 2.0 * _INSIDE)))
    first, last = states(np.array([_INSIDE]))[1], states(np.array([1.0 - _INSIDE]))[1]
    q = np.vstack([first.configurations, last.configurations[-1:]])
    return Steps(width, nodes, first, last, inner, _NO_MOMENTUM, q, _NO_MOMENTUM)


def motion_errors(flight: Flown, steps: Steps) -> MotionErrors:
    """Integrate a flight and compare.

    Args:
        flight: the flight.
        steps: its steps.
    """
    mode, first, last, inner = flight.problem.mode, steps.first, steps.last, steps.inner
    joints = _gathered(last.joints - first.joints - steps.integrals(inner.joint_velocities))
    joints = max(joints, _other_joints(flight, inner))
    spins = inner.angular_velocity
    if mode.attitude_reacts:
        spins = np.einsum("nij,nj->ni", steps.momentum.reactions, inner.joint_velocities)
    chained = _chained(base_turns(first.configurations[:1])[0], steps, spins)
    turns = base_turns(steps.ends)
    if mode.floats:
        arms = np.einsum("nij,nj->ni", chained, steps.ends_momentum.centers)
        centers = steps.ends[:, :3] + arms
        position = float(np.max(np.linalg.norm(centers - centers[0], axis=1)))
    else:
        moved = last.base_position - first.base_position
        position = _gathered(moved - steps.integrals(inner.base_velocity))
    return MotionErrors(
        attitude=_largest_angle(turns, chained),
        position=position,
        joints=joints,
        velocities=max(
            _velocity_error(flight, steps),
            _relative(spins - inner.angular_velocity, spins, _least_turn(inner)),
        ),
        delta_v=_delta_v_error(flight, steps),
    )


def _other_joints(flight: Flown, states: States) -> float:
    """Largest difference of `joints` and those of `configurations`, turns of 2 pi apart."""
    robot = flight.problem.robot
    apart = robot.joint_values(states.configurations) - states.joints
    wraps = np.isinf(robot.upper)
    apart = np.where(wraps, (apart + np.pi) % (2.0 * np.pi) - np.pi, apart)
    return float(np.max(np.abs(apart), initial=0.0))


def _velocity_error(flight: Flown, steps: Steps) -> float:
    """Of velocities from the integrals of accelerations, and of their jumps, relative."""
    first, last = steps.first, steps.last
    summed = np.cumsum(steps.missed(), axis=0)
    parts = np.split(np.arange(summed.shape[1]), [3, 6])
    leasts = _LEAST, _least_turn(steps.inner), _LEAST
    errors = [
        _relative(summed[:, part], steps.inner.velocities[:, part], least)
        for part, least in zip(parts, leasts, strict=True)
    ]
    jumps = first.base_velocity[1:] - last.base_velocity[:-1]
    begins = steps.nodes[1:, 0]
    ahead = np.searchsorted(flight.pulse_times, begins)
    known = np.vstack([np.zeros(3), np.cumsum(flight.pulses, axis=0)])[ahead]
    before = np.searchsorted(flight.pulse_times, steps.nodes[:-1, -1])
    known = known - np.vstack([np.zeros(3), np.cumsum(flight.pulses, axis=0)])[before]
    joints = first.joint_velocities[1:] - last.joint_velocities[:-1]
    errors.append(_relative(jumps - known, steps.inner.base_velocity))
    errors.append(_relative(joints, steps.inner.joint_velocities))
    return max(errors)


def _delta_v_error(flight: Flown, steps: Steps) -> float:
    if flight.problem.mode.floats:
        return abs(flight.delta_v)
    push = steps.inner.thrust / flight.problem.robot.mass
    push = push + flight.pulse_accelerations(steps.nodes.ravel())
    total = float(steps.integrals(np.linalg.norm(push, axis=1)[:, None]).sum())
    return abs(total - flight.delta_v) / max(total, _LEAST)


def _chained(start: Array, steps: Steps, spins: Array) -> Array:
    """(n + 1, 3, 3) attitudes at the ends of the steps, by angular velocities (3 n, 3)."""
    about = np.tile(_POINTS / 2.0, len(steps.lengths))[:, None]
    whole, moment = steps.integrals(spins), steps.integrals(about * spins)
    turns = _rotations(whole + np.cross(whole, moment))
    found = np.empty((len(turns) + 1, 3, 3))
    found[0] = start
    for k, turn in enumerate(turns):
        found[k + 1] = found[k] @ turn
    return found


def _rotations(vectors: Array) -> Array:
    """(n, 3, 3) rotations by vectors (n, 3) [rad], by Rodrigues' formula."""
    angle = np.linalg.norm(vectors, axis=1)[:, None, None]
    skew = np.zeros((len(vectors), 3, 3))
    x, y, z = vectors.T
    skew[:, 0, 1], skew[:, 0, 2], skew[:, 1, 2] = -z, y, -x
    skew -= np.swapaxes(skew, 1, 2)
    half = np.sinc(angle / (2.0 * np.pi))
    turned: Array = np.eye(3) + np.sinc(angle / np.pi) * skew + 0.5 * half**2 * (skew @ skew)
    return turned


def _largest_angle(a: Array, b: Array) -> float:
    """Largest angle [rad] between rotations (n, 3, 3)."""
    chord = np.linalg.norm(a - b, axis=(1, 2)) / np.sqrt(8.0)
    return float(2.0 * np.max(np.arcsin(np.minimum(chord, 1.0))))


def _gathered(apart: Array) -> float:
    """Largest of the sums of errors (n, d) from the begin on."""
    return float(np.max(np.abs(np.cumsum(apart, axis=0)), initial=0.0))


def _least_turn(states: States) -> float:
    """Angular velocity of the base that counts as none [rad/s]."""
    return max(_LEAST, _STILL * float(np.max(np.abs(states.joint_velocities), initial=0.0)))


def _relative(errors: Array, values: Array, least: float = _LEAST) -> float:
    """Largest error, relative to the largest value; values below `least` count as this much."""
    peak = max(float(np.max(np.abs(values), initial=0.0)), least)
    return float(np.max(np.abs(errors), initial=0.0)) / peak

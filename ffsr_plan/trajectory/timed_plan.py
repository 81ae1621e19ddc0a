"""`TimedPlan`: a plan with a time law, and the forces needed to fly it.

The law changes only when the robot is where, so proofs of the path remain valid. It is the fastest
along every straight run under the limits on velocity, acceleration and jerk. Thrust and torques
depend on the configuration too. If they exceed their limits, the motion between two rests is slowed
down uniformly by the square root of the excess, because in free flight all forces are proportional
to the square of the pace.

Pulses at corners of the base's path are modelled as instantaneous. A finite pulse displaces the
whole robot but does not rotate it, because thrust through the centre of mass carries no angular
momentum. No point is displaced farther than the base, so a displacement below the proven clearance
causes no collision.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.inverse_dynamics import States, states
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.trajectory.csv_tables import BYTES_PER_CELL, trajectory_table, write_csv
from ffsr_plan.trajectory.flight_limits import FlightLimits, check_limits
from ffsr_plan.trajectory.straight_runs import StraightRuns, straight_runs
from ffsr_plan.trajectory.time_law import TimeLaw, time_law

_NODES = 16  # of Gauss-Lobatto quadrature, which includes both ends of a piece
_LARGEST_JOINT_STEP = 0.2  # [rad or m] between two sets of quadrature nodes
_FORCE_MARGIN = 1e-3  # relative margin of forces for peaks between the nodes
_MOST_ROWS = 1_000_000


@dataclass(frozen=True, eq=False)
class TimedPlan:
    """A plan flown from rest to rest as fast as the limits allow; made by `Plan.timed`.

    Attributes:
        motion: the path of the plan.
        delta_v: velocity change that the thrusters produce in translation: the integral of
            |thrust| / mass plus the pulses [m/s].
        rests: (k,) times at which the robot rests on the path, without start and goal [s].
        pulse_times: (p,) times of the thrusters' pulses [s].
        pulses: (p, 3) changes of the base's velocity by them, world axes [m/s].
        corner_cut: largest displacement of the robot from its path by pulses of finite duration
            [m]: one of size d lasts d / a, with the limit a on thrust / mass, and cuts its corner
            by d^2 / 8a. It is less than the clearance proven along the whole motion.
    """

    motion: Motion
    delta_v: float
    rests: Array
    pulse_times: Array
    pulses: Array
    corner_cut: float
    _law: TimeLaw = field(repr=False)
    _runs: StraightRuns = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"TimedPlan({self.duration:.4g} s, {len(self.rests)} rests, "
            f"{len(self.pulses)} pulses, delta-v {self.delta_v:.4g} m/s)"
        )

    @property
    def duration(self) -> float:
        """Duration of the flight [s]."""
        return self._law.duration

    @property
    def switch_times(self) -> Array:
        """(K + 1,) times between which acceleration and jerk do not jump [s]."""
        return self._law.times

    def at(self, times: ArrayLike) -> States:
        """Configurations, velocities, accelerations, thrust and torques.

        Where the acceleration jumps, the value after the jump is returned. Pulses are not part of
        the accelerations and of the thrust.

        Args:
            times: (N,) times [s].

        Returns:
            The states at these times.

        Raises:
            InvalidInput: no times, or times outside [0, duration].
        """
        instants = finite_array("times", times, (-1,))
        if instants.size == 0 or np.any((instants < 0.0) | (instants > self.duration)):
            allowed = f"at least one time, all from 0 to {self.duration!r} s"
            raise InvalidInput("times", times, allowed)
        return _states(self.motion, self._runs, self._law, self._law.piece(instants), instants)

    def clock(self, rate: float) -> Array:
        """Equally spaced times 0, 1 / rate, 2 / rate, ..., and the end.

        Args:
            rate: number of times per second [1/s].

        Returns:
            (N,) times [s].

        Raises:
            InvalidInput: a rate that is not positive, or more than a million times.
        """
        rate = number("rate", rate, above=0.0, at_most=_MOST_ROWS / self.duration)
        count = int(np.ceil(self.duration * rate * (1.0 - 1e-12)))
        return np.append(np.arange(count) / rate, self.duration)

    def to_csv(self, path: str | Path, rate: float) -> None:
        """Write the trajectory as a table with one row for each time and units in the header.

        The columns are time, path parameter, base pose, base velocity and acceleration (linear in
        world axes, angular in base axes), joints, thrust, wheels and torques. An existing file is
        replaced.

        Args:
            path: of the file.
            rate: rows per second [1/s]; the last row is the end.

        Raises:
            InvalidInput: a file that cannot be written, or a rate that is not possible.
        """
        target, times = checked_path("path", path), self.clock(rate)
        size = {"rows": len(times), "columns": 30 + 5 * self.motion.robot.nd}
        check_memory("rate", size, BYTES_PER_CELL, "a lower rate")
        write_csv(target, trajectory_table(self.motion.robot, times, self.at(times)))


def timed(motion: Motion, limits: FlightLimits, clearance: float) -> TimedPlan:
    """The fastest flight along a motion from rest to rest; see `Plan.timed`.

    Args:
        motion: the path.
        limits: the limits; checked here is only whether the motion needs others.
        clearance: clearance proven along the whole motion [m].

    Raises:
        InvalidInput: a missing limit, a motion without motion, or pulses whose corner cut exceeds
            the clearance.
    """
    runs = straight_runs(motion)
    if not len(runs.first):
        raise InvalidInput("plan", "one in which nothing moves", "a plan in which something moves")
    check_limits(limits, runs, motion.robot, motion.mode.floats)
    law, speeds = time_law(runs, limits.along(runs), limits.velocity_jump)
    leg = np.cumsum(speeds[:-1] == 0.0) - 1  # of each run: the leg between two rests it is part of
    push, excess = _efforts(motion, runs, law, limits)
    worst = np.zeros(leg[-1] + 1)
    np.maximum.at(worst, leg[law.run], excess)
    factors = np.where(worst > 1.0, np.sqrt(worst / (1.0 - _FORCE_MARGIN)), 1.0)[leg]
    slowed = law.slowed(factors[law.run])
    passed = speeds[1:-1] > 0.0
    pulses = _pulses(runs, speeds, factors)
    sizes = np.linalg.norm(pulses, axis=1)
    ends = slowed.times[np.searchsorted(law.run, np.arange(1, len(runs.first)))]
    cut = _corner_cut(ends[passed], sizes, limits.acceleration[0])
    _check_corner_cut(cut, sizes, limits, clearance)
    return TimedPlan(
        motion=motion,
        delta_v=float(np.sum(push / factors[law.run]) + np.sum(sizes)),
        rests=frozen(ends[~passed]),
        pulse_times=frozen(ends[passed]),
        pulses=frozen(pulses),
        corner_cut=cut,
        _law=slowed,
        _runs=runs,
    )


def _pulses(runs: StraightRuns, speeds: Array, factors: Array) -> Array:
    """(p, 3) changes of the base's velocity at corners that are passed without a rest [m/s].

    Args:
        runs: r straight runs.
        speeds: (r + 1,) x' between them.
        factors: (r,) factors by which the runs are slowed down.
    """
    passed = np.flatnonzero(speeds[1:-1] > 0.0)
    if not len(passed):
        return np.zeros((0, 3))
    return runs.jumps()[passed] * (speeds[1:-1] / factors[1:])[passed, None]


def _check_corner_cut(cut: float, sizes: Array, limits: FlightLimits, clearance: float) -> None:
    """Raise `InvalidInput` if pulses (p,) [m/s] cut corners by more than the clearance."""
    if not len(sizes) or cut < clearance:
        return
    available = max(clearance, 0.0)
    possible = 0.99 * np.max(sizes) * np.sqrt(available / cut)
    allowed = (
        f"about {possible:.2g} m/s or less: thrusters of {limits.acceleration[0]:g} m/s^2 would "
        f"cut a corner by {cut:.3g} m, and the proven clearance is {available:.3g} m"
    )
    raise InvalidInput("velocity_jump", limits.velocity_jump, allowed)


def _corner_cut(times: Array, sizes: Array, strength: float) -> float:
    """Largest displacement from the path by pulses (p,) [m/s] at times (p,) [s] [m].

    A pulse of size d has constant thrust for d / a and displaces the robot by a / 2 (d / 2a -
    |t|)^2. The sum over all pulses is largest at the time of one of them.
    """
    if not len(times):
        return 0.0
    left = sizes / (2.0 * strength) - np.abs(times[:, None] - times)
    return float(np.max(np.sum(np.maximum(left, 0.0) ** 2, axis=1)) * strength / 2.0)


def _states(
    motion: Motion, runs: StraightRuns, law: TimeLaw, piece: IntArray, times: Array
) -> States:
    x, speed, acceleration = law.on(piece, times)
    edge, time, scale = runs.locate(law.run[piece], x)
    return states(motion, edge, time, speed / scale, acceleration / scale)


def _efforts(
    motion: Motion, runs: StraightRuns, law: TimeLaw, limits: FlightLimits
) -> tuple[Array, Array]:
    """Thrust and force shares of each piece of the law.

    Returns:
        (K,) integral of |thrust| / mass [m/s], and (K,) largest ratio of a force to its limit.
    """
    lengths = np.diff(law.times)
    joint_steps = np.max(np.abs(runs.joints), axis=1, initial=0.0)[law.run] * _lengths(law)
    parts = np.maximum(np.ceil(joint_steps / _LARGEST_JOINT_STEP), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    width = (lengths / parts)[owner]
    nodes, weights = _lobatto()
    times = law.times[owner][:, None] + width[:, None] * (part[:, None] + nodes)
    at_nodes = _states(motion, runs, law, np.repeat(owner, _NODES), times.ravel())
    mass = sum(body.mass for body in list(motion.robot.model.inertias)[1:])
    push = np.linalg.norm(at_nodes.thrust, axis=1) / mass
    share = push / limits.acceleration[0]
    if motion.robot.nd:
        share = np.maximum(share, np.max(np.abs(at_nodes.torques) / limits.torque, axis=1))
    sums, most = np.zeros(len(parts)), np.zeros(len(parts))
    np.add.at(sums, owner, width * (push.reshape(-1, _NODES) @ weights))
    np.maximum.at(most, owner, np.max(share.reshape(-1, _NODES), axis=1))
    return sums, most


def _lengths(law: TimeLaw) -> Array:
    """(K,) length of each piece in x."""
    pieces = np.arange(len(law.run))
    return law.on(pieces, law.times[1:])[0] - law.begin[:, 0]


def _lobatto() -> tuple[Array, Array]:
    """Nodes and weights of Gauss-Lobatto quadrature on [0, 1], which includes both ends."""
    polynomial = legendre.Legendre.basis(_NODES - 1)
    inner = np.real(polynomial.deriv().roots())
    nodes = np.concatenate([[-1.0], inner, [1.0]])
    weights = 2.0 / (_NODES * (_NODES - 1) * polynomial(nodes) ** 2)
    return (nodes + 1.0) / 2.0, weights / 2.0

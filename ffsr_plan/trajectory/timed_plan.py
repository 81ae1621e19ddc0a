"""`TimedPlan`: a plan with a time law, and what it takes to fly it.

The law changes when the robot is where, never where it goes: what was proven of the path holds. It
is the fastest along every straight run under the limits on velocity, acceleration and jerk. Thrust
and torques depend on the way as well; where they come out too large, everything between two rests
is slowed down evenly, by the square root of the excess, since in free flight all forces go as the
square of the pace.

A pulse at a corner of the base's path is thought of as short. Drawn out, it takes the whole robot
off its path, but turns nothing, since thrust through the centre of mass carries no angular
momentum: no point goes farther astray than the base does, so that a cut below the proven clearance
touches nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.inverse_dynamics import States, states
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.trajectory.csv_tables import trajectory_table, write_csv
from ffsr_plan.trajectory.limits import Limits, check_limits
from ffsr_plan.trajectory.straight_runs import StraightRuns, straight_runs
from ffsr_plan.trajectory.time_law import TimeLaw, time_law

_NODES = 16  # of Gauss-Lobatto quadrature, which looks at both ends of a piece
_STRETCH = 0.2  # [rad or m] that a joint moves between two sets of nodes, at most
_ROOM = 1e-3  # of forces, for peaks between the nodes
_MOST_ROWS = 1_000_000


@dataclass(frozen=True, eq=False)
class TimedPlan:
    """A plan flown from rest to rest as fast as limits allow; made by `Plan.timed`.

    Attributes:
        motion: the path, unchanged.
        delta_v: of the translation: what the thrusters change the velocity of the centre of mass
            by, the integral of |thrust| / mass plus the pulses [m/s].
        rests: (k,) times at which the robot rests on the way, start and goal not counted [s].
        pulse_times: (p,) times at which thrusters turn the base's velocity at once [s].
        pulses: (p, 3) what they change it by, world axes [m/s].
        corner_cut: how far off its path pulses take the whole robot, at most [m], if they are drawn
            out: one of size d lasts d / a, a the limit on thrust / mass, and cuts its corner by
            d^2 / 8a. Less than the clearance proven along the whole motion.
    """

    motion: Motion
    delta_v: float
    rests: Array
    pulse_times: Array
    pulses: Array
    corner_cut: float
    _law: TimeLaw = field(repr=False)
    _runs: StraightRuns = field(repr=False)

    @property
    def duration(self) -> float:
        """[s]."""
        return self._law.duration

    def at(self, times: ArrayLike) -> States:
        """Configurations, velocities, accelerations, thrust and torques at times (N,) [s].

        Where the acceleration jumps, it is the one that follows; pulses are in none of them.

        Raises:
            InvalidInput: no times, or times outside [0, duration].
        """
        clock = finite_array("times", times, (-1,))
        if clock.size == 0 or np.any((clock < 0.0) | (clock > self.duration)):
            allowed = f"at least one time, all from 0 to {self.duration!r} s"
            raise InvalidInput("times", times, allowed)
        return _states(self.motion, self._runs, self._law, self._law.piece(clock), clock)

    def clock(self, rate: float) -> Array:
        """(N,) times 0, 1 / rate, 2 / rate, .. and the duration [s].

        Args:
            rate: instants a second [1/s].

        Raises:
            InvalidInput: not above zero, or more than a million instants.
        """
        rate = number("rate", rate, above=0.0, at_most=_MOST_ROWS / self.duration)
        count = int(np.ceil(self.duration * rate * (1.0 - 1e-12)))
        return np.append(np.arange(count) / rate, self.duration)

    def to_csv(self, path: str | Path, rate: float) -> None:
        """Write the trajectory as a table, one instant a row, units in the header.

        Time, path parameter, base pose, its velocity and acceleration (of the origin in world axes,
        angular in base axes), joints, thrust, wheels, torques. A file that is there is replaced.

        Args:
            path: of the file.
            rate: rows a second [1/s]; the last row is the end.

        Raises:
            InvalidInput: a file that cannot be written, or a rate that cannot be.
        """
        times = self.clock(rate)
        write_csv(Path(path), trajectory_table(self.motion.robot, times, self.at(times)))


def timed(motion: Motion, limits: Limits, clearance: float) -> TimedPlan:
    """See `Plan.timed`.

    Args:
        motion: the path.
        limits: checked but for what the motion needs of them.
        clearance: proven along the whole motion [m].

    Raises:
        InvalidInput: a missing limit, a motion along which nothing moves, or pulses that the
            clearance has no room for.
    """
    runs, robot = straight_runs(motion), motion.robot
    if not len(runs.first):
        raise InvalidInput("plan", "one in which nothing moves", "a plan that leads somewhere")
    check_limits(limits, runs, robot, motion.mode.floats)
    law, speeds = time_law(runs, limits.along(runs), limits.velocity_jump)
    leg = np.cumsum(speeds[:-1] == 0.0) - 1  # of each run: between which two rests it lies
    push, excess = _efforts(motion, runs, law, limits)
    worst = np.zeros(leg[-1] + 1)
    np.maximum.at(worst, leg[law.run], excess)
    factors = np.where(worst > 1.0, np.sqrt(worst / (1.0 - _ROOM)), 1.0)[leg]
    slowed = law.slowed(factors[law.run])
    jumped = np.flatnonzero(speeds[1:-1] > 0.0)
    pulses = np.zeros((len(jumped), 3))
    if len(jumped):
        pulses = runs.jumps()[jumped] * (speeds[1:-1] / factors[1:])[jumped, None]
    sizes = np.linalg.norm(pulses, axis=1)
    ends = slowed.times[np.searchsorted(law.run, np.arange(1, len(runs.first)))]
    resting = speeds[1:-1] == 0.0
    cut = _corner_cut(ends[~resting], sizes, limits.acceleration[0])
    if len(jumped) and cut >= clearance:
        room = max(clearance, 0.0)
        raise InvalidInput(
            "velocity_jump", limits.velocity_jump,
            f"about {0.99 * np.max(sizes) * np.sqrt(room / cut):.2g} m/s or less: thrusters of "
            f"{limits.acceleration[0]:g} m/s^2 would cut a corner by {cut:.3g} m, and no more "
            f"than {room:.3g} m are proven clear",
        )  # fmt: skip
    return TimedPlan(
        motion,
        float(np.sum(push / factors[law.run]) + np.sum(sizes)),
        frozen(ends[resting]),
        frozen(ends[~resting]),
        frozen(pulses),
        cut,
        slowed,
        runs,
    )


def _corner_cut(times: Array, sizes: Array, strength: float) -> float:
    """How far pulses (p,) [m/s] at times (p,) [s], each drawn out evenly, lead off the path [m].

    One of size d lasts d / a and is a / 2 (d / 2a - |t|)^2 off the path while it lasts; several sum
    up to most at the time of one of them.
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
    motion: Motion, runs: StraightRuns, law: TimeLaw, limits: Limits
) -> tuple[Array, Array]:
    """(K,) by piece: integral of |thrust| / mass [m/s], and the largest share of a limit on forces.

    A share above one is an excess.
    """
    lengths = np.diff(law.times)
    travel = np.max(np.abs(runs.joints), axis=1, initial=0.0)[law.run] * _way(law)
    parts = np.maximum(np.ceil(travel / _STRETCH), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    width = (lengths / parts)[owner]
    nodes, weights = _lobatto()
    times = law.times[owner][:, None] + width[:, None] * (part[:, None] + nodes)
    found = _states(motion, runs, law, np.repeat(owner, _NODES), times.ravel())
    mass = sum(body.mass for body in list(motion.robot.model.inertias)[1:])
    push = np.linalg.norm(found.thrust, axis=1) / mass
    share = push / limits.acceleration[0]
    if motion.robot.nd:
        share = np.maximum(share, np.max(np.abs(found.torques) / limits.torque, axis=1))
    sums, most = np.zeros(len(parts)), np.zeros(len(parts))
    np.add.at(sums, owner, width * (push.reshape(-1, _NODES) @ weights))
    np.maximum.at(most, owner, np.max(share.reshape(-1, _NODES), axis=1))
    return sums, most


def _way(law: TimeLaw) -> Array:
    """(K,) of x on each piece."""
    pieces = np.arange(len(law.run))
    return np.asarray(law.on(pieces, law.times[1:])[0] - law.begin[:, 0])


def _lobatto() -> tuple[Array, Array]:
    """Nodes and weights of Gauss-Lobatto quadrature on [0, 1], both ends among the nodes."""
    polynomial = legendre.Legendre.basis(_NODES - 1)
    inner = np.real(polynomial.deriv().roots())
    nodes = np.concatenate([[-1.0], inner, [1.0]])
    weights = 2.0 / (_NODES * (_NODES - 1) * polynomial(nodes) ** 2)
    return (nodes + 1.0) / 2.0, weights / 2.0

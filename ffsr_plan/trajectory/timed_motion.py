"""`TimedMotion`: a motion of straight edges with a time law, and the forces needed to fly it.

The law changes only when the robot is where, so proofs of the path remain valid. It is the fastest
along every straight run under the limits on velocity, acceleration and jerk. Thrust and torques
depend on the configuration too. If they exceed their limits, the motion between two rests is slowed
down uniformly by the square root of the excess, because in free flight all forces are proportional
to the square of the pace.

Thrusters change the velocity of the base at a corner of its path by a pulse of constant thrust,
half of it before and half of it after the corner. Pulses count against the limit on thrust: the
pace is constant meanwhile and pulses do not overlap (`time_law`), and thrust and torques that arms
in motion need are added to those of the pulse. A pulse displaces the whole robot from its path but
does not rotate it, because thrust through the centre of mass carries no angular momentum. No point
is displaced farther than the base, so a displacement below the proven clearance causes no
collision.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.inverse_dynamics import States, states
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.flight import Flight
from ffsr_plan.trajectory.flight_limits import FlightLimits, check_limits
from ffsr_plan.trajectory.straight_runs import StraightRuns, straight_runs
from ffsr_plan.trajectory.time_law import PulseLimits, TimeLaw, time_law
from ffsr_plan.trajectory.timetables import LawTimes

if TYPE_CHECKING:
    from typing_extensions import Self

_NODES = 16  # of Gauss-Lobatto quadrature, which includes both ends of a piece
_LARGEST_JOINT_STEP = 0.2  # [rad or m] between two sets of quadrature nodes
_FORCE_MARGIN = 1e-3  # relative margin of forces for peaks between the nodes
_SAME_FORCE = 1e-9  # relative change over a piece below which a force counts as constant


@dataclass(frozen=True, eq=False)
class TimedMotion(Flight):
    """A motion flown as fast as limits allow; see `TimedPlan` of `ffsr_plan.planning`.

    It rests at corners of the path, or passes them with pulses of the thrusters, at the highest
    speed at which no pulse changes the velocity of the base by more than allowed. Pulses count
    against the limit on thrust: one of size d takes the time d / thruster_acceleration or longer,
    does not overlap another, and the pace is constant meanwhile.

    Attributes:
        motion: the path of the plan.
        delta_v: velocity change that the thrusters produce in translation: the integral of
            |thrust| / mass, pulses included [m/s].
        rests: (k,) times at which the robot rests on the path, without start and goal [s].
        pulse_times: (p,) times of the corners that pulses pass, in the middle of each pulse [s].
        pulse_durations: (p,) durations of the pulses [s].
        pulses: (p, 3) changes of the base's velocity by them, world axes [m/s]; the acceleration
            during a pulse is constant.
        corner_cut: largest displacement of the robot from its path by pulses [m]: one of size d and
            duration t cuts its corner by d t / 8. It is less than the clearance proven along the
            whole motion.
    """

    motion: Motion
    delta_v: float
    rests: Array
    pulse_times: Array
    pulse_durations: Array
    pulses: Array
    corner_cut: float
    _law: TimeLaw = field(repr=False)
    _runs: StraightRuns = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({self.duration:.4g} s, {len(self.rests)} rests, "
            f"{len(self.pulses)} pulses, delta-v {self.delta_v:.4g} m/s)"
        )

    @property
    def robot(self) -> SpaceRobot:
        """The robot."""
        return self.motion.robot

    @property
    def mode(self) -> Mode:
        """What actuates the base."""
        return self.motion.mode

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

        Where the acceleration jumps, the value after the jump is returned. The states are those on
        the path: pulses are not part of velocities, accelerations, thrust and torques, and the base
        velocity jumps at `pulse_times`.

        Args:
            times: (N,) times [s].

        Returns:
            The states at these times.

        Raises:
            InvalidInput: no times, or times outside [0, duration].
        """
        instants = self._instants(times)
        return _states(self.motion, self._runs, self._law, self._law.piece(instants), instants)

    @property
    def timetable(self) -> LawTimes:
        """The times at the places of its path, without waits."""
        return LawTimes(self._law.times, self._law.begin, self._runs.corners)

    def slowed(self, factor: float) -> Self:
        """The same flight with all durations multiplied by a factor of at least one.

        Pulses cut corners by as much, and no limit is exceeded: in free flight all forces are
        proportional to the square of the pace.
        """
        return replace(
            self,
            delta_v=self.delta_v / factor,
            rests=frozen(self.rests * factor),
            pulse_times=frozen(self.pulse_times * factor),
            pulse_durations=frozen(self.pulse_durations * factor),
            pulses=frozen(self.pulses / factor),
            _law=self._law.slowed(np.full(len(self._law.run), factor)),
        )

    def after(self, wait: float) -> Self:
        """The same flight after a wait at the start [s]."""
        if wait == 0.0:
            return self
        rests, pulse_times = frozen(self.rests + wait), frozen(self.pulse_times + wait)
        return replace(self, rests=rests, pulse_times=pulse_times, _law=self._law.after(wait))

    def pulse_accelerations(self, times: ArrayLike) -> Array:
        """Acceleration of the base by pulses, to be added to that of `at`; zero between pulses.

        Args:
            times: (N,) times [s].

        Returns:
            (N, 3) accelerations, world axes [m/s^2]; times the robot's mass, thrust.

        Raises:
            InvalidInput: times that are not finite numbers.
        """
        instants = finite_array("times", times, (-1,))
        return _Pulses(self.pulse_times, self.pulse_durations, self.pulses).accelerations(instants)


def timed(motion: Motion, limits: FlightLimits, clearance: float) -> TimedMotion:
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
    check_limits(limits, np.max(runs.rates(), axis=0) > 0.0, motion.robot, motion.mode.floats)
    law, speeds, lasting = time_law(
        runs, limits.along(runs), PulseLimits(limits.velocity_jump, limits.acceleration[0])
    )
    leg = np.cumsum(speeds[:-1] == 0.0) - 1  # of each run: the leg between two rests it is part of
    passed = np.flatnonzero(speeds[1:-1] > 0.0)
    pulses = _Pulses(
        _corner_times(law, runs)[passed],
        lasting[1:-1][passed],
        runs.jumps()[passed] * speeds[1:-1][passed, None] if len(passed) else np.zeros((0, 3)),
    )
    pushes = pulses.accelerations((law.times[1:] + law.times[:-1]) / 2.0)
    push, excess = _efforts(motion, runs, law, limits, pushes)
    worst = np.ones(leg[-1] + 1)
    np.maximum.at(worst, leg[law.run], excess)
    factors = np.sqrt(worst)[leg]
    slowed = law.slowed(factors[law.run])
    corners, slower = _corner_times(slowed, runs), factors[1:][passed]
    cut = pulses.corner_cut()
    check_corner_cut(cut, limits, clearance)
    return TimedMotion(
        motion=motion,
        delta_v=float(np.sum(push / factors[law.run])),
        rests=frozen(np.delete(corners, passed)),
        pulse_times=frozen(corners[passed]),
        pulse_durations=frozen(pulses.durations * slower),
        pulses=frozen(pulses.jumps / slower[:, None]),
        corner_cut=cut,
        _law=slowed,
        _runs=runs,
    )


class _Pulses(NamedTuple):
    """Pulses at corners of the base's path.

    Attributes:
        times: (p,) of the corners [s].
        durations: (p,) [s].
        jumps: (p, 3) changes of the base's velocity, world axes [m/s].
    """

    times: Array
    durations: Array
    jumps: Array

    def accelerations(self, times: Array) -> Array:
        """(N, 3) acceleration of the base by pulses at times (N,) [s], world axes [m/s^2]."""
        during = np.abs(times[:, None] - self.times) < self.durations / 2.0
        return during @ (self.jumps / self.durations[:, None])

    def corner_cut(self) -> float:
        """Largest displacement from the path [m]; it does not change if the law is slowed down.

        With the constant acceleration d / t the robot is displaced by d / 2t (t / 2 - |s|)^2 at the
        time s from the corner.
        """
        sizes = np.linalg.norm(self.jumps, axis=1)
        return float(np.max(sizes * self.durations, initial=0.0)) / 8.0


def _corner_times(law: TimeLaw, runs: StraightRuns) -> Array:
    """(r - 1,) times between consecutive runs [s]."""
    return law.times[np.searchsorted(law.run, np.arange(1, len(runs.first)))]


def check_corner_cut(cut: float, limits: FlightLimits, clearance: float) -> None:
    """Raise `InvalidInput` if pulses cut corners by more than the clearance.

    Args:
        cut: largest displacement by pulses [m].
        limits: those of the flight.
        clearance: proven along its path [m].
    """
    if cut == 0.0 or cut < clearance:
        return
    strength, available = limits.acceleration[0], max(clearance, 0.0)
    possible = 0.99 * np.sqrt(8.0 * strength * available)
    allowed = (
        f"about {possible:.2g} m/s or less: thrusters of {strength:g} m/s^2 would "
        f"cut a corner by {cut:.3g} m, and the proven clearance is {available:.3g} m"
    )
    raise InvalidInput("velocity_jump", limits.velocity_jump, allowed)


def _states(
    motion: Motion,
    runs: StraightRuns,
    law: TimeLaw,
    piece: IntArray,
    times: Array,
    push: Array | None = None,
) -> States:
    x, speed, acceleration = law.on(piece, times)
    edge, time, scale = runs.locate(law.run[piece], x)
    return states(motion, edge, time, speed / scale, acceleration / scale, push)


def _efforts(
    motion: Motion, runs: StraightRuns, law: TimeLaw, limits: FlightLimits, pushes: Array
) -> tuple[Array, Array]:
    """Thrust and force shares of each piece of the law.

    Args:
        motion: the motion.
        runs: its straight runs.
        law: the law.
        limits: limits on forces.
        pushes: (K, 3) acceleration of the base by pulses on each piece, world axes [m/s^2].

    Returns:
        (K,) integral of |thrust| / mass [m/s], and (K,) largest ratio of a force to its limit, with
        a margin for peaks between the nodes.
    """
    lengths = np.diff(law.times)
    joint_steps = np.max(np.abs(runs.joints), axis=1, initial=0.0)[law.run] * _lengths(law)
    parts = np.maximum(np.ceil(joint_steps / _LARGEST_JOINT_STEP), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)
    width = (lengths / parts)[owner]
    nodes, weights = _lobatto()
    times = law.times[owner][:, None] + width[:, None] * (part[:, None] + nodes)
    piece = np.repeat(owner, _NODES)
    at_nodes = _states(motion, runs, law, piece, times.ravel(), pushes[piece])
    mass = sum(body.mass for body in list(motion.robot.model.inertias)[1:])
    push = np.linalg.norm(at_nodes.thrust, axis=1) / mass
    share = push / limits.acceleration[0]
    if motion.robot.nd:
        share = np.maximum(share, np.max(np.abs(at_nodes.torques) / limits.torque, axis=1))
    sums, most = np.zeros(len(parts)), np.zeros(len(parts))
    np.add.at(sums, owner, width * (push.reshape(-1, _NODES) @ weights))
    shares = share.reshape(-1, _NODES)
    peak = np.max(shares, axis=1)
    varies = peak - np.min(shares, axis=1) > _SAME_FORCE * peak
    np.maximum.at(most, owner, np.where(varies, peak / (1.0 - _FORCE_MARGIN), peak))
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

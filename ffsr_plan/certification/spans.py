"""A trajectory of a robot as spans of motion, each of which is proven by itself.

The base pose at the end of a span, with the bound on its error, is where the next one begins. So a
long trajectory takes no more memory than a span, and what lies behind a contact is not looked at.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.given_pieces import GivenPieces
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.trajectory import Trajectory, spline_rates

_MOST_PIECES = 256  # of a span: the tables that a proof keeps grow with their number
_SAME_ATTITUDE = 1e-14  # [rad] below which a base does not turn


class ContinuedMotion(Motion):
    """A motion whose attitude at the start is known up to an error.

    Attributes:
        carried_error: bound on that error [rad].
    """

    carried_error = 0.0

    @property
    def attitude_error(self) -> float:
        """Bound on the error of any attitude [rad]."""
        return super().attitude_error + self.carried_error


class Span(NamedTuple):
    """Some pieces of a trajectory.

    Attributes:
        first: number of its first piece.
        times: (k + 1,) at the ends of its pieces [s].
        motion: the motion, k edges.
    """

    first: int
    times: Array
    motion: Motion | CurvedMotion

    def at(self, times: Array) -> Array:
        """(N, nq) configurations at times (N,) within the span [s]."""
        places = np.interp(times, self.times, np.arange(len(self.times), dtype=np.float64))
        edge = np.minimum(places.astype(np.int64), self.motion.edges - 1)
        return self.motion.at(edge, places - edge)


class RobotTrajectory:
    """A trajectory as one robot runs it.

    Attributes:
        robot: the robot.
        mode: what actuates the base.
        trajectory: the trajectory.
        values: (N, nd) joint values, continuous ones without a jump at half a turn [rad or m].
        start: (nq,) configuration at the first time.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        mode: Mode,
        trajectory: Trajectory,
        position: Array,
        attitude: Array,
    ) -> None:
        """Match the trajectory to the robot.

        Args:
            robot: the robot.
            mode: what actuates the base.
            trajectory: the trajectory.
            position: (3,) base origin at the start where the trajectory has none [m].
            attitude: (4,) base attitude at the start where the trajectory has none (xyzw).

        Raises:
            InvalidInput: joints that the robot or the trajectory lacks, or values beyond a limit.
        """
        self.robot, self.mode, self.trajectory = robot, mode, trajectory
        _check_names(robot, trajectory)
        values = trajectory.joint_array(robot.joint_names)
        _check_limits(robot, trajectory, values)
        endless = np.isinf(robot.upper) & ~robot.prismatic
        values[:, endless] = np.unwrap(values[:, endless], axis=0)
        self.values = values
        if trajectory.base_positions is not None:
            position = trajectory.base_positions[0]
        if trajectory.base_attitudes is not None:
            attitude = trajectory.base_attitudes[0]
        self.start = robot.check_configuration(
            f"{trajectory.source}, first row", robot.assemble(position, attitude, values[0])
        )
        self._coefficients = self._pieces()

    def spans(self) -> Iterator[Span]:
        """The spans, one after another."""
        start, error, first = self.start, 0.0, 0
        for count in self._counts():
            motion = self._motion(first, count, start, error)
            yield Span(first, self.trajectory.times[first : first + count + 1], motion)
            start, error, first = motion.configurations()[-1], motion.attitude_error, first + count

    def _counts(self) -> Iterator[int]:
        """Numbers of pieces of the spans; a piece over which wheels turn the base is one itself."""
        left = self.trajectory.pieces
        attitudes = self.trajectory.base_attitudes
        if self.mode.has_wheels and attitudes is not None:
            turning = rotations.angle_between(attitudes[:-1], attitudes[1:]) > _SAME_ATTITUDE
            ends = np.flatnonzero(turning)
            cuts = np.unique(np.concatenate([[0], ends, ends + 1, [left]]))
            for length in np.diff(cuts).tolist():
                yield from _parts(length)
            return
        yield from _parts(left)

    def _motion(self, first: int, count: int, start: Array, error: float) -> Motion | CurvedMotion:
        """The motion over pieces from the first one on."""
        rows = self._coefficients[first : first + count].copy()
        attitudes, turn = self.trajectory.base_attitudes, np.zeros(3)
        if self.mode.has_wheels and attitudes is not None:
            turn = rotations.rotation_vector(attitudes[first], attitudes[first + count])
        if self.trajectory.interpolation == "cubic" or np.any(turn):
            center = centers_of_mass(self.robot, rows[:1, 0, 3:-1])
            if self.mode.floats:
                rows[:, :, :3] = start[:3] + rotations.rotate(start[None, 3:7], center)
            shares = np.linspace(0.0, 1.0, 3 * count + 1)
            rows[:, :, -1] = shares[3 * np.arange(count)[:, None] + np.arange(4)]
            return GivenPieces(self.robot, self.mode, start[3:7], rows, turn, error)
        corners = np.vstack([rows[:, 0], rows[-1:, 3]])
        positions = np.tile(start[:3], (count + 1, 1)) if self.mode.floats else corners[:, :3]
        goal = self.robot.assemble(positions[-1], start[3:7], corners[-1, 3:-1])
        motion = ContinuedMotion(self.robot, self.mode, start, goal, positions, corners[:, 3:-1])
        motion.carried_error = error
        return motion

    def _pieces(self) -> Array:
        """(m, 4, 3 + nd + 1) Bernstein coefficients of base origin and joints; the last are 0."""
        given, names = self.trajectory, self.robot.joint_names
        base = given.base_positions
        if base is None or self.mode.floats:
            base = np.tile(self.start[:3], (len(given.times), 1))
        rates = None
        if given.interpolation == "cubic" and given.velocities:
            rates = given.joint_array(names, velocities=True)
        parts = [
            _bernstein(given, base, given.base_velocities),
            _bernstein(given, self.values, rates),
        ]
        return np.concatenate([*parts, np.zeros((given.pieces, 4, 1))], axis=2)


def _bernstein(given: Trajectory, values: Array, rates: Array | None) -> Array:
    """(m, 4, k) coefficients of the pieces through values (N, k), with rates (N, k) if cubic."""
    steps = np.diff(given.times)[:, None]
    if given.interpolation == "linear":
        change = np.diff(values, axis=0) / 3.0
        inner = values[:-1] + change, values[1:] - change
    else:
        if rates is None:
            rates = spline_rates(given.times, values)
        inner = values[:-1] + steps * rates[:-1] / 3.0, values[1:] - steps * rates[1:] / 3.0
    return np.stack([values[:-1], *inner, values[1:]], axis=1)


def _parts(length: int) -> list[int]:
    whole, rest = divmod(length, _MOST_PIECES)
    return [_MOST_PIECES] * whole + [rest] * (rest > 0)


def _check_names(robot: SpaceRobot, trajectory: Trajectory) -> None:
    """Raise `InvalidInput` for joints that only one of both has."""
    known, given = set(robot.joint_names), set(trajectory.joints)
    lacking = [name for name in robot.joint_names if name not in given]
    unknown = [name for name in trajectory.joints if name not in known]
    if unknown:
        what, names = f"{trajectory.source}, unknown joints", ", ".join(robot.joint_names)
        allowed = f"joints of the robot: {names or 'it has none'}"
        raise InvalidInput(what, ", ".join(unknown), allowed)
    if lacking:
        allowed = "values of all joints of the robot; `locked` joints of `load_robot` are none"
        raise InvalidInput(f"{trajectory.source}, missing joints", ", ".join(lacking), allowed)


def _check_limits(robot: SpaceRobot, trajectory: Trajectory, values: Array) -> None:
    """Raise `InvalidInput` for the first row with values beyond a limit."""
    outside = np.any((values < robot.lower) | (values > robot.upper), axis=1)
    if np.any(outside):
        row = int(np.argmax(outside))
        where = f"{trajectory.source}, row {row} at {trajectory.times[row]:g} s"
        robot.check_limits(where, values[row])

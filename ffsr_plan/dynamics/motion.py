"""`Motion`: the continuous whole-body motion through a sequence of corners.

Between corners the joints move linearly. What the base does follows from the mode:

free-flying    thrusters move its origin linearly, its attitude reacts to the arms
attitude-held  thrusters move its origin linearly, wheels turn it steadily from start to goal
free-floating  nothing actuates it: attitude and position react, the centre of mass stays put
"""

from __future__ import annotations

import copy
from functools import cached_property

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.robot import SpaceRobot


class Motion:
    """Configurations along edges 0 .. m-1, each run from time 0 to 1.

    Attributes:
        robot: the robot.
        mode: what actuates the base.
        positions: (m + 1, 3) base origin at the corners, world [m].
        joint_values: (m + 1, nd) at the corners [rad or m].
        attitudes: (m + 1, 4) base attitude at the corners (xyzw), reaction included.
        joints_are_straight: whether the joints follow one straight line from start to goal.
        turn_shares: (m + 1,) share of the rotation from start to goal at each corner, where wheels
            hold the attitude; None where the base turns steadily, or reacts.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        mode: Mode | str,
        start: Array,
        goal: Array,
        positions: Array,
        joint_values: Array | None = None,
        turn_shares: Array | None = None,
    ) -> None:
        """The motion from `start` to `goal` (nq,) through base positions (m + 1, 3).

        The goal's attitude counts in the mode `attitude-held` only; where the robot floats, the
        positions count for their number alone.

        Args:
            robot: the robot.
            mode: what actuates the base.
            start: (nq,).
            goal: (nq,).
            positions: (m + 1, 3) base origin at the corners, world [m].
            joint_values: (m + 1, nd) at the corners; without them the joints move steadily from
                start to goal, continuous ones the shorter way round.
            turn_shares: (m + 1,) share of the rotation from start to goal that wheels have turned
                the base by at each corner, from 0 to 1; without it the base turns steadily.

        Raises:
            InvalidInput: an argument of another kind, shape or size, or not finite.
        """
        if not isinstance(robot, SpaceRobot):
            raise InvalidInput("robot", robot, "a SpaceRobot")
        self.robot, self.mode = robot, Mode.parse("mode", mode)
        start = robot.check_configuration("start", start)
        goal = robot.check_configuration("goal", goal)
        positions = finite_array("positions", positions, (-1, 3))
        if len(positions) < 2:
            raise InvalidInput("positions", positions.tolist(), "at least two, for one edge")
        if joint_values is not None:
            shape = (len(positions), robot.nd)
            joint_values = finite_array("joint_values", joint_values, shape)
        self._start, self._goal = start[3:7], goal[3:7]
        self._origin = start[:3]
        self._progress = np.arange(len(positions)) / (len(positions) - 1)
        if turn_shares is not None:
            turn_shares = finite_array("turn_shares", turn_shares, (len(positions),))
            if turn_shares[0] != 0.0 or turn_shares[-1] != 1.0:
                allowed = "shares from 0 at the first corner to 1 at the last"
                raise InvalidInput("turn_shares", turn_shares.tolist(), allowed)
        self.turn_shares = turn_shares
        self.joints_are_straight = joint_values is None
        if joint_values is None:
            travel = robot.joint_change(start, goal)
            joint_values = robot.joint_values(start) + self._progress[:, None] * travel
        self.joint_values = frozen(np.asarray(joint_values, dtype=np.float64))
        self.positions = positions
        self.attitudes = frozen(self.attitudes_at(self._progress))
        if self.mode.floats:
            self.positions = frozen(self._afloat(self.attitudes, self.joint_values))

    @property
    def edges(self) -> int:
        """m, their number."""
        return len(self.positions) - 1

    def base_steps(self) -> Array:
        """Translation of the base by thrusters.

        Returns:
            (m, 3) displacement of the base origin over each edge, world axes [m].
        """
        steps: Array = np.diff(self.positions, axis=0)
        return np.zeros_like(steps) if self.mode.floats else steps

    @cached_property
    def reaction(self) -> Reaction:
        """The base rotation that the joint path brings about; as one segment if it is straight."""
        return Reaction.along(
            self.robot,
            self.joint_values[[0, -1]] if self.joints_are_straight else self.joint_values,
        )

    @property
    def attitude_error(self) -> float:
        """Bound on the error of any attitude [rad]."""
        return float(self.reaction.errors.sum()) if self.mode.attitude_reacts else 0.0

    @cached_property
    def _turned(self) -> Array:
        """(m + 1, 4) attitudes at the corners of a joint path that is not straight."""
        return self.reaction.attitudes(self._start)

    @property
    def turns(self) -> Array:
        """(m, 3) angular velocity of a base that does not react, base axes [rad per edge]."""
        whole = rotations.rotation_vector(self._start, self._goal)
        if self.turn_shares is None:
            return np.tile(whole / self.edges, (self.edges, 1))
        return np.asarray(np.diff(self.turn_shares)[:, None] * whole)

    def displaced(self, offsets: Array) -> Motion:
        """The same motion with the base displaced; its attitudes and joints do not change.

        Args:
            offsets: (m + 1, 3) displacement at the corners, world axes [m].
        """
        twin = copy.copy(self)
        twin.positions = frozen(self.positions + offsets)
        return twin

    def configurations(self) -> Array:
        """Configurations at the corners.

        Returns:
            (m + 1, nq) base pose in the world [m, quaternion xyzw] and joints.
        """
        return self.robot.assemble(self.positions, self.attitudes, self.joint_values)

    def at(self, edge: IntArray, time: Array) -> Array:
        """Configurations along the edges, base reaction included.

        Args:
            edge: (N,) edges, 0 .. m-1.
            time: (N,) times on them, from 0 to 1.

        Returns:
            (N, nq) base pose in the world [m, quaternion xyzw] and joints.
        """
        t = time[:, None]
        joints = self.joints_at(edge, time)
        quat = self.attitudes_at((edge + time) / self.edges)
        if self.mode.floats:
            position = self._afloat(quat, joints)
        else:
            position = (1.0 - t) * self.positions[edge] + t * self.positions[edge + 1]
        return self.robot.assemble(position, quat, joints)

    def joints_at(self, edge: IntArray, time: Array) -> Array:
        """Joint values along the edges; continuous joints without a jump at half a turn.

        Args:
            edge: (N,) edges, 0 .. m-1.
            time: (N,) times on them, from 0 to 1.

        Returns:
            (N, nd) [rad or m].
        """
        t = time[:, None]
        values: Array = (1.0 - t) * self.joint_values[edge] + t * self.joint_values[edge + 1]
        return values

    def _afloat(self, quats: Array, joint_values: Array) -> Array:
        """(N, 3) base origin at attitudes (N, 4) and joints (N, nd), the centre of mass at rest."""
        begin = np.vstack([self.joint_values[:1], joint_values])
        centers = centers_of_mass(self.robot, begin)
        turned = rotations.rotate(np.vstack([self._start, quats]), centers)
        return np.asarray(self._origin + turned[0] - turned[1:])

    def attitudes_at(self, progress: Array) -> Array:
        """Attitudes of the base, its reaction included.

        Args:
            progress: (N,) path parameters from 0 to 1.

        Returns:
            (N, 4) quaternions (xyzw).
        """
        if not self.mode.attitude_reacts:
            if self.turn_shares is not None:
                progress = np.interp(progress, self._progress, self.turn_shares)
            return rotations.slerp(self._start, self._goal, progress)
        if self.joints_are_straight:
            turned = self.reaction.rotation(np.zeros(len(progress), dtype=np.int64), progress)
            return rotations.multiply(self._start, turned)
        scaled = progress * self.edges
        edge = np.minimum(scaled.astype(np.int64), self.edges - 1)
        return rotations.multiply(self._turned[edge], self.reaction.rotation(edge, scaled - edge))

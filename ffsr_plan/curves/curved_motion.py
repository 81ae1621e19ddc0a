"""`CurvedMotion`: the whole-body motion along a smooth curve, in pieces."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.curves.control_points import ControlPoints
from ffsr_plan.curves.curved_reaction import CurvedReaction
from ffsr_plan.curves.kernels.pieces import FIRST_JOINT, Pieces
from ffsr_plan.curves.splines import evaluate, pieces_with
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction


class CurvedMotion:
    """Configurations along the pieces 0 .. m-1 of a curve, each run from time 0 to 1.

    Base origin, joints and the share of a rotation by wheels are uniform cubic B-splines. Where the
    base reacts its attitude follows from the joints, where it floats its position too.

    Attributes:
        robot: the robot.
        mode: what actuates the base.
        control: the control points.
        pieces: the splines in Bernstein form.
        reaction: the base rotation that the joints bring about; of as many segments as there are
            pieces, or of one where the joints follow a straight line. None where wheels hold it.
        attitudes: (m + 1, 4) at the ends of the pieces (xyzw).
        joint_values: (m + 1, nd) there [rad or m].
    """

    def __init__(
        self,
        motion: Motion,
        control: ControlPoints,
        *,
        joints_bend: bool = False,
        start: Array | None = None,
    ) -> None:
        """The curve with given control points.

        Args:
            motion: a motion of the same robot in the same mode from the same start; where wheels
                hold the attitude, or the joints follow a straight line, with the same rotation.
            control: the control points.
            joints_bend: whether the joints leave the straight line that those of the motion follow.
            start: (4,) attitude at the begin (xyzw), by default that of the motion.

        Raises:
            IntegrationError: the reaction along a piece cannot be integrated.
        """
        self.robot, self.mode, self.control = motion.robot, motion.mode, control
        self._start = motion.attitudes[0] if start is None else start
        turn = motion.turns.sum(axis=0) if self.mode.has_wheels else np.zeros(3)
        self.pieces = pieces_with(control.table, turn)
        values = self.pieces.values
        self.joints_are_straight = motion.joints_are_straight and not joints_bend
        self.reaction: Reaction | None = None
        if self.mode.attitude_reacts:
            self.reaction = (
                motion.reaction
                if self.joints_are_straight
                else CurvedReaction(self.robot, self.pieces)
            )
        self.joint_values = frozen(np.vstack([values[:, 0, 3:-1], values[-1:, 3, 3:-1]]))
        last = np.append(np.arange(self.edges), self.edges - 1)
        self.attitudes = frozen(self.attitudes_at(last, np.append(np.zeros(self.edges), 1.0)))

    @property
    def edges(self) -> int:
        """m, the number of pieces."""
        return len(self.pieces.values)

    @property
    def attitude_error(self) -> float:
        """Bound on the error of any attitude [rad]."""
        return 0.0 if self.reaction is None else float(self.reaction.errors.sum())

    def base_steps(self) -> Array:
        """(m, 3) zeros: what moves the base along a piece is part of its curve."""
        return np.zeros((self.edges, 3))

    @cached_property
    def pieces_in_base(self) -> Pieces:
        """The curve as seen from the base: joints alone."""
        rows = self.pieces.rows.copy()
        rows[:, :, :FIRST_JOINT] = 0.0
        return Pieces(rows)

    def configurations(self) -> Array:
        """(m + 1, nq) at the ends of the pieces."""
        last = np.append(np.arange(self.edges), self.edges - 1)
        return self.at(last, np.append(np.zeros(self.edges), 1.0))

    def at(self, edge: IntArray, time: Array) -> Array:
        """Configurations along the pieces, base reaction included.

        Args:
            edge: (N,) pieces, 0 .. m-1.
            time: (N,) times on them, from 0 to 1.

        Returns:
            (N, nq) base pose in the world [m, quaternion xyzw] and joints.
        """
        table = evaluate(self.pieces.values, edge, time)
        quats, position = self.attitudes_at(edge, time), table[:, :3]
        if self.mode.floats:
            position = position - rotations.rotate(
                quats, centers_of_mass(self.robot, table[:, 3:-1])
            )
        return self.robot.assemble(position, quats, table[:, 3:-1])

    def joints_at(self, edge: IntArray, time: Array) -> Array:
        """(N, nd) joint values along the pieces; continuous joints without a jump [rad or m]."""
        return evaluate(self.pieces.values, edge, time)[:, 3:-1]

    def attitudes_at(self, edge: IntArray, time: Array) -> Array:
        """(N, 4) attitudes of the base along the pieces (xyzw)."""
        if self.reaction is None or self.joints_are_straight:
            share = evaluate(self.pieces.values[:, :, -1:], edge, time)
            if self.reaction is None:
                turned = rotations.exp(share * self.pieces.turn)
            else:
                whole = np.zeros(len(edge), dtype=np.int64)
                turned = self.reaction.rotation(whole, np.clip(share[:, 0], 0.0, 1.0))
            return rotations.multiply(self._start, turned)
        return rotations.multiply(self._turned[edge], self.reaction.rotation(edge, time))

    @cached_property
    def _turned(self) -> Array:
        """(m + 1, 4) attitudes at the ends of pieces along which the joints are not straight."""
        assert self.reaction is not None
        return self.reaction.attitudes(self._start)

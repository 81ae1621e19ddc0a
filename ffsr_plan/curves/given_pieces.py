"""`GivenPieces`: the whole-body motion along cubic pieces that are given as they are."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.curved_reaction import CurvedReaction
from ffsr_plan.curves.splines import pieces_of
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.robot import SpaceRobot


class GivenPieces(CurvedMotion):
    """Cubic pieces of base origin and joints, each beginning where the one before it ends.

    Attributes:
        carried_error: bound on the error of the attitude at the start [rad].
    """

    def __init__(
        self,
        robot: SpaceRobot,
        mode: Mode,
        attitude: Array,
        coefficients: Array,
        turn: Array,
        carried_error: float = 0.0,
    ) -> None:
        """The motion with given Bernstein coefficients.

        Args:
            robot: the robot.
            mode: what actuates the base.
            attitude: (4,) of the base at the start (xyzw).
            coefficients: (m, 4, 3 + nd + 1), columns as in `Pieces`.
            turn: (3,) rotation by wheels from start to end, base axes [rad]; zero where it reacts.
            carried_error: bound on the error of `attitude` [rad].

        Raises:
            IntegrationError: the reaction along a piece cannot be integrated.
        """
        self.robot, self.mode, self.carried_error = robot, mode, carried_error
        self._start, self.pieces = attitude, pieces_of(coefficients, turn)
        self.joints_are_straight = False
        self.reaction = CurvedReaction(robot, self.pieces) if mode.attitude_reacts else None
        values = self.pieces.values
        self.joint_values = frozen(np.vstack([values[:, 0, 3:-1], values[-1:, 3, 3:-1]]))
        last = np.append(np.arange(self.edges), self.edges - 1)
        self.attitudes = frozen(self.attitudes_at(last, np.append(np.zeros(self.edges), 1.0)))

    @property
    def attitude_error(self) -> float:
        """Bound on the error of any attitude [rad]."""
        return super().attitude_error + self.carried_error

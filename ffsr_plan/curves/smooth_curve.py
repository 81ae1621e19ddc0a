"""`SmoothCurve`: configurations, rates and accelerations along a smooth whole-body motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, equal_by_content
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.splines import evaluate
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.robot import SpaceRobot


@equal_by_content
class CurvePoints(NamedTuple):
    """A curve at N parameters s; derivatives are by s.

    Attributes:
        configurations: (N, nq) base pose in the world [m, quaternion xyzw] and joints, the reaction
            of the base included.
        joints: (N, nd) joint values, continuous ones without a jump at half a turn [rad or m].
        base: (N, 2, 3) first and second derivative of the base origin where thrusters move it,
            world axes [m]; zeros where it floats.
        turn: (N, 2, 3) angular velocity of the base where wheels rotate it, and its derivative,
            base axes [rad]; zeros where the base reacts.
        rates: (N, 2, nd) first and second derivative of the joint values [rad or m].
    """

    configurations: Array
    joints: Array
    base: Array
    turn: Array
    rates: Array


class SmoothCurve:
    """A whole-body motion that is twice continuously differentiable in its parameter.

    The parameter s runs from 0 to m over m pieces. Of the base, `at` tells what actuators do; its
    reaction follows from the joints' rates and momentum conservation.

    Attributes:
        robot: the robot.
        mode: what actuates the base.
        pieces: m, their number.
        motion: the same by piece and time.
    """

    def __init__(self, motion: CurvedMotion) -> None:
        self.robot: SpaceRobot = motion.robot
        self.mode: Mode = motion.mode
        self.pieces: int = motion.edges
        self.motion = motion

    def at(self, s: Array) -> CurvePoints:
        """The curve at parameters.

        Args:
            s: (N,) from 0 to m.

        Raises:
            InvalidInput: a parameter outside [0, m] or not finite.
        """
        parameters = finite_array("s", s, (-1,))
        if np.any((parameters < 0.0) | (parameters > self.pieces)):
            raise InvalidInput("s", s, f"curve parameters from 0 to {self.pieces}")
        edge = np.minimum(parameters.astype(np.int64), self.pieces - 1)
        time, curve = parameters - edge, self.motion.pieces
        rates, bends = evaluate(curve.rates, edge, time), evaluate(curve.bends, edge, time)
        both = np.stack([rates, bends], axis=1)
        base = np.zeros((len(edge), 2, 3)) if self.mode.floats else both[:, :, :3]
        return CurvePoints(
            configurations=self.motion.at(edge, time),
            joints=self.motion.joints_at(edge, time),
            base=base,
            turn=both[:, :, -1:] * curve.turn,
            rates=both[:, :, 3:-1],
        )

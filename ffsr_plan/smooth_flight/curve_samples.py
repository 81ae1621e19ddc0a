"""`CurveSamples`: a curve and its dynamics at the points where limits are asked for."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.curves.smooth_curve import CurvePoints
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.path_dynamics import PathDynamics, Prescribed, path_dynamics
from ffsr_plan.robots.robot import SpaceRobot

PARTS = 4
"""Equal parts of a step between whose ends limits are checked; a multiple of those of `ASKED`."""
ASKED = 2
"""Equal parts of a step at whose ends limits are asked for."""
_STEPS_PER_PIECE = 8
_FEWEST_STEPS = 240  # of the whole curve
_MOST_STEPS = 4000  # unless the curve has more pieces than half of these


class Curve(Protocol):
    """What a flight needs to know of a curve; see `SmoothCurve`."""

    robot: SpaceRobot
    mode: Mode
    pieces: int

    def at(self, s: Array) -> CurvePoints:
        """The curve at parameters (N,) from 0 to `pieces`."""


class CurveSamples(NamedTuple):
    """A curve at K = 4 S + 1 equally spaced parameters, the ends of S steps of four parts.

    Attributes:
        s: (K,) the parameters.
        path: the curve there.
        dynamics: velocities and forces there, for any pace.
    """

    s: Array
    path: Prescribed
    dynamics: PathDynamics

    @property
    def steps(self) -> int:
        """S, the number of steps."""
        return (len(self.s) - 1) // PARTS

    @property
    def ends(self) -> Array:
        """(S + 1,) parameters between the steps."""
        return self.s[::PARTS]


def curve_samples(curve: Curve) -> CurveSamples:
    """A curve at the ends of equal parts; every whole parameter lies between two steps."""
    per_piece = max(_STEPS_PER_PIECE, -(-_FEWEST_STEPS // curve.pieces))
    per_piece = max(2, min(per_piece, _MOST_STEPS // curve.pieces))
    s = np.linspace(0.0, curve.pieces, PARTS * per_piece * curve.pieces + 1)
    return CurveSamples(s, *dynamics_at(curve, s))


def dynamics_at(curve: Curve, s: Array) -> tuple[Prescribed, PathDynamics]:
    """A curve and its dynamics at parameters (N,)."""
    path = Prescribed(*curve.at(s))
    return path, path_dynamics(curve.robot, curve.mode, path)

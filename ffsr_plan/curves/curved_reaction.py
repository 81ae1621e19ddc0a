"""Rotation of the base along curved joint pieces, integrated on the rotation group."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Records
from ffsr_plan.dynamics.reaction import TOLERANCE, Reaction, cut_all, interpolation_points
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.curves.kernels.pieces import Pieces


class CurvedReaction(Reaction):
    """Base rotation along cubic joint pieces, at zero angular momentum; see `Reaction`.

    Its segments are the pieces.
    """

    def __init__(self, robot: SpaceRobot, pieces: Pieces, tolerance: float = TOLERANCE) -> None:
        """Integrate the reaction along the pieces of a curve.

        Args:
            robot: the robot.
            pieces: the curve, m pieces.
            tolerance: error over a piece that is allowed for [rad].

        Raises:
            IntegrationError: a piece needs more than 4096 substeps.
        """
        from ffsr_plan.curves.kernels import curved_reaction as kernels
        from ffsr_plan.dynamics.kernels.rotation_series import TERMS

        memory = kernels.curve_memory_for(robot.nd + 1)

        def cut(piece: int, count: int, substeps: Records) -> tuple[int, int]:
            return kernels.cut_curves(
                robot.bodies, pieces, tolerance, memory, piece, count, substeps
            )

        joints = pieces.values[:, :, 3 : 3 + robot.nd]
        changes = np.ptp(joints, axis=1).max(axis=1, initial=0.0)
        substeps = cut_all(cut, changes)
        series = np.empty((len(substeps), TERMS, 4))
        kernels.expand_curves(
            robot.bodies, pieces, interpolation_points(), memory, substeps, series
        )
        self._chain(len(changes), substeps, series, memory.straight)

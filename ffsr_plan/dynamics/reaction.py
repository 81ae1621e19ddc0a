"""Rotation of the base along a joint path, integrated on the rotation group.

Along a straight joint segment the angular velocity omega(t) = A(theta(t)) theta' is a known,
analytic function of t that does not depend on the attitude. It is replaced by polynomials whose
distance from it is proven, and R' = R [omega]x is solved with these by power series. So the error
has a bound; docs/proof.md, section 9, derives it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, Records, records
from ffsr_plan.core.errors import IntegrationError
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.dynamics.kernels.reaction import Memory

TOLERANCE = 1e-11
"""Error [rad] over a segment that is allowed for, without that of rounding."""


class Reaction:
    """Base rotation along straight joint segments, at zero angular momentum.

    The rotation depends on the path of the joints only, not on its timing. Times run from 0 to 1
    along a segment.

    Attributes:
        increments: (m, 4) rotation over each segment, in the base frame at its start (xyzw).
        errors: (m,) bound on the angular error of any rotation within each segment [rad].
        partial: what rotations within the segments are computed from, for kernels.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        begin: Array,
        steps: Array,
        tolerance: float = TOLERANCE,
        inside: bool = True,
    ) -> None:
        """Integrate the reaction along segments, which need not be connected.

        Args:
            robot: the robot.
            begin: (m, nd) joint values at the start of each segment [rad or m].
            steps: (m, nd) change of the joint values along each segment [rad or m].
            tolerance: error over a segment that is allowed for [rad].
            inside: whether `rotation` will be called.

        Raises:
            IntegrationError: a segment needs more than 4096 substeps.
        """
        from ffsr_plan.dynamics.kernels import reaction as kernels
        from ffsr_plan.dynamics.kernels.rotation_series import TERMS

        begin, steps = _own(begin), _own(steps)  # kernels are compiled for writable arrays
        memory = kernels.memory_for(robot.nd + 1)

        def cut(segment: int, count: int, substeps: Records) -> tuple[int, int]:
            return kernels.cut(
                robot.bodies, begin, steps, tolerance, memory, segment, count, substeps
            )

        substeps = cut_all(cut, np.abs(steps).max(axis=1, initial=0.0))
        series = np.empty((len(substeps) if inside else 0, TERMS, 4))
        kernels.expand(robot.bodies, begin, steps, interpolation_points(), memory, substeps, series)
        self._chain(len(steps), substeps, series, memory)

    def _chain(self, segments: int, substeps: Records, series: Array, memory: Memory) -> None:
        """Chain substeps that have been integrated to rotations over whole segments."""
        from ffsr_plan.dynamics.kernels.reaction import chain
        from ffsr_plan.dynamics.kernels.rotation_series import Partial

        self.increments: Array = np.tile(rotations.IDENTITY, (segments, 1))
        self.errors: Array = np.zeros(segments)
        chain(substeps, memory, self.increments, self.errors)
        first = np.searchsorted(substeps["segment"], np.arange(segments + 1))
        self.partial = Partial(first, substeps, series)

    @classmethod
    def along(cls, robot: SpaceRobot, joint_values: Array) -> Reaction:
        """The reaction along a connected joint path.

        Args:
            robot: the robot.
            joint_values: (m + 1, nd) corners of the path [rad or m].
        """
        steps: Array = np.diff(joint_values, axis=0)
        return cls(robot, joint_values[:-1], steps)

    def rotation(self, edge: IntArray, time: Array) -> Array:
        """Rotation from the start of segments.

        Args:
            edge: (N,) segments.
            time: (N,) times on them, in [0, 1].

        Returns:
            (N, 4) rotations (xyzw).
        """
        from ffsr_plan.dynamics.kernels.rotation_series import rotations_at

        edges, times = np.array(edge, dtype=np.int64), _own(time)
        found: Array = np.empty((len(times), 4))
        rotations_at(self.partial, edges, times, np.empty(4), found)
        return found

    def attitudes(self, start: Array) -> Array:
        """Attitudes at the corners of a connected path.

        Args:
            start: (4,) attitude at its start (xyzw).

        Returns:
            (m + 1, 4) attitudes (xyzw).
        """
        attitudes = [start]
        for increment in self.increments:
            attitudes.append(rotations.multiply(attitudes[-1], increment))
        return np.array(attitudes)


def _own(array: Array) -> Array:
    """A contiguous copy that can be written to."""
    return np.array(array, dtype=np.float64, order="C")


def cut_all(cut: Callable[[int, int, Records], tuple[int, int]], changes: Array) -> Records:
    """Substeps of all segments, cut but not integrated.

    Args:
        cut: cuts from a segment on, given the number of substeps before it and the room for them;
            see `kernels.reaction.cut`.
        changes: (m,) largest change of a joint value over each segment [rad or m].

    Raises:
        IntegrationError: a segment needs more than 4096 substeps.
    """
    from ffsr_plan.dynamics.kernels.rotation_series import SUBSTEP

    substeps, segment, count = records(SUBSTEP, 2 * len(changes) + 64), 0, 0
    while True:
        segment, count = cut(segment, count, substeps)
        if segment == len(changes):
            break
        more = records(SUBSTEP, 2 * len(substeps))
        more[: len(substeps)] = substeps
        substeps = more
    substeps = substeps[:count].copy()
    given_up = substeps["segment"][substeps["length"] == 0.0]
    if len(given_up):
        raise IntegrationError(
            f"the base reaction does not converge (joint step {changes[given_up[0]]:g} in one edge)"
        )
    return substeps


@cache
def interpolation_points() -> Records:
    """(13,) the points at which the angular velocity is evaluated over a substep."""
    from ffsr_plan.dynamics.kernels.reaction import gauss_points

    return gauss_points()

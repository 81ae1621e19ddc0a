"""Rotation of the base along a joint path, integrated on the rotation group.

Along a straight joint segment the angular velocity omega(t) = A(theta(t)) theta' is a known, smooth
function of t that does not depend on the attitude. It is expanded in Legendre polynomials from its
values at Gauss points. The attitude then follows from R' = R [omega]x by sixth-order Magnus steps
(Blanes, Casas and Ros 2000), whose results are rotations without normalisation.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import IntegrationError
from ffsr_plan.dynamics.momentum import angular_maps, connections_of
from ffsr_plan.robots.robot import SpaceRobot

_ORDER = 8  # Legendre polynomials of each component of omega in a substep
_X, _WEIGHTS = legendre.leggauss(_ORDER)
_TO_COEFFICIENTS = (
    legendre.legvander(_X, _ORDER - 1) * _WEIGHTS[:, None] * (np.arange(_ORDER) + 0.5)
).T
_MAGNUS_POINTS = np.array([0.5 - np.sqrt(15) / 10, 0.5, 0.5 + np.sqrt(15) / 10])
_WHOLE_AND_HALVES = np.array([[0.0, 0.0, 0.5], [1.0, 0.5, 1.0]])  # begin and end of three steps
_FIRST_SUBSTEP = 0.2  # [rad or m] largest joint step of a substep in the first attempt
_ANGLE_TOLERANCE = 1e-11  # [rad] error over an edge
_RATE_TOLERANCE = 1e-11  # last Legendre coefficient, relative to the angular velocity
_MOST_SUBSTEPS = 4096
_OF_WHOLE = 2.0  # error of whole steps relative to their difference from halves; 64 / 63 at best
_ROUNDING = 4.0 * np.finfo(np.float64).eps  # relative, of momentum and inertia


class Reaction:
    """Base rotation along straight joint segments, at zero angular momentum.

    The rotation depends on the path of the joints only, not on its timing. Times run from 0 to 1
    along a segment.

    Attributes:
        increments: (m, 4) rotation over each segment, in the base frame at its start (xyzw).
        error: estimated angular error over any one segment [rad].
    """

    def __init__(
        self, robot: SpaceRobot, begin: Array, steps: Array, substeps: int | None = None
    ) -> None:
        """Integrate the reaction along segments, which need not be connected.

        Args:
            robot: the robot.
            begin: (m, nd) joint values at the start of each segment [rad or m].
            steps: (m, nd) change of the joint values along each segment [rad or m].
            substeps: number of Magnus steps for each segment. By default it is doubled until the
                error is below 1e-11 rad.

        Raises:
            IntegrationError: the error is too large with 4096 substeps.
        """
        self._integrate(robot, begin, steps, substeps)
        self.error = self._estimate(steps)
        del self._angular

    def _integrate(
        self, robot: SpaceRobot, begin: Array, steps: Array, substeps: int | None
    ) -> None:
        """Expand in `substeps`, or in as many as the tolerance needs."""
        if substeps is not None:
            self._expand(robot, begin, steps, substeps)
            return
        largest = float(np.max(np.abs(steps), initial=0.0))
        substeps = max(1, int(np.ceil(largest / _FIRST_SUBSTEP)))
        self._expand(robot, begin, steps, substeps)
        while not self._converged():
            substeps *= 2
            if substeps > _MOST_SUBSTEPS:
                raise IntegrationError(
                    f"the base reaction does not converge (joint step {largest:g} in one edge)"
                )
            self._expand(robot, begin, steps, substeps)

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
        scaled = time * self._substeps
        k = np.minimum(scaled.astype(np.int64), self._substeps - 1)
        partial = self._step(self._coefficients[edge, k], np.zeros(len(k)), scaled - k)
        return rotations.multiply(self._starts[edge, k], partial)

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

    def _expand(self, robot: SpaceRobot, begin: Array, steps: Array, substeps: int) -> None:
        edges = len(steps)
        times = (np.arange(substeps)[:, None] + 0.5 * (1.0 + _X)) / substeps
        theta = begin[:, None, None] + times[None, :, :, None] * steps[:, None, None]
        angular = angular_maps(robot, theta.reshape(edges * substeps * _ORDER, robot.nd))
        self._angular = angular.reshape(edges, substeps, _ORDER, 3, 3 + robot.nd)
        maps = connections_of(angular)
        maps = maps.reshape(edges, substeps, _ORDER, 3, robot.nd)
        # where the arms' contributions cancel, their magnitudes determine the rounding error
        self._scale = float(
            np.max(np.einsum("eknij,ej->ekn", np.abs(maps), np.abs(steps)), initial=0)
        )
        rates = np.einsum("eknij,ej->ekni", maps, steps)
        self._substeps = substeps
        self._coefficients = np.einsum("ln,ekni->ekli", _TO_COEFFICIENTS, rates)
        begin_end = np.broadcast_to(_WHOLE_AND_HALVES, (edges, substeps, 2, 3))
        steps_made = self._step(
            self._coefficients[:, :, None], begin_end[:, :, 0], begin_end[:, :, 1]
        )
        whole = steps_made[:, :, 0]
        halves = rotations.multiply(steps_made[:, :, 1], steps_made[:, :, 2])
        self._of_steps: Array = np.sum(rotations.angle_between(whole, halves), axis=1)
        starts = [np.broadcast_to(rotations.IDENTITY, (edges, 4))]
        for k in range(substeps):
            starts.append(rotations.multiply(starts[-1], whole[:, k]))
        self._starts = np.stack(starts[:-1], axis=1)
        self.increments = starts[-1]

    def _converged(self) -> bool:
        sizes = np.max(np.abs(self._coefficients), axis=(0, 1, 3), initial=0.0)
        largest = float(np.max(self._of_steps, initial=0.0))
        return bool(largest <= _ANGLE_TOLERANCE and sizes[-1] <= _RATE_TOLERANCE * self._scale)

    def _estimate(self, steps: Array) -> float:
        """Estimated angular error: of the steps, of the series, and of rounding.

        Rounding changes inertia and momentum by some eps of their largest entries. Where the arms
        carry the centre of mass close to the base's, the inertia is much smaller than that, and the
        angular velocity changes by as much more.
        """
        if not self._angular.size:
            return 0.0
        inertias = self._angular[..., :3]
        stiff = np.linalg.norm(np.linalg.inv(inertias), axis=(-2, -1))
        rates = np.einsum("lx,ekli->ekxi", legendre.legvander(_X, _ORDER - 1).T, self._coefficients)
        momenta = np.linalg.norm(inertias, axis=(-2, -1)) * np.linalg.norm(rates, axis=-1)
        momenta += np.einsum("eknij,ej->ekn", np.abs(self._angular[..., 3:]), np.abs(steps))
        of_rounding = np.sum(0.5 * _WEIGHTS * stiff * momenta, axis=(1, 2)) / self._substeps
        last = np.max(np.abs(self._coefficients[:, :, -1]), axis=-1)
        of_series = np.sum(last, axis=1) / self._substeps
        estimates = _OF_WHOLE * self._of_steps + of_series + _ROUNDING * of_rounding
        return float(np.max(estimates, initial=0.0))

    def _step(self, coefficients: Array, begin: Array, end: Array) -> Array:
        """Rotation (..., 4) over local times begin -> end (in [0, 1]) of a substep."""
        length = end - begin
        points = begin[..., None] + length[..., None] * _MAGNUS_POINTS
        basis = legendre.legvander(2.0 * points - 1.0, _ORDER - 1)
        # R' = R [omega] is the transpose of Y' = -[omega] Y, for which the series is stated
        field = -np.einsum("...pl,...li->...pi", basis, coefficients)
        field *= (length / self._substeps)[..., None, None]
        first, middle, last = field[..., 0, :], field[..., 1, :], field[..., 2, :]
        a1 = middle
        a2 = np.sqrt(15.0) / 3.0 * (last - first)
        a3 = 10.0 / 3.0 * (last - 2.0 * middle + first)
        c1 = rotations.cross(a1, a2)
        c2 = -rotations.cross(a1, 2.0 * a3 + c1) / 60.0
        return rotations.exp(
            -(a1 + a3 / 12.0 + rotations.cross(-20.0 * a1 - a3 + c1, a2 + c2) / 240.0)
        )

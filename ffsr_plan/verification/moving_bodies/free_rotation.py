"""The rotation of a rigid body that no torque acts on, by an integration of its own.

Dormand and Prince's method of order eight (scipy) integrates the rates and the quaternion of the
principal axes together, with steps that it chooses itself, whereas the package's bodies are
advanced by a method of order four in even steps. Time is counted in units of 1 / |w|, so that one
accuracy suits all. A coarser run tells how far the result can be relied on: close to a rotation
about the axis of the middle moment, errors grow by orders of magnitude from turn to turn.

With the moments of inertia a <= b <= c and the rates w_i along their axes, 2 E = sum I_i w_i^2 and
L^2 = sum I_i^2 w_i^2 are conserved. (I_i - a) (c - I_i) >= 0 for each of the three, so that

    |w|^2 = sum w_i^2 <= sum ((a + c) I_i - I_i^2) / (a c) w_i^2 = ((a + c) 2 E - L^2) / (a c)

at all times. Euler's equations are w_i' = k_i w_j w_k with k_i = (I_j - I_k) / I_i, of which a
body of mass has none beyond one. With k the largest of 1 and |k_i|,

    |w'|^2 <= k^2 sum w_j^2 w_k^2 <= k^2 |w|^4 / 3 .
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import IntegrationError
from ffsr_plan.verification.moving_bodies.turns import angles_between, turns_of

_FINE, _COARSE = (1e-13, 0.2), (1e-12, 0.35)  # relative error of a step, and the longest one [rad]
_DRIFT_LIMIT = 1e-9  # of energy and momentum, relative
_ERROR_LIMIT = 1e-7  # [rad]
_ROUNDING = 1e-15  # of energy and momentum, relative


class FreeRotation:
    """Rates and attitudes from time zero on.

    Attributes:
        largest_rate: bound on the angular speed at all times [rad/s].
        largest_change: bound on the rate of change of the angular velocity [rad/s^2].
        error: by how much the attitude of a coarser run differs at most [rad].
    """

    def __init__(self, inertia: Array, rate: Array, until: float) -> None:
        """Integrate.

        Args:
            inertia: (3, 3) about the centre of mass, body axes; its unit does not matter.
            rate: (3,) angular velocity at time zero, body axes [rad/s].
            until: time up to which it is integrated [s].

        Raises:
            IntegrationError: energy or momentum are not conserved, or a coarser run differs.
        """
        self._moments, self._axes = np.linalg.eigh(inertia)
        self._axes[:, 0] *= np.sign(np.linalg.det(self._axes))
        a, b, c = self._moments.tolist()
        own = self._axes.T @ rate
        energy, momentum = float(self._moments @ own**2), float(self._moments**2 @ own**2)
        square = (a + c) * energy * (1.0 + _ROUNDING) - momentum
        self.largest_rate = float(np.sqrt(square / (a * c)))
        self._gains = (b - c) / a, (c - a) / b, (a - b) / c
        steepest = max(1.0, *map(abs, self._gains))
        self.largest_change = steepest * self.largest_rate**2 / np.sqrt(3.0)
        self._scale, self.error = float(np.linalg.norm(rate)), 0.0  # [rad/s]
        self._solution: Any = None
        if self._scale > 0.0:
            self._integrate(own / self._scale, until * self._scale)

    def states(self, times: Array) -> tuple[Array, Array]:
        """Rates and attitudes.

        Args:
            times: (N,) from zero on [s].

        Returns:
            (N, 3) angular velocities, body axes [rad/s], and (N, 3, 3) rotations of the body's axes
            from those at time zero.
        """
        if self._solution is None or not len(times):
            return np.zeros((len(times), 3)), np.tile(np.eye(3), (len(times), 1, 1))
        y = self._solution(times * self._scale)
        turns = self._axes @ turns_of(y[3:].T) @ self._axes.T
        return y[:3].T @ self._axes.T * self._scale, turns

    def angles(self, begins: Array, ends: Array) -> Array:
        """Bounds on the angles turned, along the way, in intervals of time.

        Args:
            begins: (N,) [s].
            ends: (N,) [s].

        Returns:
            (N,) [rad].
        """
        spans = ends - begins
        # |w| grows by at most |w'| times the time since the begin; and it never passes its bound
        fast = np.linalg.norm(self.states(begins)[0], axis=1) + self.largest_change * spans
        return np.asarray(np.minimum(fast, self.largest_rate) * spans)

    def _slope(self, _: float, y: Array) -> list[float]:
        u, v, w, a, b, c, d = y.tolist()
        one, two, three = self._gains
        return [
            one * v * w,
            two * w * u,
            three * u * v,
            0.5 * (d * u + b * w - c * v),
            0.5 * (d * v + c * u - a * w),
            0.5 * (d * w + a * v - b * u),
            -0.5 * (a * u + b * v + c * w),
        ]

    def _integrate(self, rate: Array, until: float) -> None:
        fine, coarse = (self._run(rate, until, *accuracy) for accuracy in (_FINE, _COARSE))
        drift = max(self._drift(run) for run in (fine, coarse))
        turns = [turns_of(y[3:].T) for y in (fine.sol(coarse.t), coarse.y)]
        self.error = float(angles_between(*turns).max())
        if not (drift <= _DRIFT_LIMIT and self.error <= _ERROR_LIMIT):
            raise IntegrationError(
                f"a tumble over {until:.4g} rad cannot be foretold: two runs differ by "
                f"{self.error:.3g} rad, energy or momentum by {drift:.3g}; a rotation close to the "
                "axis of the middle moment of inertia is not stable"
            )
        self._solution = fine.sol

    def _run(self, rate: Array, until: float, accuracy: float, longest: float) -> Any:  # noqa: ANN401
        """The result of scipy's `solve_ivp`, whose class has no public name."""
        from scipy.integrate import solve_ivp

        begin = np.concatenate([rate, [0.0, 0.0, 0.0, 1.0]])
        return solve_ivp(
            self._slope, (0.0, until), begin, "DOP853", dense_output=True, rtol=accuracy,
            atol=0.01 * accuracy, max_step=longest,
        )  # fmt: skip

    def _drift(self, run: Any) -> float:  # noqa: ANN401 - see `_run`
        """Largest relative change of energy, or of angular momentum in the world, at the steps."""
        carried = run.y[:3].T * self._moments
        momentum = np.einsum("nij,nj->ni", turns_of(run.y[3:].T), carried)
        energy = np.sum(run.y[:3].T * carried, axis=1)
        turned = np.linalg.norm(momentum - momentum[0], axis=1) / np.linalg.norm(momentum[0])
        return float(max(turned.max(), np.abs(energy / energy[0] - 1.0).max()))

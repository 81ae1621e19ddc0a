"""The rotation of a rigid body that no torque acts on, by an integration of its own.

Dormand and Prince's method of order eight (scipy) integrates the rates, along the body's own axes,
and the quaternion together, whereas the package's bodies are advanced by a method of order four
along their principal axes. Time is counted in units of 1 / |w|, so that one accuracy suits all.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import IntegrationError
from ffsr_plan.verification.moving_bodies.turns import turns_of

_RELATIVE, _ABSOLUTE = 1e-13, 1e-15  # accuracy of a step
_LONGEST_STEP = 0.2  # [rad], for the polynomials between the steps
_DRIFT_LIMIT = 1e-9  # of energy and momentum, relative


class FreeRotation:
    """Rates and attitudes from time zero on.

    Attributes:
        largest_rate: bound on the angular speed at all times [rad/s].
        largest_change: bound on the rate of change of the angular velocity [rad/s^2].
        drift: largest relative change of energy, or of angular momentum in the world, at the steps.
    """

    def __init__(self, inertia: Array, rate: Array, until: float) -> None:
        """Integrate.

        Args:
            inertia: (3, 3) about the centre of mass, body axes; its unit does not matter.
            rate: (3,) angular velocity at time zero, body axes [rad/s].
            until: time up to which it is integrated [s].

        Raises:
            IntegrationError: energy or momentum are not conserved.
        """
        self._inertia = inertia / np.trace(inertia)
        self._inverse = np.linalg.inv(self._inertia)
        self._scale = float(np.linalg.norm(rate))  # [rad/s]
        # |I w| is conserved, and so is w.I w: |w| is at most the former over the least moment of
        # inertia, and its square at most the latter over it. I w' = I w x w, of which the norm is
        # at most |I w| |w|. All of this holds at any time, whatever the motion is.
        least = float(np.linalg.eigvalsh(self._inertia)[0])
        momentum = float(np.linalg.norm(self._inertia @ rate))
        energy = float(rate @ self._inertia @ rate)
        self.largest_rate = min(momentum / least, float(np.sqrt(energy / least)))
        self.largest_change = momentum * self.largest_rate / least
        self.drift = 0.0
        self._solution = None
        if self._scale > 0.0:
            self._integrate(rate / self._scale, until * self._scale)

    def states(self, times: Array) -> tuple[Array, Array]:
        """Rates and attitudes.

        Args:
            times: (N,) from zero on [s].

        Returns:
            (N, 3) angular velocities, body axes [rad/s], and (N, 3, 3) rotations of the body's axes
            from those at time zero.
        """
        if self._solution is None:
            return np.zeros((len(times), 3)), np.tile(np.eye(3), (len(times), 1, 1))
        if not len(times):
            return np.zeros((0, 3)), np.zeros((0, 3, 3))
        y = self._solution(times * self._scale)
        return y[:3].T * self._scale, turns_of(y[3:].T)

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

    def _slope(self, _: float, y: Array) -> Array:
        wx, wy, wz = w = y[:3]
        hx, hy, hz = self._inertia @ w
        torque = np.array([hy * wz - hz * wy, hz * wx - hx * wz, hx * wy - hy * wx])
        a, b, c, d = 0.5 * y[3:]
        slope = np.empty(7)
        slope[:3] = self._inverse @ torque
        slope[3] = d * wx + b * wz - c * wy
        slope[4] = d * wy + c * wx - a * wz
        slope[5] = d * wz + a * wy - b * wx
        slope[6] = -a * wx - b * wy - c * wz
        return slope

    def _integrate(self, rate: Array, until: float) -> None:
        from scipy.integrate import solve_ivp

        begin = np.concatenate([rate, [0.0, 0.0, 0.0, 1.0]])
        found = solve_ivp(
            self._slope, (0.0, until), begin, "DOP853", dense_output=True, rtol=_RELATIVE,
            atol=_ABSOLUTE, max_step=_LONGEST_STEP,
        )  # fmt: skip
        rates, turns = found.y[:3].T, turns_of(found.y[3:].T)
        carried = rates @ self._inertia
        momentum = np.einsum("nij,nj->ni", turns, carried)
        energy = np.sum(rates * carried, axis=1)
        whole = float(np.linalg.norm(momentum[0]))
        of_momentum = np.linalg.norm(momentum - momentum[0], axis=1).max() / whole
        self.drift = float(max(of_momentum, np.abs(energy / energy[0] - 1.0).max()))
        if not found.success or not self.drift <= _DRIFT_LIMIT:
            raise IntegrationError(
                f"a tumble over {until:g} rad: energy and angular momentum change by {self.drift:g}"
            )
        self._solution = found.sol

"""A rigid body that tumbles: no torque acts on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, NamedTuple

import numpy as np

from ffsr_plan.bodies.body_motion import Poses
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Numbers, Rule, Vector
from ffsr_plan.core.settings import setting, settings

_STILL = (0.0, 0.0, 0.0)
_STEP_ANGLE = 2e-3  # [rad] that the fastest rate turns in a step: errors of 1e-12 a radian
_MOST_STEPS = 5_000_000
_LAST_DIGITS = 1e-15  # relative, of a rate
_POSE_ERROR = 1e-9  # [rad] that poses may be in error, as proofs assume


@dataclass(frozen=True)
class Inertia(Rule):
    """A tensor of inertia (3, 3) that a body can have, or its principal moments (3,)."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        flat = np.ndim(value) == 1  # type: ignore[arg-type]
        given = finite_array(what, value, (3,) if flat else (3, 3))  # type: ignore[arg-type]
        tensor = np.diag(given) if flat else np.asarray(given)
        if np.max(np.abs(tensor - tensor.T)) > 1e-9 * np.max(np.abs(tensor)):
            raise InvalidInput(what, tensor.tolist(), "a symmetric tensor, or three moments")
        moments = np.linalg.eigvalsh(tensor)
        if moments[0] <= 0.0 or moments[2] > (1.0 + 1e-9) * (moments[0] + moments[1]):
            allowed = "principal moments above 0, none larger than the sum of the other two"
            raise InvalidInput(what, moments.tolist(), allowed)
        return frozen(tensor)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "array", "minItems": 3, "maxItems": 3}


class _Nodes(NamedTuple):
    """Rates along the principal axes and attitudes of these axes, at equal steps of time."""

    step: float
    rates: Array
    attitudes: Array
    reliable_until: float


@settings
class Tumble:
    """Free rotation of a rigid body about its centre of mass, the reference point.

    About an axis close to that of the middle moment the motion is unstable. It is known for as long
    as a change of the rates' last digits moves its attitudes by less than 1e-9 rad.

    Attributes:
        inertia: (3, 3) about the centre of mass, body axes, or three moments along them [kg m^2];
            its unit does not matter.
        rate: (3,) angular velocity at time zero, body axes [rad/s].
        velocity: (3,) of the centre of mass, world axes [m/s].
        known_until: time up to which it is integrated [s].
    """

    tells_world_poses: ClassVar[bool] = False

    inertia: Annotated[Vector, Inertia()]
    rate: Annotated[Vector, Numbers(3, FARTHEST)]
    velocity: Annotated[Vector, Numbers(3, FARTHEST)] = setting(default=_STILL)
    known_until: Annotated[float, Number(above=0.0, at_most=1e9)] = 3600.0

    def __post_init__(self) -> None:
        steps = self.known_until * self.largest_rate / _STEP_ANGLE
        if steps > _MOST_STEPS:
            longest = _MOST_STEPS * _STEP_ANGLE / self.largest_rate
            raise InvalidInput("known_until", self.known_until, f"at most {longest:.4g} s here")

    @property
    def axis(self) -> Array | None:
        """None: the axis moves through the body."""
        return None

    @cached_property
    def _principal(self) -> tuple[Array, Array]:
        """(3,) moments, and (3, 3) principal axes as columns, right-handed."""
        moments, axes = np.linalg.eigh(self.inertia)
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        return moments, axes

    @cached_property
    def largest_rate(self) -> float:
        """The largest |w| that energy and momentum allow; the motion comes as near as it likes.

        2 E = sum I_i w_i^2 and L^2 = sum I_i^2 w_i^2 are linear in the squares of the rates, so
        that |w|^2 is largest where one of them is zero.
        """
        moments, axes = self._principal
        squares = (axes.T @ self.rate) ** 2
        energy, momentum = float(moments @ squares), float(moments**2 @ squares)
        best = float(np.sum(squares))
        for k in range(3):
            a, b = np.delete(moments, k)
            if b - a <= 1e-12 * b:  # |w|^2 is the same all along this edge
                continue
            second = (momentum - a * energy) / (b * (b - a))
            first = (b * energy - momentum) / (a * (b - a))
            if first >= -1e-12 * best and second >= -1e-12 * best:
                best = max(best, first + second)
        return math.sqrt(best)

    @cached_property
    def largest_acceleration(self) -> float:
        """Bound on |w'| [rad/s^2]: Euler's equations at the largest rate of each axis."""
        moments, axes = self._principal
        squares = (axes.T @ self.rate) ** 2
        energy, momentum = float(moments @ squares), float(moments**2 @ squares)
        most = np.sqrt(np.minimum(energy / moments, momentum / moments**2))
        a, b, c = moments
        x, y, z = most
        return float(
            np.linalg.norm([(c - b) / a * y * z, (c - a) / b * z * x, (b - a) / c * x * y])
        )

    @cached_property
    def _nodes(self) -> _Nodes:
        from ffsr_plan.bodies.tumble_kernel import tumble

        moments, axes = self._principal
        count = max(1, math.ceil(self.known_until * self.largest_rate / _STEP_ANGLE))
        step = self.known_until / count
        start, rate = _quaternion(axes), axes.T @ self.rate
        steps = np.full(count, step)
        rates, attitudes = tumble(moments, rate, start, steps)
        # near the middle axis a difference in the last digits grows exponentially
        near = rate + _LAST_DIGITS * self.largest_rate * np.array([1.0, -1.0, 1.0])
        _, others = tumble(moments, near, start, steps)
        turned = np.linalg.norm(attitudes - others, axis=1)
        far = np.flatnonzero(turned > 0.5 * _POSE_ERROR)
        until = (int(far[0]) - 1) * step if len(far) else self.known_until
        return _Nodes(step, frozen(rates), frozen(attitudes), until)

    def _states(self, times: Array) -> tuple[Array, Array]:
        """(n, 3) rates along the principal axes, and (n, 4) attitudes of these axes at times."""
        from ffsr_plan.bodies.tumble_kernel import tumble

        nodes, (moments, _) = self._nodes, self._principal
        if np.max(times, initial=0.0) > nodes.reliable_until:
            until = f"at most {nodes.reliable_until:.4g} s for this tumble about its middle axis"
            allowed = f"{until}, whose poses later on depend on digits that no rate is known to"
            raise InvalidInput("times", float(np.max(times)), allowed)
        at = np.clip((times / nodes.step).astype(np.int64), 0, len(nodes.rates) - 1)
        rates, attitudes = np.empty((len(times), 3)), np.empty((len(times), 4))
        for k, (node, time) in enumerate(zip(at.tolist(), times.tolist(), strict=True)):
            rest = np.array([time - node * nodes.step])
            found = tumble(moments, nodes.rates[node], nodes.attitudes[node], rest)
            rates[k], attitudes[k] = found[0][1], found[1][1]
        return rates, attitudes

    def rates(self, times: Array) -> Array:
        """(n, 3) angular velocities at times (n,) [s], body axes [rad/s]."""
        return self._states(times)[0] @ self._principal[1].T

    @property
    def speeds(self) -> tuple[float, float]:
        """Speed of the centre of mass [m/s], and the greatest angular speed [rad/s]."""
        return float(np.linalg.norm(self.velocity)), self.largest_rate

    def poses(self, times: Array) -> Poses:
        """Poses at times (n,) [s]; see `BodyMotion`."""
        attitudes = self._states(times)[1]
        back = rotations.inverse(_quaternion(self._principal[1]))
        turned = rotations.multiply(attitudes, np.tile(back, (len(times), 1)))
        return Poses(times[:, None] * self.velocity, turned)

    def path(self, begin: float, end: float) -> float:
        """Length of the path of the centre of mass between two times [m]: exact."""
        return float(np.linalg.norm(self.velocity)) * (end - begin)

    def turned(self, begin: float, end: float) -> float:
        """Bound on the angle between two times [rad], exact to second order in their distance."""
        span = end - begin
        (rate,) = self._states(np.array([0.5 * (begin + end)]))[0]
        near = float(np.linalg.norm(rate)) * span + 0.25 * self.largest_acceleration * span**2
        return min(self.largest_rate * span, near)

    def later(self, time: float) -> Tumble:
        """The motion whose time zero is a later instant [s], with its angular velocity then."""
        (rate,) = self.rates(np.array([time]))
        return replace(self, rate=rate, known_until=self.known_until - time)


def _quaternion(axes: Array) -> Array:
    """(4,) of a rotation matrix (3, 3)."""
    import pinocchio as pin

    return np.asarray(pin.Quaternion(axes).normalized().coeffs())

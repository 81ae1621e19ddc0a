"""`Trajectory`: joint values over time, from wherever they come."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from ffsr_plan.core.arrays import Array, ReadOnlyDict, content, frozen
from ffsr_plan.core.checks import (
    FARTHEST,
    finite_array,
    one_of,
    text,
    unit_quaternion,
    unknown_name,
)
from ffsr_plan.core.errors import InvalidInput

INTERPOLATIONS = ("linear", "cubic")
Values = Mapping[str, Array]
"""Numbers (N,) of each joint, by its name."""


@dataclass(frozen=True, eq=False, init=False)
class Trajectory:
    """Joint values at increasing times, and what is between them; of the base as far as given.

    Between two times each joint value is a linear or a cubic function of time. Cubic pieces have
    the given velocities at their ends; without velocities they are those of the spline that is
    twice continuously differentiable and at rest at both ends of the trajectory. The same holds
    for the base positions. An attitude turns steadily about one axis from time to time.

    Attributes:
        times: (N,) increasing [s], N >= 2.
        joints: (N,) values of each joint by its name [rad or m].
        velocities: (N,) of each joint [rad/s or m/s]; empty without any.
        base_positions: (N, 3) base origin in the world [m]; None where it is not given.
        base_velocities: (N, 3) its velocity, world axes [m/s]; None where it is not given.
        base_attitudes: (N, 4) base attitude (x, y, z, w), base axes to world axes; None where it is
            not given.
        interpolation: `linear` or `cubic`.
        source: what errors call the trajectory, such as a file's name.
    """

    times: Array
    joints: Values
    velocities: Values
    base_positions: Array | None
    base_velocities: Array | None
    base_attitudes: Array | None
    interpolation: str
    source: str

    def __init__(
        self,
        times: ArrayLike,
        joints: Mapping[str, ArrayLike],
        *,
        velocities: Mapping[str, ArrayLike] | None = None,
        base_positions: ArrayLike | None = None,
        base_velocities: ArrayLike | None = None,
        base_attitudes: ArrayLike | None = None,
        interpolation: str = "linear",
        source: str = "trajectory",
    ) -> None:
        """Check the numbers and make them read-only.

        Args:
            times: see the class.
            joints: see the class.
            velocities: see the class; of all joints or none. Linear pieces have no use for them.
            base_positions: see the class.
            base_velocities: see the class; only with base positions.
            base_attitudes: see the class.
            interpolation: see the class.
            source: see the class.

        Raises:
            InvalidInput: numbers that are not finite or do not fit, times that do not increase, or
                another interpolation.
        """
        name = text("source", source)
        put = object.__setattr__
        put(self, "source", name)
        put(self, "times", checked_times(f"{name}, times", times))
        put(self, "joints", self._by_joint("joints", joints))
        rates = self._by_joint("velocities", {} if velocities is None else velocities)
        if rates and set(rates) != set(self.joints):
            given, allowed = sorted(rates), f"those of all joints: {', '.join(self.joints)}"
            raise InvalidInput(f"{name}, velocities", given, allowed)
        put(self, "velocities", rates)
        for field, value in (("positions", base_positions), ("velocities", base_velocities)):
            what, far = f"{name}, base_{field}", FARTHEST
            rows = None if value is None else finite_array(what, value, self._shape(3), far)
            put(self, f"base_{field}", rows)
        if self.base_velocities is not None and self.base_positions is None:
            raise InvalidInput(f"{name}, base_velocities", "given", "none without base_positions")
        put(self, "base_attitudes", self._attitudes(base_attitudes))
        put(self, "interpolation", one_of(f"{name}, interpolation", interpolation, INTERPOLATIONS))

    @classmethod
    def of_array(
        cls,
        times: ArrayLike,
        values: ArrayLike,
        names: Sequence[str],
        **more: Any,  # noqa: ANN401 - those of the class
    ) -> Trajectory:
        """A trajectory from an array with one column for each joint.

        Args:
            times: (N,) increasing [s].
            values: (N, n) joint values [rad or m].
            names: n names of the joints.
            more: further arguments of the class; `velocities` as an array (N, n) too.

        Raises:
            InvalidInput: see the class, or numbers of columns and names that differ.
        """
        more["joints"] = values
        if more.get("velocities") is None:
            more.pop("velocities", None)
        source = text("source", more.get("source", "trajectory"))
        for field in ("joints", "velocities"):
            if field in more:
                more[field] = _columns(f"{source}, {field}", more[field], names)
        return cls(times, more.pop("joints"), **more)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Trajectory):
            return NotImplemented
        return self is other or self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def __repr__(self) -> str:
        given = "".join(
            f", base {what}"
            for what, rows in (("moved", self.base_positions), ("turned", self.base_attitudes))
            if rows is not None
        )
        return (
            f"Trajectory({len(self.joints)} joints at {len(self.times)} times, "
            f"{self.duration:g} s, {self.interpolation}{given})"
        )

    @property
    def duration(self) -> float:
        """From the first to the last time [s]."""
        return float(self.times[-1] - self.times[0])

    @property
    def pieces(self) -> int:
        """Number of pieces between two times, N - 1."""
        return len(self.times) - 1

    def joint_array(self, names: Sequence[str], velocities: bool = False) -> Array:
        """(N, n) values, or velocities, of n joints in a given order [rad or m, or by s].

        Args:
            names: of the joints.
            velocities: whether their velocities are wanted.

        Raises:
            InvalidInput: joints that the trajectory lacks.
        """
        held = self.velocities if velocities else self.joints
        missing = [name for name in names if name not in held]
        if missing:
            raise unknown_name(f"{self.source}, missing joints", missing[0], held)
        rows: Array = np.column_stack([np.zeros((len(self.times), 0)), *(held[n] for n in names)])
        return rows

    def _shape(self, width: int) -> tuple[int, int]:
        return len(self.times), width

    def _by_joint(self, field: str, given: object) -> ReadOnlyDict[str, Array]:
        """Numbers (N,) by joint, checked."""
        what = f"{self.source}, {field}"
        if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
            raise InvalidInput(what, given, "a mapping from joint names to numbers of all times")
        return ReadOnlyDict(
            {
                name: finite_array(f"{what}, '{name}'", numbers, (len(self.times),), row="row")
                for name, numbers in given.items()
            }
        )

    def _attitudes(self, given: ArrayLike | None) -> Array | None:
        """(N, 4) unit quaternions, checked."""
        if given is None:
            return None
        what = f"{self.source}, base_attitudes"
        rows = finite_array(what, given, self._shape(4))
        return frozen(
            np.array([unit_quaternion(f"{what}, row {k}", q) for k, q in enumerate(rows)])
        )

    def _content(self) -> object:
        return content(
            (self.times, self.joints, self.velocities, self.base_positions, self.base_velocities,
             self.base_attitudes, self.interpolation)
        )  # fmt: skip


def checked_times(what: str, times: ArrayLike) -> Array:
    """Check the times of a trajectory.

    Args:
        what: name in the message.
        times: (N,) [s].

    Returns:
        Read-only copy.

    Raises:
        InvalidInput: fewer than two, not finite, or the first one that does not increase.
    """
    checked = finite_array(what, times, (-1,), row="row")
    if len(checked) < 2:
        raise InvalidInput(what, checked.tolist(), "at least two times [s]")
    late = np.flatnonzero(np.diff(checked) <= 0.0)
    if len(late):
        row = int(late[0]) + 1
        allowed = f"times that increase: more than {checked[row - 1]:.9g} s"
        raise InvalidInput(f"{what}, row {row}", float(checked[row]), allowed)
    return checked


def spline_rates(times: Array, values: Array) -> Array:
    """Rates (N, k) of the cubic spline through values (N, k) at times (N,), at rest at its ends."""
    rates: Array = CubicSpline(times, values, bc_type="clamped")(times, 1)
    return rates


def _columns(what: str, values: object, names: object) -> dict[str, Array]:
    """Columns of an array (N, n) by n names."""
    listed = np.asarray(names).tolist() if isinstance(names, np.ndarray) else names
    listed = list(listed) if isinstance(listed, (list, tuple)) else []
    if not listed or not all(isinstance(name, str) for name in listed):
        raise InvalidInput("names", names, "a list of joint names")
    if len(set(listed)) < len(listed):
        raise InvalidInput("names", names, "names that differ from one another")
    rows = finite_array(what, values, (-1, len(listed)))  # type: ignore[arg-type]
    return {str(name): rows[:, k] for k, name in enumerate(listed)}

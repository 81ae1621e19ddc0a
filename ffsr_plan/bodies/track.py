"""A motion that a table of poses gives, with a stated interpolation."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np

from ffsr_plan.bodies.body_motion import Poses
from ffsr_plan.bodies.track_files import read_track
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, unit_quaternion
from ffsr_plan.core.errors import InvalidInput, WideTurns
from ffsr_plan.core.setting_rules import Rule, Vector
from ffsr_plan.core.settings import settings

_WIDE, _WIDEST = np.radians(20.0), np.radians(90.0)  # turns of a row that are doubtful, or refused


@dataclass(frozen=True)
class Times(Rule):
    """Times (n,) from zero on, ascending, at least two [s]."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        times = finite_array(what, value, (-1,))  # type: ignore[arg-type]
        if len(times) < 2 or times[0] > 0.0 or np.any(np.diff(times) <= 0.0):
            allowed = "at least two times in ascending order, the first not after 0"
            raise InvalidInput(what, times.tolist(), allowed)
        return times

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "array", "items": {"type": "number"}, "minItems": 2}


@dataclass(frozen=True)
class Rows(Rule):
    """One row of numbers for each time.

    Attributes:
        width: numbers of a row; 4 for quaternions (xyzw), whose signs do not matter.
    """

    width: int

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        rows = finite_array(what, value, (-1, self.width), FARTHEST)  # type: ignore[arg-type]
        if "times" in others and len(rows) != len(others["times"]):
            raise InvalidInput(what, f"{len(rows)} rows", f"{len(others['times'])}, one a time")
        if self.width != 4:
            return rows
        turns = np.array([unit_quaternion(f"{what}.{k}", row) for k, row in enumerate(rows)])
        signs = np.where(np.sum(turns[1:] * turns[:-1], axis=1) < 0.0, -1.0, 1.0)
        turns[1:] *= np.cumprod(signs)[:, None]
        return frozen(turns)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        row = {"type": "array", "items": {"type": "number"}}
        return {"type": "array", "items": {**row, "minItems": self.width, "maxItems": self.width}}


@settings
class Track:
    """Poses in the world at given times, with a motion between them.

    Between two rows, positions move along a straight line at a constant speed, and attitudes turn
    at a constant rate the shorter way round.

    Attributes:
        times: (n,) ascending, the first not after 0 [s].
        positions: (n, 3) of the reference point, world axes [m].
        attitudes: (n, 4) of the body's axes in the world (xyzw).
    """

    tells_world_poses: ClassVar[bool] = True

    times: Annotated[Vector, Times()]
    positions: Annotated[Vector, Rows(3)]
    attitudes: Annotated[Vector, Rows(4)]

    def __post_init__(self) -> None:
        turns = self._turns
        widest = int(np.argmax(turns))
        degrees = float(np.degrees(turns[widest]))
        if turns[widest] > _WIDEST:
            where = f"attitudes, rows {widest} and {widest + 1}"
            raise InvalidInput(
                where, f"a turn of {degrees:.4g} degrees", "at most 90 degrees a row"
            )
        if turns[widest] > _WIDE:
            warnings.warn(
                f"a row of the table turns by {degrees:.3g} degrees: attitudes between the rows "
                "turn at a constant rate the shorter way round; more rows tell another way",
                WideTurns,
                stacklevel=3,
            )

    @cached_property
    def _turns(self) -> Array:
        """(n - 1,) angles between the rows [rad]."""
        return frozen(rotations.angle_between(self.attitudes[:-1], self.attitudes[1:]))

    @cached_property
    def _ways(self) -> tuple[Array, Array]:
        """(n,) path and (n,) angle since the first row, [m] and [rad]."""
        steps = np.linalg.norm(np.diff(self.positions, axis=0), axis=1)
        return tuple(  # type: ignore[return-value]
            np.concatenate([[0.0], np.cumsum(each)]) for each in (steps, self._turns)
        )

    @classmethod
    def from_csv(cls, path: str | Path) -> Track:
        """Read a comma-separated table with the columns t, x, y, z, qx, qy, qz and qw.

        Args:
            path: the file. A header such as `x [mm]` or `t [min]` gives a unit; the defaults are
                the second and the metre.

        Raises:
            InvalidInput: names file, line, column and value.
        """
        return cls(*read_track(path))

    @property
    def axis(self) -> Array | None:
        """None."""
        return None

    @property
    def known_until(self) -> float:
        """The last time of the table [s]."""
        return float(self.times[-1])

    @property
    def speeds(self) -> tuple[float, float]:
        """Greatest speed of the reference point [m/s] and angular speed [rad/s] of any row."""
        spans = np.diff(self.times)
        path, turned = (np.diff(each) / spans for each in self._ways)
        return float(path.max()), float(turned.max())

    def poses(self, times: Array) -> Poses:
        """Poses in the world at times (n,) [s]; see `BodyMotion`."""
        row = np.clip(np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 2)
        share = (times - self.times[row]) / np.diff(self.times)[row]
        step = np.diff(self.positions, axis=0)[row]
        turned = rotations.slerp(self.attitudes[row], self.attitudes[row + 1], share)
        return Poses(self.positions[row] + share[:, None] * step, turned)

    def path(self, begin: float, end: float) -> float:
        """Length of the reference point's path between two times [m]: exact."""
        ways = np.interp([begin, end], self.times, self._ways[0])
        return float(ways[1] - ways[0])

    def turned(self, begin: float, end: float) -> float:
        """Angle between two times, along the way [rad]: exact."""
        ways = np.interp([begin, end], self.times, self._ways[1])
        return float(ways[1] - ways[0])

    def later(self, time: float) -> Track:
        """The motion whose time zero is a later instant [s]; rows may then be before it."""
        return replace(self, times=self.times - time)

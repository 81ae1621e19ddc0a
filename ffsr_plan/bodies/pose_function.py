"""A motion that a function of time tells, with bounds on its speeds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.body_motion import Poses
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, finite_array, number, unit_quaternion
from ffsr_plan.core.errors import InvalidInput

PoseAt = Callable[[float], tuple[ArrayLike, ArrayLike]]


@dataclass(frozen=True)
class PoseFunction:
    """Poses in the world that a function tells, no faster than stated.

    Proofs rest on the stated speeds; `verify` compares them with sampled poses. A problem with it
    cannot be written to a file.

    Attributes:
        function: of the time [s]; returns position (3,) of the reference point, world axes [m],
            and attitude (4,) of the body's axes in the world (xyzw). It has to return the same for
            the same time.
        speed: bound on the speed of the reference point [m/s].
        turn_rate: bound on the angular speed [rad/s].
        known_until: time up to which it may be called [s].

    Raises:
        InvalidInput: something that cannot be called, or a speed that is not allowed.
    """

    tells_world_poses: ClassVar[bool] = True

    function: PoseAt
    speed: float
    turn_rate: float = 0.0
    known_until: float = math.inf

    def __post_init__(self) -> None:
        if not callable(self.function):
            allowed = "a function of the time that returns position and attitude"
            raise InvalidInput("function", self.function, allowed)
        for name in ("speed", "turn_rate"):
            number(name, getattr(self, name), at_least=0.0, at_most=FARTHEST)
        if not (isinstance(self.known_until, float) and self.known_until == math.inf):
            number("known_until", self.known_until, above=0.0)

    @property
    def axis(self) -> Array | None:
        """None."""
        return None

    @property
    def speeds(self) -> tuple[float, float]:
        """The stated speeds [m/s] and [rad/s]."""
        return self.speed, self.turn_rate

    def poses(self, times: Array) -> Poses:
        """Poses in the world at times (n,) [s]; see `BodyMotion`.

        Raises:
            InvalidInput: what the function returns is no pose, or two poses of successive times
                are farther apart than the stated speeds allow.
        """
        places, turns = np.empty((len(times), 3)), np.empty((len(times), 4))
        for k, time in enumerate(times.tolist()):
            told = self.function(time)
            if not isinstance(told, (tuple, list)) or len(told) != 2:
                raise InvalidInput(f"function({time:g})", told, "a position and an attitude")
            places[k] = finite_array(f"function({time:g}), position", told[0], (3,), FARTHEST)
            turns[k] = unit_quaternion(f"function({time:g}), attitude", told[1])
        self._check_speeds(times, places, turns)
        return Poses(places, turns)

    def path(self, begin: float, end: float) -> float:
        """Bound on the length of the reference point's path between two times [m]."""
        return self.speed * (end - begin)

    def turned(self, begin: float, end: float) -> float:
        """Bound on the angle between two times, along the way [rad]."""
        return self.turn_rate * (end - begin)

    def later(self, time: float) -> PoseFunction:
        """The motion whose time zero is a later instant [s]."""
        function = partial(_told_later, self.function, time)
        return replace(self, function=function, known_until=self.known_until - time)

    def _check_speeds(self, times: Array, places: Array, turns: Array) -> None:
        """Raise `InvalidInput` for poses that no motion of the stated speeds passes."""
        spans = np.abs(np.diff(times))
        steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
        dots = np.abs(np.sum(turns[1:] * turns[:-1], axis=1))
        angles = 2.0 * np.arccos(np.minimum(dots, 1.0))
        rounding = 1e-7  # of an arc cosine close to one [rad], and of metres far away
        for name, ways, most in (
            ("speed", steps, self.speed),
            ("turn_rate", angles, self.turn_rate),
        ):
            wrong = np.flatnonzero(ways > spans * most * (1.0 + 1e-9) + rounding)
            if len(wrong):
                k = int(wrong[0])
                found = float(ways[k] / spans[k]) if spans[k] else math.inf
                where = f"the {found:g} that the function shows at {times[k]:g} s, or more"
                raise InvalidInput(name, most, where)


def _told_later(function: PoseAt, by: float, time: float) -> tuple[ArrayLike, ArrayLike]:
    """What a function of the time tells at a later one [s]."""
    return function(time + by)

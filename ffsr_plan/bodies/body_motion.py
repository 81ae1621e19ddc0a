"""Motions of bodies in time: where a body is, and how far it can travel between two instants.

A motion tells the pose of a body's axes at any time, and bounds two lengths over an interval of
time: the path of the origin of these axes, its reference point, and the angle by which they turn. A
point of the body at a distance r from the reference point, or from the axis of a spin through it,
then travels at most by the path and r times the angle.
"""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, NamedTuple, Protocol

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST
from ffsr_plan.core.setting_rules import Numbers, Vector
from ffsr_plan.core.settings import setting, settings

_STILL = (0.0, 0.0, 0.0)


class Poses(NamedTuple):
    """Poses of a body at n times, relative to its pose at time zero.

    Attributes:
        positions: (n, 3) displacement of its reference point, world axes [m].
        attitudes: (n, 4) its axes then in its axes at time zero (xyzw).
    """

    positions: Array
    attitudes: Array


class BodyMotion(Protocol):
    """A motion of a body from time zero on.

    Attributes:
        tells_world_poses: whether its poses are in the world, and not relative to time zero.
    """

    tells_world_poses: ClassVar[bool]

    @property
    def axis(self) -> Array | None:
        """(3,) unit vector along an axis through the reference point that rests in the body.

        Points of it do not travel by rotation, so that distances from it count. None without one.
        """
        ...

    @property
    def known_until(self) -> float:
        """Time up to which it is known [s]."""
        ...

    @property
    def speeds(self) -> tuple[float, float]:
        """Bounds on the reference point's speed [m/s] and on the angular speed [rad/s]."""
        ...

    def poses(self, times: Array) -> Poses:
        """Poses at times (n,) [s]."""
        ...

    def path(self, begin: float, end: float) -> float:
        """Bound on the length of the reference point's path between two times [m]."""
        ...

    def turned(self, begin: float, end: float) -> float:
        """Bound on the angle that the body turns by, along its way, between two times [rad]."""
        ...

    def later(self, time: float) -> BodyMotion:
        """The motion whose time zero is a later instant [s]."""
        ...


@settings
class Drift:
    """Uniform translation; with velocity zero, rest.

    Attributes:
        velocity: (3,) world axes [m/s].
    """

    tells_world_poses: ClassVar[bool] = False

    velocity: Annotated[Vector, Numbers(3, FARTHEST)] = setting(default=_STILL)

    @property
    def axis(self) -> Array | None:
        """None."""
        return None

    @property
    def known_until(self) -> float:
        """Infinite."""
        return math.inf

    @property
    def speeds(self) -> tuple[float, float]:
        """Speed of the reference point [m/s], and zero."""
        return float(np.linalg.norm(self.velocity)), 0.0

    def poses(self, times: Array) -> Poses:
        """Poses at times (n,) [s]; see `BodyMotion`."""
        still = np.tile(rotations.IDENTITY, (len(times), 1))
        return Poses(times[:, None] * self.velocity, still)

    def path(self, begin: float, end: float) -> float:
        """Length of the reference point's path between two times [m]: exact."""
        return float(np.linalg.norm(self.velocity)) * (end - begin)

    def turned(self, begin: float, end: float) -> float:
        """Zero."""
        return 0.0

    def later(self, time: float) -> Drift:
        """The same motion: its velocity is constant."""
        return self


@settings
class Spin:
    """Rotation at a constant rate about an axis through the reference point, which may drift.

    Attributes:
        rate: (3,) angular velocity in the body's axes [rad/s].
        velocity: (3,) of the reference point, world axes [m/s].
    """

    tells_world_poses: ClassVar[bool] = False

    rate: Annotated[Vector, Numbers(3, FARTHEST)]
    velocity: Annotated[Vector, Numbers(3, FARTHEST)] = setting(default=_STILL)

    @property
    def axis(self) -> Array | None:
        """(3,) along the rate; None if that is zero."""
        speed = float(np.linalg.norm(self.rate))
        return self.rate / speed if speed > 0.0 else None

    @property
    def known_until(self) -> float:
        """Infinite."""
        return math.inf

    @property
    def speeds(self) -> tuple[float, float]:
        """Speed of the reference point [m/s] and angular speed [rad/s]."""
        return float(np.linalg.norm(self.velocity)), float(np.linalg.norm(self.rate))

    def poses(self, times: Array) -> Poses:
        """Poses at times (n,) [s]; see `BodyMotion`."""
        return Poses(times[:, None] * self.velocity, rotations.exp(times[:, None] * self.rate))

    def path(self, begin: float, end: float) -> float:
        """Length of the reference point's path between two times [m]: exact."""
        return float(np.linalg.norm(self.velocity)) * (end - begin)

    def turned(self, begin: float, end: float) -> float:
        """Angle between two times [rad]: exact."""
        return float(np.linalg.norm(self.rate)) * (end - begin)

    def later(self, time: float) -> Spin:
        """The same motion: its rate is constant in the body's axes."""
        return self

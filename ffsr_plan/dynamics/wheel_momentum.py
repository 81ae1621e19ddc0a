"""Angular momentum of reaction wheels that hold the attitude.

Thrusters act through the centre of mass and exert no moment about it. The robot starts at rest with
zero wheel momentum. So the wheel momentum is minus the angular momentum of base and arms about the
centre of mass at any time. Along a path it is a momentum per unit of path, the map of
`momentum.angular_maps` times the rotation and joint steps; a time law turns it into N m s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, equal_by_content
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.momentum import angular_maps
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.kinematics import turned

_SAMPLES = 1001  # default number of times; the error of a smooth peak is about 1e-5 of it


@equal_by_content
class WheelMomentum(NamedTuple):
    """Angular momentum stored in the wheels at N times.

    It is the wheels' own momentum, minus that of base and arms. The wheels' torque on the base is
    minus its derivative in world axes.

    Attributes:
        times: (N,) [s].
        parameters: (N,) path parameters s in [0, 1], as in `Plan.at`.
        vectors: (N, 3) base axes, in which wheels are mounted [N m s].
        world: (N, 3) the same in world axes [N m s].
    """

    times: Array
    parameters: Array
    vectors: Array
    world: Array

    @property
    def axis_peaks(self) -> Array:
        """(3,) largest magnitude about each base axis, over the times [N m s]."""
        peaks: Array = np.max(np.abs(self.vectors), axis=0)
        return peaks

    @property
    def peak(self) -> float:
        """Largest norm over the times [N m s]."""
        return float(np.max(np.linalg.norm(self.vectors, axis=1)))


def wheel_momentum(
    motion: Motion, duration: float, times: ArrayLike | None = None
) -> WheelMomentum:
    """Wheel momentum of a motion with a quintic time law from rest to rest.

    Args:
        motion: a motion whose attitude is held by wheels.
        duration: duration of the motion [s].
        times: (N,) times from 0 to the duration [s]; by default 1001 equally spaced ones.

    Returns:
        The momentum at these times, in base and world axes.

    Raises:
        InvalidInput: a motion without wheels, a duration that is not positive, or times outside
            the motion.
    """
    if motion.mode.attitude_reacts:
        raise InvalidInput(
            "wheel_momentum: mode", motion.mode, "'attitude-held'; other modes have no wheels"
        )
    duration = number("duration", duration, above=0.0)
    instants = np.linspace(0.0, duration, _SAMPLES)
    if times is not None:
        instants = _checked_times(times, duration)
    s, rate = rest_to_rest(instants / duration)
    edge = np.minimum((s * motion.edges).astype(np.int64), motion.edges - 1)
    time = s * motion.edges - edge
    edge_rate = rate * motion.edges / duration
    stored = -edge_rate[:, None] * momentum_along(motion, edge, time)
    pose = rotations.matrix(motion.at(edge, time)[:, 3:7])
    return WheelMomentum(instants, s, stored, turned(pose, stored))


def rest_to_rest(u: Array) -> tuple[Array, Array]:
    """The quintic law s = 10 u^3 - 15 u^4 + 6 u^5, with s' = s'' = 0 at both ends.

    Args:
        u: (N,) time as a share of the duration, in [0, 1].

    Returns:
        (N,) s, and (N,) its rate ds/du, at most 15/8 (at u = 1/2).
    """
    s = np.minimum(u**3 * (10.0 + u * (6.0 * u - 15.0)), 1.0)
    return s, 30.0 * (u * (1.0 - u)) ** 2


def momentum_along(motion: Motion, edge: IntArray, time: Array) -> Array:
    """(N, 3) momentum of base and arms about the centre of mass, base axes [kg m^2 rad / edge]."""
    steps = np.diff(motion.joint_values, axis=0)[edge]
    maps = angular_maps(motion.robot, motion.joint_values[edge] + time[:, None] * steps)
    return turned(maps, np.concatenate([motion.turns[edge], steps], axis=1))


def _checked_times(times: ArrayLike, duration: float) -> Array:
    checked = finite_array("times", times, (-1,))
    if checked.size == 0 or np.any((checked < 0.0) | (checked > duration)):
        raise InvalidInput("times", times, f"at least one time, all from 0 to {duration:g} s")
    return checked


__all__ = ["WheelMomentum", "rest_to_rest", "wheel_momentum"]

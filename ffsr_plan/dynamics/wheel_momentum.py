"""What the wheels must store where they hold the attitude.

Thrusters act through the centre of mass, so they turn nothing; the robot starts at rest with
nothing stored. Hence the wheels store, at any time, the opposite of the angular momentum that base
and arms have about the centre of mass. Along a path that is a momentum per unit of path, the map of
`momentum.angular_maps` times turn and joint steps; a time law makes it N m s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.momentum import angular_maps
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.kinematics import turned

_SAMPLES = 1001  # a smooth peak is missed by some 1e-5 of its height


class WheelMomentum(NamedTuple):
    """Angular momentum stored in the wheels at N times.

    Its sign: the wheels' own, the opposite of that of base and arms. Their torque on the base is
    minus its derivative in world axes.
    """

    times: Array
    """(N,) [s]."""
    parameters: Array
    """(N,) path parameters s in [0, 1], as `Plan.at` takes them."""
    vectors: Array
    """(N, 3) base axes, as wheels are mounted [N m s]."""
    world: Array
    """(N, 3) the same in world axes [N m s]."""

    @property
    def axis_peaks(self) -> Array:
        """(3,) largest magnitude about each base axis, over the times [N m s]."""
        return np.asarray(np.max(np.abs(self.vectors), axis=0))

    @property
    def peak(self) -> float:
        """Largest norm over the times [N m s]."""
        return float(np.max(np.linalg.norm(self.vectors, axis=1)))


def wheel_momentum(
    motion: Motion, duration: float, times: ArrayLike | None = None
) -> WheelMomentum:
    """See `Plan.wheel_momentum`."""
    if motion.mode.attitude_reacts:
        raise InvalidInput(
            "wheel_momentum: mode", motion.mode, "'attitude-held'; otherwise there are no wheels"
        )
    duration = number("duration", duration, above=0.0)
    clock = np.linspace(0.0, duration, _SAMPLES) if times is None else _clock(times, duration)
    s, rate = rest_to_rest(clock / duration)
    edge = np.minimum((s * motion.edges).astype(np.int64), motion.edges - 1)
    time = s * motion.edges - edge
    edge_rate = rate * motion.edges / duration
    stored = -edge_rate[:, None] * _momentum_along(motion, edge, time)
    pose = rotations.matrix(motion.at(edge, time)[:, 3:7])
    return WheelMomentum(clock, s, stored, turned(pose, stored))


def rest_to_rest(u: Array) -> tuple[Array, Array]:
    """The law s = 10 u^3 - 15 u^4 + 6 u^5 and ds/du, u in [0, 1]; s' = s'' = 0 at both ends.

    The rate is largest in the middle, 15/8.
    """
    s = np.minimum(u**3 * (10.0 + u * (6.0 * u - 15.0)), 1.0)
    return s, 30.0 * (u * (1.0 - u)) ** 2


def _momentum_along(motion: Motion, edge: IntArray, time: Array) -> Array:
    """(N, 3) of base and arms about the centre of mass, base axes [kg m^2 rad per edge]."""
    steps = np.diff(motion.joint_values, axis=0)[edge]
    maps = angular_maps(motion.robot, motion.joint_values[edge] + time[:, None] * steps)
    turns = np.broadcast_to(motion.turn, (len(edge), 3))
    return turned(maps, np.concatenate([turns, steps], axis=1))


def _clock(times: ArrayLike, duration: float) -> Array:
    clock = finite_array("times", times, (-1,))
    if clock.size == 0 or np.any((clock < 0.0) | (clock > duration)):
        raise InvalidInput("times", times, f"at least one time, all from 0 to {duration:g} s")
    return clock


__all__ = ["WheelMomentum", "rest_to_rest", "wheel_momentum"]

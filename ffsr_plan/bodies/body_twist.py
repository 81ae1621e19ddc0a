"""The twist of a body that moves: velocity of its reference point, and angular velocity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput


class BodyState(NamedTuple):
    """Pose and twist of a body at a time, world axes.

    Attributes:
        position: (3,) of its reference point [m].
        attitude: (4,) of its axes (xyzw).
        velocity: (3,) of its reference point [m/s].
        angular_velocity: (3,) [rad/s].
    """

    position: Array
    attitude: Array
    velocity: Array
    angular_velocity: Array

    def velocity_at(self, place: Array) -> Array:
        """(3,) velocity of the point of the body that is at a place (3,) in the world [m/s]."""
        return np.asarray(self.velocity + np.cross(self.angular_velocity, place - self.position))


def body_state(body: MovingBody, time: float) -> BodyState:
    """Pose and twist of a body.

    Args:
        body: the body; of a `Track` the row counts that ends at the time, or goes on after it.
        time: [s].

    Raises:
        InvalidInput: a time that the motion does not know, or a function, which tells no velocity.
    """
    (position,), (attitude,) = body.poses([time])
    motion, still = body.motion, np.zeros(3)
    if isinstance(motion, Drift):
        return BodyState(position, attitude, motion.velocity, still)
    if isinstance(motion, (Spin, Tumble)):
        rate = motion.rate if isinstance(motion, Spin) else motion.rates(np.array([time]))[0]
        return BodyState(position, attitude, motion.velocity, rotations.rotate(attitude, rate))
    if isinstance(motion, Track):
        row = int(np.searchsorted(motion.times, time)) - 1
        row = min(max(row, 0), len(motion.times) - 2)
        span = motion.times[row + 1] - motion.times[row]
        velocity = (motion.positions[row + 1] - motion.positions[row]) / span
        begin, end = motion.attitudes[row : row + 2]
        turn = rotations.log(rotations.multiply(rotations.inverse(begin), end)) / span
        return BodyState(position, attitude, velocity, rotations.rotate(begin, turn))
    allowed = "a Drift, Spin, Tumble or Track, whose velocity is known"
    raise InvalidInput(f"motion of body '{body.name}'", type(motion).__name__, allowed)

"""Where bodies are, and bounds on how far they travel between two times, by motion.

Only what describes a motion is read, none of what the planner derives from it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

import numpy as np

from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array, unit_quaternion
from ffsr_plan.verification.moving_bodies.free_rotation import FreeRotation
from ffsr_plan.verification.moving_bodies.turns import angles_between, turns_by, turns_of


class BodyCourse(Protocol):
    """The motion of one body.

    Attributes:
        error: by how much its poses may be off [rad] and [m], beside rounding.
    """

    error: float

    def poses(self, times: Array) -> tuple[Array, Array]:
        """Positions (N, 3) of the reference point [m] and rotations (N, 3, 3), in the world."""

    def twist(self, time: float) -> tuple[Array, Array]:
        """Velocity (3,) of the reference point [m/s], angular velocity (3,) [rad/s], world axes."""

    def paths(self, begins: Array, ends: Array) -> Array:
        """(N,) bounds on the path of the reference point in intervals of time [m]."""

    def angles(self, begins: Array, ends: Array) -> Array:
        """(N,) bounds on the angle turned, along the way, in intervals of time [rad]."""


def course_of(body: MovingBody, until: float) -> BodyCourse:
    """The motion of a body.

    Args:
        body: the body.
        until: time up to which it is asked for [s].

    Raises:
        IntegrationError: a tumble that cannot be integrated accurately.
    """
    motion = body.motion
    if isinstance(motion, (Drift, Spin)):
        rate = motion.rate if isinstance(motion, Spin) else np.zeros(3)
        return _Uniform(body, motion.velocity, rate)
    if isinstance(motion, Tumble):
        return _Tumbling(body, motion, until)
    if isinstance(motion, Track):
        return _Tabulated(motion)
    if isinstance(motion, PoseFunction):
        return _Told(motion, body.name)
    raise TypeError(f"no poses of a {type(motion).__name__}")


class _Uniform:
    """Translation at one velocity and rotation at one rate, which is fixed in the body."""

    error = 0.0

    def __init__(self, body: MovingBody, velocity: Array, rate: Array) -> None:
        self._begin, self._turn = body.position, turns_of(body.attitude[None])[0]
        self._velocity, self._rate = velocity, rate

    def poses(self, times: Array) -> tuple[Array, Array]:
        places = self._begin + times[:, None] * self._velocity
        return places, self._turn @ turns_by(times[:, None] * self._rate)

    def twist(self, time: float) -> tuple[Array, Array]:
        return self._velocity, self._turn @ self._rate

    def paths(self, begins: Array, ends: Array) -> Array:
        return np.asarray(float(np.linalg.norm(self._velocity)) * (ends - begins))

    def angles(self, begins: Array, ends: Array) -> Array:
        return np.asarray(float(np.linalg.norm(self._rate)) * (ends - begins))


class _Tumbling(_Uniform):
    """Translation at one velocity, and rotation without torque."""

    def __init__(self, body: MovingBody, motion: Tumble, until: float) -> None:
        super().__init__(body, motion.velocity, np.zeros(3))
        self._rotation = _free_rotation(motion.inertia.tobytes(), motion.rate.tobytes(), until)
        self.error = self._rotation.error

    def poses(self, times: Array) -> tuple[Array, Array]:
        places, _ = super().poses(times)
        return places, self._turn @ self._rotation.states(times)[1]

    def twist(self, time: float) -> tuple[Array, Array]:
        rates, turns = self._rotation.states(np.array([time]))
        return self._velocity, self._turn @ turns[0] @ rates[0]

    def angles(self, begins: Array, ends: Array) -> Array:
        return self._rotation.angles(begins, ends)


@lru_cache(maxsize=8)
def _free_rotation(inertia: bytes, rate: bytes, until: float) -> FreeRotation:
    """The rotation of the bytes of (3, 3) and (3,): one verification asks for it more than once."""
    return FreeRotation(np.frombuffer(inertia).reshape(3, 3), np.frombuffer(rate), until)


class _Tabulated:
    """Straight lines and turns at constant rates between the rows of a table."""

    error = 0.0

    def __init__(self, table: Track) -> None:
        self._times, self._places = table.times, table.positions
        turns = turns_of(table.attitudes)
        self._turns = turns[:-1]
        steps = np.swapaxes(turns[:-1], 1, 2) @ turns[1:]
        # half a turn or more between two rows is refused when the table is made
        odd = np.stack([steps[:, 2, 1], steps[:, 0, 2], steps[:, 1, 0]], axis=1)
        odd -= np.stack([steps[:, 1, 2], steps[:, 2, 0], steps[:, 0, 1]], axis=1)
        angles, sizes = angles_between(turns[:-1], turns[1:]), np.linalg.norm(odd, axis=1)
        self._vectors = odd * (angles / np.where(sizes > 0.0, sizes, 1.0))[:, None]
        ways = np.linalg.norm(np.diff(table.positions, axis=0), axis=1)
        self._ways = np.concatenate([[0.0], np.cumsum(ways)])
        self._angles = np.concatenate([[0.0], np.cumsum(angles)])

    def poses(self, times: Array) -> tuple[Array, Array]:
        row = np.clip(np.searchsorted(self._times, times) - 1, 0, len(self._turns) - 1)
        share = (times - self._times[row]) / (self._times[row + 1] - self._times[row])
        places = [np.interp(times, self._times, column) for column in self._places.T]
        turned = turns_by(share[:, None] * self._vectors[row])
        return np.stack(places, axis=1), self._turns[row] @ turned

    def twist(self, time: float) -> tuple[Array, Array]:
        row = int(np.clip(np.searchsorted(self._times, time) - 1, 0, len(self._turns) - 1))
        span = self._times[row + 1] - self._times[row]
        way = self._places[row + 1] - self._places[row]
        return way / span, self._turns[row] @ self._vectors[row] / span

    def paths(self, begins: Array, ends: Array) -> Array:
        return self._run(self._ways, begins, ends)

    def angles(self, begins: Array, ends: Array) -> Array:
        return self._run(self._angles, begins, ends)

    def _run(self, ways: Array, begins: Array, ends: Array) -> Array:
        """What is run between two times: speeds are constant from row to row."""
        until, since = (np.interp(times, self._times, ways) for times in (ends, begins))
        return np.asarray(until - since)


class _Told:
    """Poses that a function tells; its speeds are as stated, or `SceneBodies.excess` shows it."""

    error = 0.0

    def __init__(self, motion: PoseFunction, name: str) -> None:
        self._motion, self._name = motion, name

    def poses(self, times: Array) -> tuple[Array, Array]:
        places, quaternions = np.empty((len(times), 3)), np.empty((len(times), 4))
        for k, time in enumerate(times.tolist()):
            place, attitude = self._motion.function(time)
            what = f"motion of body '{self._name}' at {time:g} s"
            places[k] = finite_array(f"{what}, position", place, (3,))
            quaternions[k] = unit_quaternion(f"{what}, attitude", attitude)
        return places, turns_of(quaternions)

    def twist(self, time: float) -> tuple[Array, Array]:
        raise TypeError("a function tells no velocity, and is not met")

    def paths(self, begins: Array, ends: Array) -> Array:
        return np.asarray(self._motion.speed * (ends - begins))

    def angles(self, begins: Array, ends: Array) -> Array:
        return np.asarray(self._motion.turn_rate * (ends - begins))

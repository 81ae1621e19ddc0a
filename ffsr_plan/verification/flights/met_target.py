"""The moving body that a flight meets or leaves, by code of its own: axes, and who may touch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.meetings.departure import Departure
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.motion_samples import MayTouch
from ffsr_plan.verification.moving_bodies.body_courses import course_of

_LOOKS = np.array([0.0, 0.25, 0.5, 0.75])  # shares of a piece of the law


class TargetAxes(NamedTuple):
    """The axes that a meeting is told in.

    Attributes:
        place: (3,) their origin, world [m].
        turn: (3, 3) their rotation in the world.
        velocity: (3,) of the origin, world axes [m/s].
        angular_velocity: (3,) world axes [rad/s].
        error: by how much they may be off [m], [rad].
    """

    place: Array
    turn: Array
    velocity: Array
    angular_velocity: Array
    error: float


def target_axes(flight: Flown, meeting: Meeting) -> TargetAxes:
    """The target's axes on arrival; without a target those of the world.

    Raises:
        IntegrationError: a tumble that cannot be integrated accurately.
    """
    if meeting.target is None:
        return TargetAxes(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3), 0.0)
    course = course_of(flight.problem.scene.bodies[_number(flight, meeting)], meeting.at)
    time = np.array([meeting.at])
    places, turns = course.poses(time)
    return TargetAxes(places[0], turns[0], *course.twist(meeting.at), course.error)


def may_touch(flight: Flown) -> MayTouch | None:
    """Which links may touch the target, and from when or until when; None where none may.

    All that time the frame is near its place on the target, as the samples of the law show.

    Args:
        flight: the flight.
    """
    leaves, meeting = flight.departure is not None, flight.departure or flight.meeting
    if meeting is None or meeting.frame is None or not meeting.links:
        return None
    number = _number(flight, meeting)
    course = course_of(flight.problem.scene.bodies[number], flight.duration)
    ends = flight.switch_times
    times = np.append((ends[:-1, None] + np.diff(ends)[:, None] * _LOOKS).ravel(), ends[-1])
    places, turns = course.poses(times)
    origins = frame_origins(flight, meeting.frame, times)
    own = np.einsum("nji,nj->ni", turns, origins - places)
    apart = np.linalg.norm(own - own[0 if leaves else -1], axis=1)
    far = np.flatnonzero(apart > meeting.within)
    if leaves:
        until = float(ends[(int(far[0]) - 1) // len(_LOOKS)]) if len(far) else np.inf
        return MayTouch(meeting.links, number + 1, -np.inf, until)
    piece = int(far[-1]) // len(_LOOKS) + 1 if len(far) else 0
    since = float(ends[min(piece, len(ends) - 1)])
    return MayTouch(meeting.links, number + 1, since, np.inf)


def frame_origins(flight: Flown, frame: str, times: Array) -> Array:
    """(N, 3) origins of a frame at times (N,), world [m], by Pinocchio's kinematics."""
    model = flight.problem.robot.model
    data, number = model.createData(), model.getFrameId(frame)
    found = np.empty((len(times), 3))
    for row, q in zip(found, flight.at(times).configurations, strict=True):
        pin.forwardKinematics(model, data, q)
        row[:] = pin.updateFramePlacement(model, data, number).translation
    return found


def _number(flight: Flown, meeting: Meeting | Departure) -> int:
    return [body.name for body in flight.problem.scene.bodies].index(str(meeting.target))

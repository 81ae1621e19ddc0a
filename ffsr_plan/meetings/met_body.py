"""The moving body that a frame meets or leaves, and the links that may touch it there."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import pinocchio as pin

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.proof.moving_obstacles import Touching
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

_LOOKS = 8  # at each piece of a curve, for the place from which the frame stays near


class AtTarget(Protocol):
    """A meeting or a departure."""

    @property
    def word(self) -> str:
        """What errors call it."""

    @property
    def frame(self) -> str | None:
        """Name of the frame; None for none, and then no links either."""

    @property
    def target(self) -> str | None:
        """Name of the moving body; None for none."""

    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links that may touch it."""

    @property
    def within(self) -> float:
        """Distance of the frame from its place on the target within which they may [m]."""


def met_body(meeting: AtTarget, scene: Scene) -> int | None:
    """The number of the moving body that is met or left; None if none is named.

    Args:
        meeting: the meeting, or the departure.
        scene: the obstacles.

    Raises:
        InvalidInput: no body of that name, or several.
    """
    if meeting.target is None:
        return None
    names = [body.name for body in scene.bodies]
    if names.count(meeting.target) != 1:
        known = ", ".join(repr(name) for name in names if name) or "none of the scene has one"
        allowed = f"the name of one moving body of the scene: {known}"
        raise InvalidInput(f"{meeting.word}.target", meeting.target, allowed)
    return names.index(meeting.target)


def touching_links(
    meeting: AtTarget, scene: Scene, curve: CurvedMotion, times: Timetable, *, leaves: bool = False
) -> Touching | None:
    """Which shapes may touch the target, and on which pieces of a curve.

    On all these the frame is within `meeting.within` of its place on the target on arrival, or at
    the begin of a departure.

    Args:
        meeting: the meeting, or the departure.
        scene: the obstacles.
        curve: a curve that meets, or leaves.
        times: at which it is where.
        leaves: whether it leaves.

    Raises:
        InvalidInput: a link without a shape for collisions.
    """
    number = met_body(meeting, scene)
    if number is None or meeting.frame is None or not meeting.links:
        return None
    shapes = _shapes_of(curve.robot, meeting)
    own = _on_target(meeting.frame, scene.bodies[number], curve, times)
    apart = np.linalg.norm(own - own[0 if leaves else -1], axis=1)
    far = np.flatnonzero(apart > meeting.within)
    if leaves:
        last = (int(far[0]) - 1) // _LOOKS if len(far) else curve.edges
        return Touching.until(number, shapes, last, curve.edges)
    first = int(far[-1]) // _LOOKS + 1 if len(far) else 0
    return Touching.since(number, shapes, min(first, curve.edges), curve.edges)


def _on_target(frame: str, body: MovingBody, curve: CurvedMotion, times: Timetable) -> Array:
    """(n, 3) where the frame is in the target's axes, along a curve [m]."""
    places = np.arange(curve.edges * _LOOKS + 1.0) / _LOOKS
    edge = np.minimum(places.astype(np.int64), curve.edges - 1)
    origins = _origins(curve.robot, frame, curve.at(edge, places - edge))
    poses = body.poses(times.instants(places))
    return rotations.rotate(rotations.inverse(poses.attitudes), origins - poses.positions)


def _origins(robot: SpaceRobot, frame: str, configurations: Array) -> Array:
    """(n, 3) origins of a frame at configurations (n, nq), world [m]."""
    model, found = robot.model, np.empty((len(configurations), 3))
    data, number = model.createData(), frame_index(model, frame)
    for row, q in zip(found, configurations, strict=True):
        pin.forwardKinematics(model, data, q)
        row[:] = pin.updateFramePlacement(model, data, number).translation
    return found


def _shapes_of(robot: SpaceRobot, meeting: AtTarget) -> Flags:
    """(g,) whether each shape belongs to one of the links that may touch the target."""
    owners = [robot.link_of(shape) for shape in robot.collision_model.geometryObjects]
    for link in meeting.links:
        if link not in owners:
            allowed = f"links with a shape for collisions: {', '.join(dict.fromkeys(owners))}"
            raise InvalidInput(f"{meeting.word}.links", link, allowed)
    return np.array([owner in meeting.links for owner in owners])

"""The moving body that a frame meets, and the links that may touch it on arrival."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.proof.moving_obstacles import Touching
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

_LOOKS = 8  # at each piece of a curve, for the place from which the frame stays near


def met_body(meeting: Meeting, scene: Scene) -> int | None:
    """The number of the moving body that is met; None if the meeting names none.

    Raises:
        InvalidInput: no body of that name, or several.
    """
    if meeting.target is None:
        return None
    names = [body.name for body in scene.bodies]
    if names.count(meeting.target) != 1:
        known = ", ".join(repr(name) for name in names if name) or "none of the scene has one"
        allowed = f"the name of one moving body of the scene: {known}"
        raise InvalidInput("meeting.target", meeting.target, allowed)
    return names.index(meeting.target)


def touching_links(
    meeting: Meeting, scene: Scene, curve: CurvedMotion, times: Timetable
) -> Touching | None:
    """Which shapes may touch the target, and from which piece of a curve on.

    From there to the end the frame is within `meeting.within` of its place on the target.

    Args:
        meeting: the meeting.
        scene: the obstacles.
        curve: a curve that meets.
        times: at which it is where.

    Raises:
        InvalidInput: a link without a shape for collisions.
    """
    number = met_body(meeting, scene)
    if number is None or not meeting.links:
        return None
    shapes = _shapes_of(curve.robot, meeting.links)
    apart = _apart(meeting, scene.bodies[number], curve, times)
    far = np.flatnonzero(apart > meeting.within)
    first = int(far[-1]) // _LOOKS + 1 if len(far) else 0
    return Touching(number, shapes, min(first, curve.edges))


def _apart(meeting: Meeting, body: MovingBody, curve: CurvedMotion, times: Timetable) -> Array:
    """(n,) distances of the frame from where it is on the target in the end, along a curve [m]."""
    places = np.arange(curve.edges * _LOOKS + 1.0) / _LOOKS
    edge = np.minimum(places.astype(np.int64), curve.edges - 1)
    origins = _origins(curve.robot, meeting.frame, curve.at(edge, places - edge))
    poses = body.poses(times.instants(places))
    own = rotations.rotate(rotations.inverse(poses.attitudes), origins - poses.positions)
    return np.asarray(np.linalg.norm(own - own[-1], axis=1))


def _origins(robot: SpaceRobot, frame: str, configurations: Array) -> Array:
    """(n, 3) origins of a frame at configurations (n, nq), world [m]."""
    model, found = robot.model, np.empty((len(configurations), 3))
    data, number = model.createData(), frame_index(model, frame)
    for row, q in zip(found, configurations, strict=True):
        pin.forwardKinematics(model, data, q)
        row[:] = pin.updateFramePlacement(model, data, number).translation
    return found


def _shapes_of(robot: SpaceRobot, links: tuple[str, ...]) -> Flags:
    """(g,) whether each shape belongs to one of the links."""
    owners = [robot.link_of(shape) for shape in robot.collision_model.geometryObjects]
    for link in links:
        if link not in owners:
            known = ", ".join(dict.fromkeys(owners))
            raise InvalidInput("meeting.links", link, f"links with a shape for collisions: {known}")
    return np.array([owner in links for owner in owners])

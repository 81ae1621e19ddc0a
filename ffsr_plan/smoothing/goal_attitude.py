"""Control points whose curve ends with the goal attitude.

A smooth joint path encloses another area than its polygon, so that the base arrives with another
attitude, by some tenths of a degree. The least displacement of the control points that makes up for
it is found by Newton's method with the slopes of the polygon, which hardly differ from the curve's.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.curves.control_points import ControlPoints
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.attitude_correction import attitude_slopes, within_limits
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction

_ITERATIONS = 30
_TOLERANCE = 1e-9  # [rad]


def curve_to_attitude(motion: Motion, control: ControlPoints, goal: Array) -> CurvedMotion | None:
    """The curve whose reaction ends at an attitude; None without convergence.

    Joints that do not move along the control points stay at rest.

    Args:
        motion: the motion that is smoothed; its base reacts.
        control: control points of a curve that ends close to the attitude.
        goal: (4,) attitude to end with (xyzw).
    """
    robot, joints = motion.robot, control.joint_values
    curve = CurvedMotion(motion, control)
    missed = _missed(curve, goal)
    if np.linalg.norm(missed) < _TOLERANCE:
        return curve
    moving = np.flatnonzero(np.ptp(joints, axis=0) > 0.0)
    directions = np.tile(np.eye(robot.nd)[moving], (len(joints), 1, 1))
    if len(joints) < 3 or not len(moving):
        return None
    slope = attitude_slopes(robot, joints, directions, Reaction.along(robot, joints).increments)
    free = np.ones(directions[1:-1].shape[:2], dtype=np.bool_)
    for _ in range(_ITERATIONS):
        inner = within_limits(robot, joints[1:-1], directions[1:-1], slope, missed, free)
        if inner is None:
            return None
        joints = np.vstack([joints[:1], inner, joints[-1:]])
        curve = CurvedMotion(motion, control._replace(joint_values=joints))
        rest = _missed(curve, goal)
        if np.linalg.norm(rest) < _TOLERANCE:
            return curve
        if np.linalg.norm(rest) > 0.9 * np.linalg.norm(missed):
            return None
        missed = rest
    return None


def _missed(curve: CurvedMotion, goal: Array) -> Array:
    """(3,) rotation from the end of a curve to an attitude, in the end's axes [rad]."""
    reached = curve.attitudes[-1]
    return rotations.log(rotations.multiply(rotations.inverse(reached), goal))

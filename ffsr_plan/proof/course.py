"""A motion among obstacles as arrays for the compiled proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.rotations import IDENTITY, rotate
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.scene.scene import Scene

if TYPE_CHECKING:
    from ffsr_plan.proof.kernels.course import Course


def course_of(motion: Motion, scene: Scene, travel: EdgeTravel) -> Course:
    """The arrays of a motion.

    Args:
        motion: the motion that offsets are counted from.
        scene: at least one obstacle.
        travel: travel bounds along the motion.
    """
    from ffsr_plan.proof.kernels.course import Attitudes, Course
    from ffsr_plan.proof.kernels.travel import Travel

    robot, reacts = motion.robot, motion.mode.attitude_reacts
    whole, straight = travel.over(0.0, 1.0)
    positions = motion.positions
    if motion.mode.floats:
        center = centers_of_mass(robot, motion.joint_values[:1])[0]
        center = motion.positions[0] + rotate(motion.attitudes[0], center)
        positions = np.tile(center, (len(positions), 1))
    reaction = motion.reaction if reacts else _still(motion)
    each = reacts and not motion.joints_are_straight
    return Course(
        robot.bodies,
        robot.primitives,
        travel.points,
        scene.tree,
        travel.base,
        Attitudes(
            np.ascontiguousarray(motion.attitudes[: motion.edges if each else 1]),
            np.zeros(3) if reacts else np.array(motion.turn),
            reaction.partial,
        ),
        np.ascontiguousarray(positions),
        motion.joint_values,
        Travel(*whole[:5]),
        straight,
    )


def course_in_base(motion: Motion, travel: EdgeTravel) -> Course:
    """The arrays of a motion as seen from the base, without obstacles.

    Args:
        motion: the motion.
        travel: travel bounds along it.
    """
    from ffsr_plan.proof.kernels.course import Attitudes, Course
    from ffsr_plan.proof.kernels.travel import BaseMotion, Travel

    whole, straight = travel.over(0.0, 1.0, in_base=True)
    return Course(
        motion.robot.bodies,
        motion.robot.primitives,
        travel.points,
        Scene().tree,
        BaseMotion(False, False, np.zeros(3), 0.0),
        Attitudes(IDENTITY[None].copy(), np.zeros(3), _still(motion).partial),
        np.zeros_like(motion.positions),
        motion.joint_values,
        Travel(*whole[:5]),
        straight,
    )


def _still(motion: Motion) -> Reaction:
    """A reaction to no motion, for arrays of the same kind."""
    begin = motion.joint_values[:1]
    return Reaction(motion.robot, begin, np.zeros_like(begin))

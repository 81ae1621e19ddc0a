"""A motion among obstacles as arrays for the compiled proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.rotations import IDENTITY, rotate
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.kernels.pieces import ROWS, Pieces
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.scene.scene import Scene

if TYPE_CHECKING:
    from ffsr_plan.proof.kernels.course import Course
    from ffsr_plan.proof.kernels.passage import Passage


def course_of(
    motion: Motion | CurvedMotion, scene: Scene, travel: EdgeTravel, passage: Passage | None = None
) -> Course:
    """The arrays of a motion.

    Args:
        motion: the motion that offsets are counted from.
        scene: at least one obstacle.
        travel: travel bounds along the motion.
        passage: the body that the obstacles are shapes of, if it moves.
    """
    from ffsr_plan.proof.kernels.course import Course
    from ffsr_plan.proof.kernels.passage import no_passage

    robot, reacts = motion.robot, motion.mode.attitude_reacts
    whole, straight = travel.over(0.0, 1.0)
    if isinstance(motion, CurvedMotion):
        positions, pieces = np.zeros((motion.edges + 1, 3)), motion.pieces
    else:
        positions, pieces = motion.positions, straight_pieces(robot.nd)
        if motion.mode.floats:
            center = centers_of_mass(robot, motion.joint_values[:1])[0]
            center = motion.positions[0] + rotate(motion.attitudes[0], center)
            positions = np.tile(center, (len(positions), 1))
    reaction = (motion.reaction if reacts else None) or _still(motion)
    one = reacts and motion.joints_are_straight
    return Course(
        robot.bodies,
        travel.shapes,
        travel.points,
        scene.tree,
        travel.base,
        np.array(motion.attitudes[: 1 if one else motion.edges]),
        reaction.partial,
        np.array(positions),
        np.array(motion.joint_values),
        whole.points,
        straight,
        pieces,
        passage or no_passage(),
    )


def course_in_base(motion: Motion | CurvedMotion, travel: EdgeTravel) -> Course:
    """The arrays of a motion as seen from the base, without obstacles.

    Args:
        motion: the motion.
        travel: travel bounds along it.
    """
    from ffsr_plan.proof.kernels.course import Course
    from ffsr_plan.proof.kernels.passage import no_passage
    from ffsr_plan.proof.kernels.travel import BaseMotion

    whole, straight = travel.over(0.0, 1.0, in_base=True)
    return Course(
        motion.robot.bodies,
        travel.shapes,
        travel.points,
        Scene().tree,
        BaseMotion(False, False, np.zeros((motion.edges, 3)), 0.0),
        np.tile(IDENTITY, (motion.edges, 1)),
        _still(motion).partial,
        np.zeros((motion.edges + 1, 3)),
        np.array(motion.joint_values),
        whole.points,
        straight,
        motion.pieces_in_base
        if isinstance(motion, CurvedMotion)
        else straight_pieces(motion.robot.nd),
        no_passage(),
    )


def straight_pieces(joints: int) -> Pieces:
    """No pieces, of a motion whose edges are straight."""
    return Pieces(np.empty((0, ROWS, joints + 4)))


def _still(motion: Motion | CurvedMotion) -> Reaction:
    """A reaction to no motion, for arrays of the same kind."""
    begin = motion.joint_values[:1]
    return Reaction(motion.robot, begin, np.zeros_like(begin))

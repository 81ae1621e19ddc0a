"""Inverse kinematics at the true end of a motion: goals given by the pose of an end effector."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import whole_number
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.dynamic_singularity import warn_if_near
from ffsr_plan.goal_poses.cause_of_failure import explained
from ffsr_plan.goal_poses.pose_error import PoseTarget
from ffsr_plan.goal_poses.pose_out_of_reach import PoseOutOfReach
from ffsr_plan.goal_poses.pose_solutions import PoseSearch
from ffsr_plan.goal_poses.pose_target import pose_target
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

MOST_TRIES = 10_000
"""Descents that may be asked for."""


def inverse_kinematics(
    robot: SpaceRobot,
    scene: Scene | None,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None = None,
    *,
    start: ArrayLike,
    mode: Mode | str = Mode.FREE_FLYING,
    base_position: ArrayLike | None = None,
    base_attitude: ArrayLike | None = None,
    seed: int = 0,
) -> Array:
    """A goal configuration at which a frame has the wanted pose, within the joint limits.

    A plan from `start` ends with this configuration on a lattice without posture axes. With posture
    axes, and without a lattice, it takes `Problem(..., reach_attitude=True)`, which
    `Problem.reaching` and scenario files set: without it the base arrives at another attitude, and
    the frame misses its pose.

    The search is local (damped least squares), from the start's joint values and then from random
    ones. Revolute joints leave out whole turns where wheels hold the base; where the base reacts, a
    pose is preferred at which no joint rotates by more than half a turn.

    Args:
        robot: the robot.
        scene: obstacles. Joint values at which a link touches one of them, or another link, are
            rejected. If None, collisions are not checked, not even between links.
        frame: name of a link (first), joint or other frame of the model, such as a tool.
        position: (3,) wanted for the frame's origin, world [m].
        attitude: (3,) wanted for the frame, ZYX angles [rad]; None if any is accepted.
        start: (nq,) configuration at the beginning of the motion.
        mode: what actuates the base; see `Problem`.
        base_position: (3,) base origin at the end if thrusters move it [m]; None for the start's.
        base_attitude: (3,) base attitude at the end, where wheels hold it, ZYX angles [rad]; None
            for the start's.
        seed: of the random joint values, a whole number >= 0.

    Returns:
        (nq,) configuration, base reaction included; the pose is met to 1e-6 m and rad.

    Raises:
        InvalidInput: an argument that is not allowed.
        PoseOutOfReach: no joint values were found; with the error of the best ones, and why.
        GoalInCollision: the pose was met in collision only; with all that touches at the clearest
            joint values found.

    Warns:
        NearDynamicSingularity: free-floating, where `fp.least_singular_value` is below 1e-3.
    """
    target = pose_target(
        robot, frame, position, attitude, start=start, mode=Mode.parse("mode", mode),
        base_position=base_position, base_attitude=base_attitude,
    )  # fmt: skip
    rng = np.random.default_rng(whole_number("seed", seed, at_least=0))
    with _causes(target):
        found = PoseSearch(frame, target, scene, rng).first()
    if target.mode.floats and robot.nd:
        warn_if_near(robot, found, frame, attitude is not None)
    return found


def goals_at_pose(
    robot: SpaceRobot,
    scene: Scene,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None,
    *,
    start: ArrayLike,
    mode: Mode,
    base_position: ArrayLike | None,
    base_attitude: ArrayLike | None,
    seed: int,
    tries: int | None,
) -> Array:
    """Like `inverse_kinematics`, but all solutions of so many descents; see `PoseSearch.several`.

    Without a number of descents there is one solution, that of `inverse_kinematics`.

    Args:
        robot: the robot.
        scene: obstacles.
        frame: see `inverse_kinematics`, as are the other arguments.
        position: (3,) [m].
        attitude: (3,) [rad], or None.
        start: (nq,).
        mode: what actuates the base.
        base_position: (3,) [m], or None.
        base_attitude: (3,) [rad], or None.
        seed: a whole number >= 0.
        tries: number of descents, or None.

    Returns:
        (S, nq) configurations, at least one.

    Raises:
        InvalidInput, PoseOutOfReach, GoalInCollision: see `inverse_kinematics`.
    """
    target = pose_target(
        robot,
        frame,
        position,
        attitude,
        start=start,
        mode=mode,
        base_position=base_position,
        base_attitude=base_attitude,
    )
    rng = np.random.default_rng(whole_number("seed", seed, at_least=0))
    if tries is not None:
        tries = whole_number("tries", tries, at_least=1, at_most=MOST_TRIES)
    with _causes(target):
        search = PoseSearch(frame, target, scene, rng)
        return search.first()[None] if tries is None else search.several(tries)


@contextmanager
def _causes(target: PoseTarget) -> Iterator[None]:
    """An error for a pose out of reach says why."""
    try:
        yield
    except PoseOutOfReach as error:
        raise explained(error, target) from None

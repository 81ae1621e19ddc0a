"""Why a pose is out of reach: too far, the joints' limits, the attitude, or the base's reaction."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.rotations import angle_between, matrix
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.goal_poses.descent import DESCENTS, POSE_TOLERANCE, Descent, descents
from ffsr_plan.goal_poses.pose_error import PoseTarget, held_jacobian, pose_error
from ffsr_plan.goal_poses.pose_out_of_reach import (
    ArmReach,
    HeldBase,
    JointBeyond,
    PoseOutOfReach,
)

_MEASURED = 0.5  # share of a miss that distances from the mount have to account for
_BEYOND = 1e-6  # [rad] by which a joint is beyond a limit
_EVALUATIONS = 80


def explained(error: PoseOutOfReach, target: PoseTarget) -> PoseOutOfReach:
    """The error, with its cause and what may help.

    Args:
        error: what the best configuration misses.
        target: what was wanted.
    """
    reacts, held = target.mode.attitude_reacts, _held(target)
    base = _of_held_base(target, held) if reacts else None
    without: bool | None = None
    beyond: tuple[JointBeyond, ...] = ()
    arm: ArmReach | None = None
    if target.rotation is not None:
        found = descents(Descent(target._replace(rotation=None)))
        without = any(missed < POSE_TOLERANCE for missed, _ in found)
    if base is None or not base.reached:
        beyond = _beyond_limits(held)
        arm = None if without or beyond else _of_arm(held)
    return PoseOutOfReach(
        error.frame,
        error.position_missed,
        error.attitude_missed,
        error.configuration,
        base,
        without,
        _advice(target, base, without, beyond, arm),
        arm,
        beyond,
    )


def _advice(
    target: PoseTarget,
    base: HeldBase | None,
    without: bool | None,
    beyond: tuple[JointBeyond, ...],
    arm: ArmReach | None,
) -> tuple[str, ...]:
    """What may help."""
    advice = ["leave out the attitude: the position alone is reached"] if without else []
    if beyond:
        names = " and ".join(f"'{joint.joint}'" for joint in beyond)
        advice.append(f"a pose that asks less of {names}")
    if base is not None and base.reached:
        place = "" if target.mode.floats else " or base_position"
        return (
            *advice,
            "the mode attitude-held, if the robot has wheels",
            f"another start{place}, nearer or turned against the reaction",
            "another seed",
        )
    better = _better_place(target) + (f" by {abs(arm.distance - arm.reach):.3g} m" if arm else "")
    return (*advice, better if base is not None else f"{better}, or another base_attitude")


def _held(target: PoseTarget) -> PoseTarget:
    """The same target for a base that wheels hold at the start's attitude, or at the goal's."""
    quat = target.start[3:7] if target.mode.attitude_reacts else target.base_quat
    return target._replace(mode=Mode.ATTITUDE_HELD, base_quat=quat)


def _of_held_base(target: PoseTarget, held: PoseTarget) -> HeldBase:
    """What a held base reaches; of several ways, the one that the reaction falsifies least."""
    found = descents(Descent(held))
    reached = [change for missed, change in found if missed < POSE_TOLERANCE]
    least = min(found, key=lambda descent: descent[0])[1]
    effects = []
    for change in reached or [least]:
        end = Descent(target).end(change)
        rotation = float(angle_between(target.start[3:7], end[3:7]))
        effects.append((float(np.linalg.norm(pose_error(target, end)[:3])), rotation))
    missed, rotation = min(effects)
    if not reached:
        missed = float(np.linalg.norm(pose_error(held, Descent(held).end(least))[:3]))
    return HeldBase(bool(reached), rotation, missed)


def _of_arm(held: PoseTarget) -> ArmReach | None:
    """Distances from the arm's mount, if they account for what the position is missed by."""
    model = held.robot.model
    chain = model.supports[model.frames[held.frame].parentJoint]
    joints = [joint for joint in chain if joint > 1]  # 0 is the universe, 1 the base
    if not joints:
        return None
    alone = Descent(held._replace(rotation=None))
    missed, change = min(descents(alone), key=lambda descent: descent[0])
    end, data = alone.end(change), model.createData()
    pin.forwardKinematics(model, data, end)
    place = pin.updateFramePlacement(model, data, held.frame).translation
    mount = end[:3] + matrix(end[3:7]) @ model.jointPlacements[joints[0]].translation
    distance = float(np.linalg.norm(held.position - mount))
    reach = float(np.linalg.norm(place - mount))
    if abs(distance - reach) < _MEASURED * missed:
        return None
    return ArmReach(model.names[joints[0]], distance, reach)


def _beyond_limits(held: PoseTarget) -> tuple[JointBeyond, ...]:
    """Joints that have to go beyond their limits, if the pose is reached by revolute joints so.

    Each may then go half a turn to both sides. Of several ways, the one that goes beyond by least.
    """
    from scipy.optimize import least_squares

    robot, rng = held.robot, np.random.default_rng(0)
    turning = ~robot.prismatic
    low = np.where(turning, np.minimum(robot.lower, -np.pi), robot.lower).clip(-np.pi * 4)
    high = np.where(turning, np.maximum(robot.upper, np.pi), robot.upper).clip(max=np.pi * 4)
    free = high - low > 1e-9
    least, best = np.inf, None

    def whole(values: Array) -> Array:
        joints = robot.joint_values(held.start).clip(low, high)
        joints[free] = values
        return robot.assemble(held.base_position, held.base_quat, joints)

    for _ in range(DESCENTS):
        first = rng.uniform(low, high)[free]
        found = least_squares(
            lambda values: pose_error(held, whole(values)),
            first,
            lambda values: held_jacobian(held, whole(values))[:, free],
            (low[free], high[free]),
            xtol=1e-14,
            ftol=1e-2,
            gtol=1e-14,
            max_nfev=_EVALUATIONS,
        )
        joints = robot.joint_values(whole(found.x))
        beyond = np.maximum(robot.lower - joints, joints - robot.upper).clip(0.0)
        if np.linalg.norm(found.fun) < POSE_TOLERANCE and beyond.sum() < least:
            least, best = float(beyond.sum()), joints
    if best is None:
        return ()
    return tuple(
        JointBeyond(name, *map(float, numbers))
        for name, *numbers in zip(robot.joint_names, best, robot.lower, robot.upper, strict=True)
        if numbers[0] < numbers[1] - _BEYOND or numbers[0] > numbers[2] + _BEYOND
    )


def _better_place(target: PoseTarget) -> str:
    """Where the base should be instead, from how closely a held base reaches the pose from there.

    The pose may be too far from the base, or too close to it.
    """
    held = _held(target)
    least = _least_error(held)
    away = target.base_position - target.position
    distance = float(np.linalg.norm(away))
    what, found = "another start" if target.mode.floats else "another base position of the goal", ""
    for words, sign in (("farther from", 1.0), ("nearer to", -1.0)):
        step = sign * min(least, 0.9 * distance) / max(distance, 1e-9)
        moved = held._replace(base_position=target.base_position + step * away)
        missed = _least_error(moved)
        if missed < 0.9 * least:
            least, found = missed, f", {words} the pose"
    return what + found


def _least_error(target: PoseTarget) -> float:
    return min(error for error, _ in descents(Descent(target)))

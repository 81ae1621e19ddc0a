"""Limits of a flight on velocity, acceleration, jerk, torque and pulses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.straight_runs import StraightRuns

_LARGEST_LIMIT = 1e9  # with larger ones thrust and delta-v would be dominated by rounding
PerJoint = float | Mapping[str, float] | None
"""One limit for all joints, limits by joint name, or None."""


class FlightLimits(NamedTuple):
    """Limits of a flight, infinite if there is none.

    The columns of the first three are the base origin, the rotation of the base by wheels, and the
    joints.

    Attributes:
        velocity: (2 + nd,) [m/s], [rad/s], [rad/s or m/s].
        acceleration: (2 + nd,) [m/s^2], [rad/s^2], [rad/s^2 or m/s^2].
        jerk: (2 + nd,) [m/s^3], [rad/s^3], [rad/s^3 or m/s^3].
        torque: (nd,) [N m or N].
        velocity_jump: change of the base's velocity at a corner of its path [m/s].
    """

    velocity: Array
    acceleration: Array
    jerk: Array
    torque: Array
    velocity_jump: float

    def along(self, runs: StraightRuns) -> tuple[Array, Array, Array]:
        """The tightest limits on x along each run.

        Args:
            runs: r straight runs.

        Returns:
            (r,) each: limits on x', x'' and x'''.
        """
        rates = runs.rates()
        with np.errstate(divide="ignore"):
            x = [np.min(most / rates, axis=1) for most in self[:3]]
        return x[0], x[1], x[2]


def read_limits(
    robot: SpaceRobot,
    *,
    joint_velocity: PerJoint,
    joint_acceleration: PerJoint,
    joint_jerk: PerJoint,
    joint_torque: PerJoint,
    base_velocity: float | None,
    thruster_acceleration: float | None,
    thruster_jerk: float | None,
    turn_velocity: float | None,
    turn_acceleration: float | None,
    velocity_jump: float,
) -> FlightLimits:
    """Check the arguments of `Plan.timed` and collect them.

    Args:
        robot: the robot.
        joint_velocity: limits on joint velocities [rad/s or m/s]; None for those of the URDF.
        joint_acceleration: limits on joint accelerations [rad/s^2 or m/s^2].
        joint_jerk: limits on joint jerks [rad/s^3 or m/s^3].
        joint_torque: limits on joint torques [N m or N].
        base_velocity: limit on the velocity of the base origin [m/s].
        thruster_acceleration: limit on thrust divided by mass [m/s^2].
        thruster_jerk: limit on the jerk of the base origin [m/s^3].
        turn_velocity: limit on the angular velocity of a base that wheels rotate [rad/s].
        turn_acceleration: limit on its angular acceleration [rad/s^2].
        velocity_jump: largest change of the base's velocity at a corner [m/s].

    Returns:
        The limits; infinite for None.

    Raises:
        InvalidInput: a limit that is not a positive number, an unknown joint, or a velocity jump
            together with a limit on jerk.
    """
    jump = number("velocity_jump", velocity_jump, at_least=0.0)
    none = np.full(robot.nd, np.inf)
    stated = np.array(robot.model.upperVelocityLimit[6:])
    jerks = _per_joint(robot, "joint_jerk", joint_jerk, none)
    base_jerk = _one("thruster_jerk", thruster_jerk)
    if jump > 0.0 and np.any(np.isfinite([base_jerk, *jerks])):
        raise InvalidInput(
            "velocity_jump", jump, "0 if a jerk is limited: a jump has an infinite jerk"
        )
    return FlightLimits(
        _row(
            _one("base_velocity", base_velocity),
            _one("turn_velocity", turn_velocity),
            _per_joint(robot, "joint_velocity", joint_velocity, stated),
        ),
        _row(
            _one("thruster_acceleration", thruster_acceleration),
            _one("turn_acceleration", turn_acceleration),
            _per_joint(robot, "joint_acceleration", joint_acceleration, none),
        ),
        _row(base_jerk, np.inf, jerks),
        _per_joint(robot, "joint_torque", joint_torque, none),
        jump,
    )


def check_limits(limits: FlightLimits, runs: StraightRuns, robot: SpaceRobot, floats: bool) -> None:
    """Check that everything that moves has a limit on its acceleration.

    There is no default that suits both a robot of one kilogram and one of ten tonnes.

    Args:
        limits: the limits.
        runs: the straight runs of the motion.
        robot: the robot.
        floats: whether the base has no thrusters.

    Raises:
        InvalidInput: naming the missing limit.
    """
    moves = np.max(runs.rates(), axis=0) > 0.0
    needed = {"thruster_acceleration": not floats, "turn_acceleration": bool(moves[1])}
    for k, (name, is_needed) in enumerate(needed.items()):
        if is_needed and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(name, None, "a finite number greater than 0")
    for k, name in enumerate(robot.joint_names, start=2):
        if moves[k] and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(
                f"joint_acceleration, joint {name}", None, "a finite number greater than 0"
            )
        if moves[k] and limits.velocity[k] <= 0.0:
            allowed = "greater than 0; the URDF's limit is 0, so another one has to be given"
            raise InvalidInput(f"joint_velocity, joint {name}", 0.0, allowed)


def _row(base: float, turn: float, joints: Array) -> Array:
    return np.concatenate([[base, turn], joints])


def _one(what: str, value: float | None) -> float:
    return np.inf if value is None else number(what, value, above=0.0, at_most=_LARGEST_LIMIT)


def _per_joint(robot: SpaceRobot, what: str, value: PerJoint, default: Array) -> Array:
    if value is None:
        return default
    if not isinstance(value, Mapping):
        return np.full(robot.nd, number(what, value, above=0.0, at_most=_LARGEST_LIMIT))
    values = np.array(default)
    for name, each in value.items():
        if name not in robot.joint_names:
            raise unknown_name(what, name, robot.joint_names)
        values[robot.joint_names.index(name)] = number(
            f"{what}.{name}", each, above=0.0, at_most=_LARGEST_LIMIT
        )
    return values

"""Limits of a flight on velocity, acceleration, jerk, torque and pulses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.checks import number, unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Rule
from ffsr_plan.core.settings import settings
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.urdf.joints import NO_JOINT
from ffsr_plan.trajectory.straight_runs import StraightRuns

_LARGEST_LIMIT = 1e9  # with larger ones thrust and delta-v would be dominated by rounding
_NEEDED = "a finite number greater than 0: without it a flight could take no time at all"
_OF_WHEELS = ("turn_velocity", "turn_acceleration")
_OF_THRUSTERS = ("base_velocity", "thruster_acceleration", "thruster_jerk", "velocity_jump")
PerJoint = float | Mapping[str, float] | None
"""One limit for all joints, limits by joint name, or None."""
PositiveOrNone = Annotated[float, Number(above=0.0, at_most=_LARGEST_LIMIT)] | None
"""A limit, or None."""


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


@dataclass(frozen=True)
class JointLimit(Rule):
    """A number > 0 for all joints, or such numbers by joint name, or None."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if value is None:
            return None
        if not isinstance(value, Mapping):
            return number(what, value, above=0.0, at_most=_LARGEST_LIMIT)
        return {
            str(name): number(f"{what}.{name}", each, above=0.0, at_most=_LARGEST_LIMIT)
            for name, each in value.items()
        }


@settings
class LimitSettings:
    """Limits of a flight as the user names them; None where there is no limit.

    Attributes:
        joint_acceleration: [rad/s^2 or m/s^2]; the URDF's, if it has any, for joints that are not
            named.
        thruster_acceleration: of the base origin, equal to thrust / mass [m/s^2].
        joint_velocity: [rad/s or m/s]; the URDF's for joints that are not named.
        base_velocity: of the base origin [m/s].
        joint_torque: [N m or N].
        joint_jerk: [rad/s^3 or m/s^3]; the URDF's, if it has any, for joints that are not named.
        thruster_jerk: of the base origin [m/s^3].
        turn_velocity: of a base that wheels rotate [rad/s].
        turn_acceleration: of a base that wheels rotate [rad/s^2].
        velocity_jump: change of the base's velocity by one pulse [m/s].
    """

    joint_acceleration: Annotated[PerJoint, JointLimit()] = None
    thruster_acceleration: PositiveOrNone = None
    joint_velocity: Annotated[PerJoint, JointLimit()] = None
    base_velocity: PositiveOrNone = None
    joint_torque: Annotated[PerJoint, JointLimit()] = None
    joint_jerk: Annotated[PerJoint, JointLimit()] = None
    thruster_jerk: PositiveOrNone = None
    turn_velocity: PositiveOrNone = None
    turn_acceleration: PositiveOrNone = None
    velocity_jump: Annotated[float, Number(at_least=0.0)] = 0.0

    def __post_init__(self) -> None:
        if self.velocity_jump > 0.0 and (self.joint_jerk or self.thruster_jerk):
            raise InvalidInput(
                "velocity_jump",
                self.velocity_jump,
                "0 if a jerk is limited: a jump has an infinite jerk",
            )

    def for_robot(self, robot: SpaceRobot) -> FlightLimits:
        """The limits as arrays.

        Args:
            robot: gives the joints and the URDF's limits on velocity, acceleration and jerk.

        Raises:
            InvalidInput: a joint that the robot does not have.
        """
        none = np.full(robot.nd, np.inf)
        stated = np.array(robot.model.upperVelocityLimit[6:])

        def joints(what: str, default: Array = none) -> Array:
            return _joint_array(robot, what, getattr(self, what), default)

        return FlightLimits(
            _row(self.base_velocity, self.turn_velocity, joints("joint_velocity", stated)),
            _row(
                self.thruster_acceleration,
                self.turn_acceleration,
                joints("joint_acceleration", robot.acceleration),
            ),
            _row(self.thruster_jerk, None, joints("joint_jerk", robot.jerk)),
            joints("joint_torque"),
            self.velocity_jump,
        )


def read_limits(
    robot: SpaceRobot,
    mode: Mode | None = None,
    **given: Any,  # noqa: ANN401 - see `LimitSettings`
) -> FlightLimits:
    """The limits that a user names, checked; see `LimitSettings` and `Plan.timed`.

    Args:
        robot: the robot.
        mode: what actuates the base; None for any.
        **given: fields of `LimitSettings`.

    Raises:
        InvalidInput: a limit that is not allowed, of wheels or thrusters that the mode does not
            have, or of a joint that the robot does not have.
    """
    limits = LimitSettings(**given).for_robot(robot)
    if mode is not None:
        _refuse_limits_without_actuator(mode, given)
    return limits


def _refuse_limits_without_actuator(mode: Mode, given: dict[str, Any]) -> None:
    """Raise `InvalidInput` for a limit of wheels or thrusters that a mode does not have."""
    lacking = dict.fromkeys(_OF_THRUSTERS, "thrusters") if mode.floats else {}
    lacking |= {} if mode.has_wheels else dict.fromkeys(_OF_WHEELS, "wheels")
    for name, actuator in lacking.items():
        if given.get(name):
            allowed = f"none in the mode {mode}: it has no {actuator}"
            raise InvalidInput(name, given[name], allowed)


def check_limits(limits: FlightLimits, moves: Flags, robot: SpaceRobot, floats: bool) -> None:
    """Check that everything that moves has a limit on its acceleration, and pulses none on jerk.

    There is no default that suits both a robot of one kilogram and one of ten tonnes.

    Args:
        limits: the limits.
        moves: (2 + nd,) whether thrusters move the base, wheels turn it, and each joint moves.
        robot: the robot.
        floats: whether the base has no thrusters.

    Raises:
        InvalidInput: naming the missing limit, or the joint whose jerk the URDF limits.
    """
    for k, name in enumerate(robot.joint_names, start=2):
        if limits.velocity_jump > 0.0 and moves[k] and np.isfinite(limits.jerk[k]):
            allowed = f"0, as the URDF limits the jerk of joint {name}: a jump has an infinite jerk"
            raise InvalidInput("velocity_jump", limits.velocity_jump, allowed)
    needed = {"thruster_acceleration": not floats, "turn_acceleration": bool(moves[1])}
    for k, (name, is_needed) in enumerate(needed.items()):
        if is_needed and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(name, None, _NEEDED)
    for k, name in enumerate(robot.joint_names, start=2):
        if moves[k] and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(f"joint_acceleration, joint {name}", None, _NEEDED)
        if moves[k] and limits.velocity[k] <= 0.0:
            allowed = "greater than 0; the URDF's limit is 0, so another one has to be given"
            raise InvalidInput(f"joint_velocity, joint {name}", 0.0, allowed)


def _row(base: float | None, rotation: float | None, joints: Array) -> Array:
    """(2 + nd,) columns of `FlightLimits`."""
    first = [np.inf if value is None else value for value in (base, rotation)]
    return np.concatenate([first, joints])


def _joint_array(robot: SpaceRobot, what: str, value: PerJoint, default: Array) -> Array:
    """(nd,) one number for each joint."""
    if value is None:
        return default
    if not isinstance(value, Mapping):
        return np.full(robot.nd, value)
    values = np.array(default)
    for name, each in value.items():
        if name not in robot.joint_names:
            raise unknown_name(what, name, robot.joint_names, NO_JOINT)
        values[robot.joint_names.index(name)] = each
    return values

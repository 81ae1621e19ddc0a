"""`Limits`: how fast and how hard a plan may be flown, checked once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.straight_runs import StraightRuns

_MOST = 1e9
"""Beyond it a flight is so short that rounding decides about thrust and delta-v."""
PerJoint = float | Mapping[str, float] | None
"""One number for all joints, or numbers by joint name, or nothing."""


class Limits(NamedTuple):
    """Infinite where there is none. Columns: base origin, turn of the base by wheels, joints."""

    velocity: Array
    """(2 + nd,) [m/s], [rad/s], [rad/s or m/s]."""
    acceleration: Array
    """(2 + nd,) [m/s^2], [rad/s^2], [rad/s^2 or m/s^2]."""
    jerk: Array
    """(2 + nd,) [m/s^3], [rad/s^3], [rad/s^3 or m/s^3]."""
    torque: Array
    """(nd,) [N m or N]."""
    velocity_jump: float
    """Of the base at a corner of its path [m/s]."""

    def along(self, runs: StraightRuns) -> tuple[Array, Array, Array]:
        """(r,) most x', x'' and x''' along each run: the tightest of all limits there."""
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
) -> Limits:
    """The limits that a user names; see `Plan.timed`."""
    jump = number("velocity_jump", velocity_jump, at_least=0.0)
    none = np.full(robot.nd, np.inf)
    stated = np.array(robot.model.upperVelocityLimit[6:])
    jerks = _per_joint(robot, "joint_jerk", joint_jerk, none)
    shake = _one("thruster_jerk", thruster_jerk)
    if jump > 0.0 and np.any(np.isfinite([shake, *jerks])):
        raise InvalidInput(
            "velocity_jump", jump, "0 where a jerk is limited: a jump is a jerk without limit"
        )
    return Limits(
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
        _row(shake, np.inf, jerks),
        _per_joint(robot, "joint_torque", joint_torque, none),
        jump,
    )


def check_limits(limits: Limits, runs: StraightRuns, robot: SpaceRobot, floats: bool) -> None:
    """Raise `InvalidInput` where something moves whose acceleration is not limited.

    There is no default that would suit a robot of one kilogram and one of ten tonnes.
    """
    moves = np.max(runs.rates(), axis=0) > 0.0
    needed = {"thruster_acceleration": not floats, "turn_acceleration": bool(moves[1])}
    for k, (name, due) in enumerate(needed.items()):
        if due and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(name, None, "a finite number greater than 0")
    for k, name in enumerate(robot.joint_names, start=2):
        if moves[k] and not np.isfinite(limits.acceleration[k]):
            raise InvalidInput(
                f"joint_acceleration, joint {name}", None, "a finite number greater than 0"
            )
        if moves[k] and limits.velocity[k] <= 0.0:
            raise InvalidInput(
                f"joint_velocity, joint {name}", 0.0,
                "greater than 0; the URDF says 0, so it has to be given",
            )  # fmt: skip


def _row(base: float, turn: float, joints: Array) -> Array:
    return np.concatenate([[base, turn], joints])


def _one(what: str, value: float | None) -> float:
    return np.inf if value is None else number(what, value, above=0.0, at_most=_MOST)


def _per_joint(robot: SpaceRobot, what: str, value: PerJoint, default: Array) -> Array:
    if value is None:
        return default
    if not isinstance(value, Mapping):
        return np.full(robot.nd, number(what, value, above=0.0, at_most=_MOST))
    values = np.array(default)
    for name, each in value.items():
        if name not in robot.joint_names:
            raise unknown_name(what, name, robot.joint_names)
        values[robot.joint_names.index(name)] = number(
            f"{what}.{name}", each, above=0.0, at_most=_MOST
        )
    return values

"""Axes of a lattice that displace the joints: along a direction, or towards a posture."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.checks import number, unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Rule, Text, WholeNumber
from ffsr_plan.core.settings import Given, settings
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.srdf import NO_POSTURE
from ffsr_plan.robots.urdf.joints import NO_JOINT

Direction = tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class JointDirection(Rule):
    """Joint names with what they move by; at least one joint moves."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Direction:
        """See `Rule.check`."""
        allowed = "joint names with what they move by"
        if not isinstance(value, (Mapping, Sequence)) or isinstance(value, str) or not value:
            raise InvalidInput(what, value, allowed)
        try:
            pairs = dict(value)
        except (TypeError, ValueError):
            raise InvalidInput(what, value, allowed) from None
        if len(pairs) < len(value):
            names = [str(name) for name, _ in value]  # a sequence: a mapping has no name twice
            twice = sorted({name for name in names if names.count(name) > 1})
            raise InvalidInput(what, f"{', '.join(twice)} more than once", "each joint once")
        moves = {
            str(name): number(f"{what}.{name}", each, at_least=-1e9, at_most=1e9)
            for name, each in pairs.items()
        }
        if not any(moves.values()):
            raise InvalidInput(what, value, "a joint that moves")
        return tuple(moves.items())

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {
            "type": "object",
            "additionalProperties": {"type": "number"},
            "minProperties": 1,
        }


class _JointAxis(ABC):
    """An axis along which nodes differ in their joint values."""

    @property
    @abstractmethod
    def indices(self) -> range:
        """All indices along the axis; index 0 displaces nothing."""

    @abstractmethod
    def displacement(self, robot: SpaceRobot, nominal: Array) -> Array:
        """(..., nd) displacement for a factor of one [rad or m].

        Args:
            robot: the robot.
            nominal: (..., nd) joint values without displacement [rad or m].

        Raises:
            InvalidInput: the robot does not have the joint or posture.
        """

    @abstractmethod
    def factors(self, indices: IntArray) -> Array:
        """(n,) factors of `displacement` at indices (n,)."""


@settings
class PostureAxis(_JointAxis):
    """Displacements of the joints along a direction d: by k h d at index k in -n .. n.

    `PostureAxis.towards` makes the other kind, a `PostureTarget`; it counts as a `PostureAxis` for
    `isinstance`.

    Attributes:
        joints: d, joint names with what they move by [rad or m] for each unit of h, as pairs.
        half_count: n, from 1 to 1000.
        spacing: h, at most 100.
    """

    joints: Annotated[
        Given[Direction, Mapping[str, float] | Sequence[tuple[str, float]]], JointDirection()
    ]
    half_count: Annotated[int, WholeNumber(at_least=1, at_most=1000)]
    spacing: Annotated[float, Number(above=0.0, at_most=100.0)]

    @staticmethod
    def towards(posture: str, levels: int) -> PostureTarget:
        """An axis towards a named posture of the robot, which it reaches in `levels` steps.

        Args:
            posture: name of the posture.
            levels: number of steps, from 1 to 1000.
        """
        return PostureTarget(posture, levels)

    @property
    def indices(self) -> range:
        """All indices along the axis; index 0 displaces nothing."""
        return range(-self.half_count, self.half_count + 1)

    def displacement(self, robot: SpaceRobot, nominal: Array) -> Array:
        """(..., nd) the direction, the same at all nominal joint values (..., nd)."""
        result = np.zeros_like(nominal)
        for name, value in self.joints:
            if name not in robot.joint_names:
                about = "lattice postures, joints"
                raise unknown_name(about, name, robot.joint_names, NO_JOINT)
            result[..., robot.joint_names.index(name)] = value
        return result

    def factors(self, indices: IntArray) -> Array:
        """(n,) k h at indices (n,)."""
        return np.asarray(indices * self.spacing, dtype=np.float64)


@PostureAxis.register
@settings
class PostureTarget(_JointAxis):
    """Displacements of the joints towards a posture: by k / levels of the difference to it.

    Index k is in 0 .. levels. Joints that the posture does not name are not displaced. Continuous
    joints go to the value that the posture states, whole turns included.

    Attributes:
        towards: name of the posture, from the robot's SRDF.
        levels: number of steps from the nominal joint values to the posture, from 1 to 1000.
    """

    towards: Annotated[str, Text("the name of a posture", empty=False)]
    levels: Annotated[int, WholeNumber(at_least=1, at_most=1000)]

    @property
    def indices(self) -> range:
        """All indices along the axis; index 0 displaces nothing."""
        return range(self.levels + 1)

    def displacement(self, robot: SpaceRobot, nominal: Array) -> Array:
        """(..., nd) differences from nominal joint values (..., nd) to the posture."""
        if self.towards not in robot.postures:
            about = "lattice postures, towards"
            raise unknown_name(about, self.towards, robot.postures, NO_POSTURE)
        result = np.zeros_like(nominal)
        for name, value in robot.postures[self.towards].items():
            k = robot.joint_names.index(name)
            result[..., k] = value - nominal[..., k]
        return result

    def factors(self, indices: IntArray) -> Array:
        """(n,) k / levels at indices (n,)."""
        return np.asarray(indices / self.levels, dtype=np.float64)

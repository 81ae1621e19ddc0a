"""Rules for the configurations and the mode of a problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ffsr_plan.collision.contacts import contacts
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.contacts import contact_list
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Rule
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

MOST_ALTERNATIVES = 100
"""Alternative goals that a problem may have; trees grow from each of them."""


@dataclass(frozen=True)
class Configuration(Rule):
    """A configuration of the robot in the field `robot`: (nq,), within the joint limits."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if "robot" not in others:  # refused already
            return value
        robot: SpaceRobot = others["robot"]
        try:
            return robot.check_configuration(what, value)  # type: ignore[arg-type]
        except InvalidInput as error:
            touching = _touching(robot, others.get("scene", Scene()), what, value)
            if not touching:
                raise
            allowed = f"{error.allowed}; at these values, {touching}"
            raise InvalidInput(error.what, error.value, allowed) from None


def _touching(robot: SpaceRobot, scene: Scene, what: str, value: object) -> str:
    """What touches at a configuration with joint values outside their limits.

    Obstacles count at the start only: where the base is at the goal depends on the mode.
    """
    try:
        q = np.array(finite_array(what, value, (robot.model.nq,)))  # type: ignore[arg-type]
    except InvalidInput:
        return ""
    size = float(np.linalg.norm(q[3:7]))
    if size <= 0.5:
        return ""
    q[3:7] /= size
    found = contacts(robot, scene if what == "start" else Scene(), q)
    return contact_list(found) if found else ""


@dataclass(frozen=True)
class ModeName(Rule):
    """A mode, or its name."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Mode:
        """See `Rule.check`."""
        return Mode.parse(what, value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "string", "enum": [mode.value for mode in Mode]}


@dataclass(frozen=True)
class Configurations(Rule):
    """Configurations of the robot in the field `robot`: (A, nq), within the joint limits."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if "robot" not in others:  # refused already
            return value
        robot: SpaceRobot = others["robot"]
        width = robot.model.nq
        if isinstance(value, (list, tuple)) and not value:
            return frozen(np.zeros((0, width)))
        rows = finite_array(what, value, (-1, width))  # type: ignore[arg-type]
        if len(rows) > MOST_ALTERNATIVES:
            raise InvalidInput(what, len(rows), f"at most {MOST_ALTERNATIVES} configurations")
        checked: list[Array] = [
            robot.check_configuration(f"{what}.{k}", row) for k, row in enumerate(rows)
        ]
        return frozen(np.array(checked).reshape(-1, width))

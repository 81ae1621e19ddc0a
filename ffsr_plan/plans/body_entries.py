"""Moving bodies in plan files: tables of their shapes, their motion and their pose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any

import numpy as np

from ffsr_plan.bodies.body_motion import BodyMotion, Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Rule
from ffsr_plan.core.settings import setting, settings
from ffsr_plan.plans.shape_entries import Bodies, made_of_kind, plain_entry
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import SHAPES, Name, Place, Turn

MOTION_KINDS: dict[str, type[Any]] = {
    "drift": Drift,
    "spin": Spin,
    "tumble": Tumble,
    "track": Track,
}
"""The classes of motions that a file can hold, by their words."""


def body_entries(scene: Scene) -> list[dict[str, Any]]:
    """The moving bodies in plain Python values.

    Args:
        scene: the obstacles.

    Raises:
        InvalidInput: a motion that is a function, which no file can hold.
    """
    return [_entry(f"scene bodies.{k}", body) for k, body in enumerate(scene.bodies)]


def _entry(what: str, body: MovingBody) -> dict[str, Any]:
    if isinstance(body.motion, PoseFunction):
        allowed = "a motion that a file can hold; a Track of sampled poses is one"
        raise InvalidInput(f"{what}, motion", body.motion, allowed)
    return {
        "name": body.name,
        "position": body.position.tolist(),
        "attitude": body.attitude.tolist(),
        "shapes": [plain_entry(shape) for shape in body.shapes],
        "motion": _motion_entry(body.motion),
    }


def _motion_entry(motion: BodyMotion) -> dict[str, Any]:
    (kind,) = (word for word, each in MOTION_KINDS.items() if isinstance(motion, each))
    values = {each.name: getattr(motion, each.name) for each in fields(motion)}  # type: ignore[arg-type]
    plain = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in values.items()}
    return {"kind": kind, **plain}


@dataclass(frozen=True)
class Motion(Rule):
    """A table of a motion, with its kind."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        return made_of_kind(what, value, MOTION_KINDS)


@settings
class BodyTable:
    """A body that moves."""

    shapes: Annotated[Any, Bodies(SHAPES)]
    motion: Annotated[Any, Motion()]
    position: Place = setting(default=(0.0, 0.0, 0.0))
    attitude: Turn = setting(default=(0.0, 0.0, 0.0, 1.0))
    name: Name = ""

    def body(self) -> MovingBody:
        """The body."""
        return MovingBody(self.shapes, self.motion, self.position, self.attitude, self.name)

"""Moving bodies and debris in plan files: tables of shapes, motions and poses, and of spheres."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any

import numpy as np

from ffsr_plan.bodies.body_motion import BodyMotion, Drift, Spin
from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core.arrays import Array, frozen
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


def moving_entries(scene: Scene) -> dict[str, Any]:
    """Moving bodies and debris in plain Python values; what a scene lacks is left out.

    Args:
        scene: the obstacles.

    Raises:
        InvalidInput: a motion that is a function, which no file can hold.
    """
    entries: dict[str, Any] = {}
    if scene.bodies:
        named = enumerate(scene.bodies)
        entries["bodies"] = [_entry(f"scene bodies.{k}", body) for k, body in named]
    if scene.debris:
        entries["debris"] = [_cloud_entry(cloud) for cloud in scene.debris]
    return entries


def _cloud_entry(cloud: DebrisCloud) -> dict[str, Any]:
    """A cloud, its numbers as they are in memory: a list would take three times as much room."""
    table = np.column_stack([cloud.centers, cloud.radii, cloud.velocities]).astype("<f8")
    return {"name": cloud.name, "spheres": b64encode(table.tobytes()).decode("ascii")}


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


@dataclass(frozen=True)
class DriftingSpheres(Rule):
    """Centre, radius and velocity of each sphere: binary64, little-endian, in base 64."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        allowed = "rows of seven numbers in base 64"
        try:
            found = np.frombuffer(b64decode(str(value), validate=True), "<f8").reshape(-1, 7)
        except ValueError:
            raise InvalidInput(what, value, allowed) from None
        return frozen(found.astype(np.float64))


@settings
class DebrisTable:
    """A cloud of debris."""

    spheres: Annotated[Any, DriftingSpheres()]
    name: Name = ""

    def cloud(self) -> DebrisCloud:
        """The cloud."""
        centers, radii, velocities = np.split(self.spheres, [3, 4], axis=1)
        return DebrisCloud(centers, radii[:, 0], velocities, self.name)

"""Zones that the whole robot has to stay in: boxes, balls and half-spaces."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Numbers, Vector
from ffsr_plan.core.settings import setting, settings
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Name


@settings
class HalfSpace:
    """The points x with direction . (x - position) <= 0.

    Attributes:
        direction: (3,) out of the half-space, of any length but zero.
        position: (3,) a point on its boundary, world [m].
        name: by which errors name it.
    """

    word: ClassVar[str] = "half-space"

    direction: Annotated[Vector, Numbers(3)]
    position: Annotated[Vector, Numbers(3, FARTHEST)] = setting(default=(0.0, 0.0, 0.0))
    name: Name = ""

    def __post_init__(self) -> None:
        size = float(np.linalg.norm(self.direction))
        if size < 1e-9:
            raise InvalidInput("direction", self.direction.tolist(), "a vector longer than 1e-9")


Zone = Box | Ball | HalfSpace
ZONES: tuple[type, ...] = (Box, Ball, HalfSpace)
"""Classes of zones."""


def planes_of(zone: Zone) -> Array:
    """The planes that bound a zone.

    Args:
        zone: the zone.

    Returns:
        (p, 4) outward unit normals, and how far along them the planes lie [m]: inside is
        n . x <= offset. None for a ball.
    """
    if isinstance(zone, Ball):
        return np.zeros((0, 4))
    if isinstance(zone, HalfSpace):
        normals: Array = zone.direction[None] / np.linalg.norm(zone.direction)
        reach = np.zeros(1)
    else:
        axes = rotations.matrix(zone.attitude).T
        normals, reach = np.vstack([axes, -axes]), np.tile(zone.half_sides, 2)
    return np.column_stack([normals, normals @ zone.position + reach])

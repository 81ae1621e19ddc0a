"""What pictures need to know of a problem."""

from __future__ import annotations

from typing import Protocol

from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


class ShownProblem(Protocol):
    """A robot among obstacles: a problem, or any motion that a page plays."""

    @property
    def robot(self) -> SpaceRobot:
        """The robot."""

    @property
    def scene(self) -> Scene:
        """The obstacles as they are."""

    @property
    def obstacles(self) -> Scene:
        """The obstacles as clearances count from them."""

    @property
    def base_displacement(self) -> Array:
        """(3,) from the base's start to its end, world axes [m]; zero where it floats."""

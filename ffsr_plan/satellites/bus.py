"""Bus of a satellite: a box with mass and solar panels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf_validation import LARGEST


@dataclass(frozen=True, eq=False)
class Panel:
    """A solar panel, or anything else box-shaped that is fixed to the bus.

    Args:
        size: (3,) lengths of its sides [m].
        position: (3,) of its middle in the bus frame [m].
        mass: [kg], evenly spread.
        attitude: (3,) ZYX angles (alpha, beta, gamma) in the bus frame [rad].
        name: of its link; `panel_1`, `panel_2`, ... by its place among the panels if left out.

    Raises:
        InvalidInput: what is not finite, or a size or mass of zero or less.
    """

    size: ArrayLike
    position: ArrayLike
    mass: float
    attitude: ArrayLike = (0.0, 0.0, 0.0)
    name: str = ""

    def __post_init__(self) -> None:
        fill = object.__setattr__
        fill(self, "size", _size("size of a panel", self.size))
        fill(self, "position", place("position of a panel", self.position))
        fill(self, "mass", number("mass of a panel", self.mass, above=0.0))
        fill(self, "attitude", finite_array("attitude of a panel", self.attitude, (3,)))
        if not isinstance(self.name, str):
            raise InvalidInput("name of a panel", self.name, "a name")


@dataclass(frozen=True, eq=False)
class Bus:
    """A box about the origin of the bus frame, which is the robot's base frame.

    Args:
        size: (3,) lengths of its sides along x, y and z [m].
        mass: [kg], panels not counted.
        inertia: (3,) principal moments along the axes, or a symmetric (3, 3) [kg m^2], about the
            bus's centre of mass, panels not counted. That of a homogeneous box if left out.
        center_of_mass: (3,) of the bus without panels, in its frame [m].
        panels: solar panels, each a link of its own, fixed to the bus.

    Raises:
        InvalidInput: what is not finite, a size or mass of zero or less, or an inertia that no body
            has.
    """

    size: ArrayLike
    mass: float
    inertia: ArrayLike | None = None
    center_of_mass: ArrayLike = (0.0, 0.0, 0.0)
    panels: Sequence[Panel] = ()

    def __post_init__(self) -> None:
        fill = object.__setattr__
        fill(self, "size", _size("size of the bus", self.size))
        fill(self, "mass", number("mass of the bus", self.mass, above=0.0))
        center = place("center_of_mass of the bus", self.center_of_mass)
        fill(self, "center_of_mass", center)
        inertia = _box_inertia(self.mass, self.size) if self.inertia is None else self.inertia
        fill(self, "inertia", _inertia("inertia of the bus", inertia))
        if not isinstance(self.panels, Sequence):
            raise InvalidInput("panels of the bus", self.panels, "a sequence of Panels")
        for panel in self.panels:
            if not isinstance(panel, Panel):
                raise InvalidInput("panels of the bus", panel, "Panel(size, position, mass)")
        fill(self, "panels", tuple(self.panels))


def place(what: str, value: ArrayLike) -> Array:
    """Check a position whose coordinates a URDF may contain.

    Args:
        what: name of the argument in error messages.
        value: (3,) [m].

    Returns:
        (3,) read-only copy [m].

    Raises:
        InvalidInput: not three finite numbers, or one too large.
    """
    return finite_array(what, value, (3,), LARGEST)


def _size(what: str, value: ArrayLike) -> Array:
    size = place(what, value)
    if not np.all(size > 0.0):
        raise InvalidInput(what, value, "three numbers greater than 0 m")
    return size


def box_inertia(mass: float, size: ArrayLike) -> Array:
    """Moments of inertia of a homogeneous box about its centre.

    Args:
        mass: [kg].
        size: (3,) lengths of the sides [m].

    Returns:
        (3,) moments about the axes of the box [kg m^2].
    """
    x, y, z = np.asarray(size) ** 2
    return mass / 12.0 * np.array([y + z, x + z, x + y])


_box_inertia = box_inertia  # name within this module


def _inertia(what: str, value: ArrayLike) -> Array:
    """(3, 3) inertia [kg m^2] of a body with mass in all three directions, or `InvalidInput`."""
    try:
        flat = np.ndim(value) == 1
    except ValueError:  # rows of different lengths
        flat = False
    checked = finite_array(what, value, (3,) if flat else (3, 3))
    tensor = np.diag(checked) if flat else checked
    if not np.array_equal(tensor, tensor.T):
        raise InvalidInput(what, value, "a symmetric matrix")
    small, middle, large = np.linalg.eigvalsh(tensor)
    if small <= 0.0 or small + middle < large * (1.0 - 1e-9):
        allowed = "principal moments above 0 kg m^2 of which no two sum to less than the third"
        raise InvalidInput(what, value, allowed)
    return frozen(tensor)

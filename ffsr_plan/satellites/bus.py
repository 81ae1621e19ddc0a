"""Bus of a satellite: a box with mass and solar panels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Numbers, Rule, Text, Vector
from ffsr_plan.core.settings import Given, setting, settings
from ffsr_plan.robots.urdf.inertias import tensor_fault
from ffsr_plan.robots.urdf.origins import LARGEST


@dataclass(frozen=True)
class BoxSize(Rule):
    """(3,) lengths of a box's sides [m], greater than 0."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        size = Numbers(3, at_most=LARGEST).check(what, value, others)
        if not np.all(size > 0.0):
            raise InvalidInput(what, value, "three numbers greater than 0 m")
        return size


@dataclass(frozen=True)
class Inertia(Rule):
    """(3,) principal moments or a symmetric (3, 3) [kg m^2]; None for a homogeneous box."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if value is None:
            if not {"size", "mass"} <= set(others):  # refused already
                return value
            value = box_inertia(others["mass"], others["size"])
        return _inertia(what, value)  # type: ignore[arg-type]


@settings(of="a panel")
class Panel:
    """A solar panel, or anything else box-shaped that is fixed to the bus.

    Attributes:
        size: (3,) lengths of its sides [m].
        position: (3,) centre of the box in the bus frame [m].
        mass: [kg], evenly distributed.
        attitude: (3,) ZYX angles (alpha, beta, gamma) in the bus frame [rad].
        name: of its link; `panel_1`, `panel_2`, ... in the order of the panels if empty.

    Raises:
        InvalidInput: a value that is not finite, or a size or mass of zero or less.
    """

    size: Annotated[Vector, BoxSize()]
    position: Annotated[Vector, Numbers(3, at_most=LARGEST)]
    mass: Annotated[float, Number(above=0.0)]
    attitude: Annotated[Vector, Numbers(3)] = setting(default=(0.0, 0.0, 0.0))
    name: Annotated[str, Text("a name")] = ""


@settings(of="the bus")
class Bus:
    """A box about the origin of the bus frame, which is the robot's base frame.

    Attributes:
        size: (3,) lengths of its sides along x, y and z [m].
        mass: [kg], without panels.
        inertia: (3,) principal moments along the axes, or a symmetric (3, 3) [kg m^2], about the
            bus's centre of mass, without panels; None for a homogeneous box. Kept as (3, 3).
        center_of_mass: (3,) of the bus without panels, in its frame [m].
        panels: solar panels, each a link of its own, fixed to the bus.

    Raises:
        InvalidInput: a value that is not finite, a size or mass of zero or less, or an inertia that
            no body has.
    """

    size: Annotated[Vector, BoxSize()]
    mass: Annotated[float, Number(above=0.0)]
    inertia: Annotated[Given[Array, ArrayLike | None], Inertia()] = setting(default=None)
    center_of_mass: Annotated[Vector, Numbers(3, at_most=LARGEST)] = setting(
        default=(0.0, 0.0, 0.0)
    )
    panels: Given[tuple[Panel, ...], Sequence[Panel]] = setting(default=())


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
    moments = tensor[np.triu_indices(3)].tolist()
    if np.linalg.eigvalsh(tensor)[0] <= 0.0 or tensor_fault(moments, list(map(repr, moments))):
        allowed = "principal moments above 0 kg m^2 of which no two sum to less than the third"
        raise InvalidInput(what, value, allowed)
    return frozen(tensor)

"""Bus of a satellite: a box with mass and solar panels, and its URDF elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rules import Number, Numbers, Rule, Text, Vector
from ffsr_plan.core.settings import Given, setting, settings
from ffsr_plan.robots.urdf_validation import LARGEST

LINK = "bus"
"""Name of the root link."""
GOLD = "0.86 0.64 0.22 1"
NAVY = "0.10 0.16 0.36 1"


@dataclass(frozen=True)
class BoxSize(Rule):
    """(3,) lengths of a box's sides [m], greater than 0."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        size = place(what, value)  # type: ignore[arg-type]
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
            value = _box_inertia(others["mass"], others["size"])
        return _inertia(what, value)  # type: ignore[arg-type]


@settings(eq=False, of="a panel")
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


@settings(eq=False, of="the bus")
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


def elements(bus: Bus) -> list[ElementTree.Element]:
    """URDF links and joints of a bus with its panels, the root link first."""
    root = box_link(LINK, bus.size, bus.mass, GOLD)
    root[0] = _inertial(bus.mass, bus.inertia, bus.center_of_mass)
    found = [root]
    for k, panel in enumerate(bus.panels, 1):
        name = panel.name or f"panel_{k}"
        found.append(box_link(name, panel.size, panel.mass, NAVY))
        found.append(fixed_joint(f"{LINK}_to_{name}", name, panel.position, panel.attitude))
    return found


def box_link(
    name: str, size: ArrayLike, mass: float, colour: str, middle: ArrayLike = (0.0, 0.0, 0.0)
) -> ElementTree.Element:
    """A homogeneous box of sides (3,) about a point (3,) of its frame [m], as a URDF link."""
    link = ElementTree.Element("link", name=name)
    link.append(_inertial(mass, np.diag(_box_inertia(mass, size)), middle))
    visual = box_shape("visual", size, middle)
    material = ElementTree.SubElement(visual, "material", name=f"{name}_colour")
    ElementTree.SubElement(material, "color", rgba=colour)
    link.extend([visual, box_shape("collision", size, middle)])
    return link


def fixed_joint(
    name: str, child: str, position: ArrayLike, attitude: ArrayLike
) -> ElementTree.Element:
    """A joint that fixes a link to the bus, at (3,) [m] and ZYX angles (3,) [rad]."""
    joint = ElementTree.Element("joint", name=name, type="fixed")
    alpha, beta, gamma = np.asarray(attitude)
    ElementTree.SubElement(joint, "origin", xyz=text(position), rpy=text([gamma, beta, alpha]))
    ElementTree.SubElement(joint, "parent", link=LINK)
    ElementTree.SubElement(joint, "child", link=child)
    return joint


def box_shape(
    kind: str, size: ArrayLike, position: ArrayLike, rpy: str = "0 0 0"
) -> ElementTree.Element:
    """A `<collision>` or `<visual>` box of sides (3,) about a point (3,) [m]."""
    shape = ElementTree.Element(kind)
    ElementTree.SubElement(shape, "origin", xyz=text(position), rpy=rpy)
    ElementTree.SubElement(ElementTree.SubElement(shape, "geometry"), "box", size=text(size))
    return shape


def text(numbers: ArrayLike) -> str:
    """Numbers as a URDF attribute, with all their digits."""
    words = (repr(float(n)) for n in np.asarray(numbers, dtype=np.float64).ravel())
    return " ".join(word.removesuffix(".0") for word in words)


def place(what: str, value: ArrayLike) -> Array:
    """(3,) [m] within what a URDF may hold."""
    return finite_array(what, value, (3,), LARGEST)


def _box_inertia(mass: float, size: ArrayLike) -> Array:
    """(3,) moments of a homogeneous box about its middle."""
    x, y, z = np.asarray(size) ** 2
    return mass / 12.0 * np.array([y + z, x + z, x + y])


def _inertia(what: str, value: ArrayLike) -> Array:
    """(3, 3), if it is that of a body with mass in all three directions."""
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


def _inertial(mass: float, inertia: Array, center: ArrayLike) -> ElementTree.Element:
    inertial = ElementTree.Element("inertial")
    ElementTree.SubElement(inertial, "origin", xyz=text(center), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=text(mass))
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = inertia
    moments = {"ixx": ixx, "ixy": ixy, "ixz": ixz, "iyy": iyy, "iyz": iyz, "izz": izz}
    ElementTree.SubElement(inertial, "inertia", {k: text(v) for k, v in moments.items()})
    return inertial

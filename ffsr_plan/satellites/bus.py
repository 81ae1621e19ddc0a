"""The satellite's bus: a box with mass, solar panels on it, as a URDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf_validation import LARGEST

LINK = "bus"
"""Name of the root link."""
GOLD = "0.86 0.64 0.22 1"
NAVY = "0.10 0.16 0.36 1"


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


def _size(what: str, value: ArrayLike) -> Array:
    size = place(what, value)
    if not np.all(size > 0.0):
        raise InvalidInput(what, value, "three numbers greater than 0 m")
    return size


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


def _inertial(mass: float, inertia: ArrayLike | None, center: ArrayLike) -> ElementTree.Element:
    inertial = ElementTree.Element("inertial")
    ElementTree.SubElement(inertial, "origin", xyz=text(center), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=text(mass))
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = np.asarray(inertia, dtype=np.float64)
    moments = {"ixx": ixx, "ixy": ixy, "ixz": ixz, "iyy": iyy, "iyz": iyz, "izz": izz}
    ElementTree.SubElement(inertial, "inertia", {k: text(v) for k, v in moments.items()})
    return inertial

"""URDF elements of a bus, of boxes and of fixed joints."""

from __future__ import annotations

from typing import cast
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.robots.urdf.number_texts import attribute_text
from ffsr_plan.satellites.bus import Bus, box_inertia

BUS_LINK = "bus"
"""Name of the root link."""
GOLD = "0.86 0.64 0.22 1"
NAVY = "0.1 0.16 0.36 1"


def bus_elements(bus: Bus) -> list[ElementTree.Element]:
    """URDF links and joints of a bus with its panels.

    Args:
        bus: the bus.

    Returns:
        The root link, then a link and a fixed joint for each panel.
    """
    root = box_link(BUS_LINK, bus.size, bus.mass, GOLD)
    root[0] = inertial(bus.mass, bus.inertia, bus.center_of_mass)
    elements = [root]
    for k, panel in enumerate(bus.panels, 1):
        name = panel.name or f"panel_{k}"
        elements.append(box_link(name, panel.size, panel.mass, NAVY))
        joint = fixed_joint(f"{BUS_LINK}_to_{name}", name, panel.position, panel.attitude)
        elements.append(joint)
    return elements


def box_link(
    name: str, size: ArrayLike, mass: float, colour: str, center: ArrayLike = (0.0, 0.0, 0.0)
) -> ElementTree.Element:
    """A `<link>` that is a homogeneous box.

    Args:
        name: name of the link.
        size: (3,) lengths of the sides [m].
        mass: [kg].
        colour: red, green, blue and opacity, each 0 to 1.
        center: (3,) centre of the box in the link's frame [m].
    """
    link = ElementTree.Element("link", name=name)
    link.append(inertial(mass, np.diag(box_inertia(mass, size)), center))
    visual = box_shape("visual", size, center)
    material = ElementTree.SubElement(visual, "material", name=f"{name}_colour")
    ElementTree.SubElement(material, "color", rgba=colour)
    link.extend([visual, box_shape("collision", size, center)])
    return link


def fixed_joint(
    name: str, child: str, position: ArrayLike, attitude: ArrayLike
) -> ElementTree.Element:
    """A `<joint>` that fixes a link to the bus.

    Args:
        name: name of the joint.
        child: name of the link.
        position: (3,) origin of the link in the bus frame [m].
        attitude: (3,) ZYX angles (alpha, beta, gamma) of the link in the bus frame [rad].
    """
    joint = ElementTree.Element("joint", name=name, type="fixed")
    alpha, beta, gamma = np.asarray(attitude)
    rpy = attribute_text([gamma, beta, alpha])
    ElementTree.SubElement(joint, "origin", xyz=attribute_text(position), rpy=rpy)
    ElementTree.SubElement(joint, "parent", link=BUS_LINK)
    ElementTree.SubElement(joint, "child", link=child)
    return joint


def box_shape(
    tag: str, size: ArrayLike, center: ArrayLike, rpy: str = "0 0 0"
) -> ElementTree.Element:
    """A `<collision>` or `<visual>` box.

    Args:
        tag: `collision` or `visual`.
        size: (3,) lengths of the sides [m].
        center: (3,) centre of the box in the link's frame [m].
        rpy: roll, pitch and yaw of the box, as text [rad].
    """
    shape = ElementTree.Element(tag)
    ElementTree.SubElement(shape, "origin", xyz=attribute_text(center), rpy=rpy)
    geometry = ElementTree.SubElement(shape, "geometry")
    ElementTree.SubElement(geometry, "box", size=attribute_text(size))
    return shape


def inertial(mass: float, inertia: ArrayLike, center: ArrayLike) -> ElementTree.Element:
    """An `<inertial>`.

    Args:
        mass: [kg].
        inertia: (3, 3) about the centre of mass, axes of the link [kg m^2].
        center: (3,) centre of mass in the link's frame [m].
    """
    element = ElementTree.Element("inertial")
    ElementTree.SubElement(element, "origin", xyz=attribute_text(center), rpy="0 0 0")
    ElementTree.SubElement(element, "mass", value=attribute_text(mass))
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = np.asarray(inertia, dtype=np.float64)
    moments = {"ixx": ixx, "ixy": ixy, "ixz": ixz, "iyy": iyy, "iyz": iyz, "izz": izz}
    attributes = {key: attribute_text(value) for key, value in moments.items()}
    ElementTree.SubElement(element, "inertia", attributes)
    return element


def comment(text: str) -> ElementTree.Element:
    """An XML comment; double hyphens, which XML forbids there, become underscores.

    Args:
        text: the comment.
    """
    return cast("ElementTree.Element", ElementTree.Comment(f" {text.replace('--', '__')} "))

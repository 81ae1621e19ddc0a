"""A robot whose root link is fixed to a bus: mass and inertia added to that link."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, finite_array, number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.robot import SpaceRobot

_GYRATION = 0.25  # [m^2] moment per mass where none is given: a radius of gyration of half a metre
_LARGEST = 1e9  # [kg, kg m^2]
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def on_bus(
    robot: SpaceRobot,
    mass: float,
    inertia: ArrayLike | None = None,
    center_of_mass: ArrayLike = (0.0, 0.0, 0.0),
) -> SpaceRobot:
    """The same robot with the mass of a bus added to its root link; its shapes do not change.

    This makes a free-flying robot of the URDF of an arm, whose root link is light or has no mass.

    Args:
        robot: the robot.
        mass: of the bus [kg].
        inertia: (3,) principal moments of the bus along the axes of the root link, about the centre
            of mass of the bus [kg m^2]; by default 0.25 m^2 times the mass, each.
        center_of_mass: (3,) of the bus in the frame of the root link [m].

    Returns:
        The new robot.

    Raises:
        InvalidInput: not a robot, or a number that is not allowed, such as moments of which two sum
            to less than the third.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    mass = number("base mass", mass, above=0.0, at_most=_LARGEST)
    given = np.full(3, _GYRATION * mass) if inertia is None else inertia
    moments = finite_array("base inertia", given, (3,))
    if np.any(moments <= 0.0) or np.any(moments.sum() < 2.0 * moments):
        allowed = "three moments above 0 kg m^2 of which no two sum to less than the third"
        raise InvalidInput("base inertia", moments.tolist(), allowed)
    center = finite_array("base center_of_mass", center_of_mass, (3,), FARTHEST)
    root = ElementTree.fromstring(robot.urdf)
    children = {str(child.get("link")) for child in root.findall("joint/child")}
    link = next(each for each in root.findall("link") if each.get("name") not in children)
    bus = pin.Inertia(mass, np.array(center), np.diag(moments))
    _replace(link, _inertia(link) + bus)
    return robot_from_urdf(
        ElementTree.tostring(root, encoding="unicode"),
        robot.name,
        robot.package_dirs,
        srdf=robot.srdf,
        containers=robot.containers,
        meshes=robot.meshes,
        collision="ignore",  # what has no shape in the canonical text has none by choice
    )


def _inertia(link: ElementTree.Element) -> pin.Inertia:
    """Mass and inertia of a link of a canonical URDF, in its frame; zero without."""
    inertial = link.find("inertial")
    if inertial is None:
        return pin.Inertia.Zero()
    origin, mass, tensor = (inertial.find(name) for name in ("origin", "mass", "inertia"))
    xyz, rpy = _numbers(origin, "xyz"), _numbers(origin, "rpy")
    value = 0.0 if mass is None else float(mass.get("value", "0"))
    rows = np.zeros((3, 3))
    if tensor is not None:
        rows[np.triu_indices(3)] = [float(tensor.get(name, "0")) for name in _MOMENTS]
    rows = np.triu(rows) + np.triu(rows, 1).T
    turned = pin.rpy.rpyToMatrix(rpy)
    return pin.Inertia(value, xyz, turned @ rows @ turned.T)


def _numbers(element: ElementTree.Element | None, name: str) -> Array:
    text = "0 0 0" if element is None else element.get(name, "0 0 0")
    return np.array([float(each) for each in text.split()])


def _replace(link: ElementTree.Element, inertia: pin.Inertia) -> None:
    """Give a link this mass and inertia."""
    for old in link.findall("inertial"):
        link.remove(old)
    inertial = ElementTree.Element("inertial")
    xyz = " ".join(map(repr, inertia.lever.tolist()))
    ElementTree.SubElement(inertial, "origin", xyz=xyz, rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=repr(float(inertia.mass)))
    moments = inertia.inertia[np.triu_indices(3)].tolist()
    attributes = {name: repr(value) for name, value in zip(_MOMENTS, moments, strict=True)}
    ElementTree.SubElement(inertial, "inertia", attributes)
    link.insert(0, inertial)

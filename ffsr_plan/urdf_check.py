"""What Pinocchio would swallow in silence, checked on the URDF text before it sees it.

Pinocchio drops the collision shapes of a link whose mass is not a number, turns a zero axis into
something that is no rotation, and accepts negative masses. Each of these is an error here.
"""

from __future__ import annotations

import math
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.errors import InvalidInput

SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
    "cylinder": {"radius": 1, "length": 1},
    "mesh": {},
}  # positive sizes by attribute, and how many numbers each holds
JOINTS = ("revolute", "continuous", "prismatic", "fixed")


class Counts(NamedTuple):
    """What a loader must find again in the model."""

    links: int
    collisions: int


def check_urdf(text: str, where: str) -> Counts:
    """Check the URDF `text`; `where` (a file or robot name) starts every message.

    Raises:
        InvalidInput: naming the link or joint, the value and what is allowed.
    """
    root = parse(text, where)
    links = root.findall("link")
    for link in links:
        _check_inertia(link, f"{where}, link '{link.get('name')}'")
        for element in link.findall("collision"):
            _check_collision(element, f"{where}, link '{link.get('name')}', collision")
    for joint in root.findall("joint"):
        _check_joint(joint, f"{where}, joint '{joint.get('name')}'")
    return Counts(len(links), len(root.findall("link/collision")))


def parse(text: str, where: str) -> ElementTree.Element:
    """The `<robot>` element of a URDF or SRDF; entities are refused, not expanded.

    Raises:
        InvalidInput: a document type, not XML, or another element at the top.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(where, "a DOCTYPE or ENTITY", "plain XML without a document type")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InvalidInput(where, str(error), "well-formed XML") from None
    if root.tag != "robot":
        raise InvalidInput(where, f"<{root.tag}>", "a <robot> element at the top")
    return root


def numbers(where: str, text: str | None, count: int) -> list[float]:
    """`count` finite numbers of an attribute, or `InvalidInput` that names it."""
    allowed = f"{count} finite number{'s' if count > 1 else ''}"
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        raise InvalidInput(where, text, allowed) from None
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InvalidInput(where, text, allowed)
    return values


def _check_inertia(link: ElementTree.Element, where: str) -> None:
    inertial = link.find("inertial")
    if inertial is None:
        return  # a frame without mass; that the base has one is checked after loading
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        raise InvalidInput(where, "inertial without mass or inertia", "both of them")
    (value,) = numbers(f"{where}, mass", mass.get("value"), 1)
    if value <= 0.0:
        raise InvalidInput(f"{where}, mass", value, "greater than 0 kg")
    entry = {
        key: numbers(f"{where}, {key}", inertia.get(key), 1)[0]
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    tensor = np.array(
        [
            [entry["ixx"], entry["ixy"], entry["ixz"]],
            [entry["ixy"], entry["iyy"], entry["iyz"]],
            [entry["ixz"], entry["iyz"], entry["izz"]],
        ]
    )
    small, middle, large = np.linalg.eigvalsh(tensor)
    if small < 0.0 or small + middle < large * (1.0 - 1e-9):
        raise InvalidInput(
            f"{where}, inertia",
            [float(small), float(middle), float(large)],
            "principal moments >= 0 of which no two sum to less than the third",
        )


def _check_collision(collision: ElementTree.Element, where: str) -> None:
    origin = collision.find("origin")
    for key in ("xyz", "rpy"):
        if origin is not None and origin.get(key) is not None:
            numbers(f"{where} origin, {key}", origin.get(key), 3)
    shapes = collision.findall("geometry/*")
    if len(shapes) != 1 or shapes[0].tag not in SHAPES:
        found = ", ".join(shape.tag for shape in shapes) or None
        raise InvalidInput(where, found, f"one shape of: {', '.join(SHAPES)}")
    shape = shapes[0]
    where = f"{where} {shape.tag}"
    for key, count in SHAPES[shape.tag].items():
        sizes = numbers(f"{where}, {key}", shape.get(key), count)
        if min(sizes) <= 0.0:
            raise InvalidInput(f"{where}, {key}", sizes, "greater than 0 m")
    if shape.tag == "mesh":
        if not shape.get("filename"):
            raise InvalidInput(f"{where}, filename", shape.get("filename"), "the address of a file")
        scale = numbers(f"{where}, scale", shape.get("scale", "1 1 1"), 3)
        if 0.0 in scale:
            raise InvalidInput(f"{where}, scale", scale, "three numbers other than 0")


def _check_joint(joint: ElementTree.Element, where: str) -> None:
    kind = joint.get("type")
    if kind not in JOINTS:
        raise InvalidInput(f"{where}, type", kind, ", ".join(JOINTS))
    if joint.find("mimic") is not None:
        raise InvalidInput(where, "mimic", "joints that move on their own")
    axis = joint.find("axis")
    if kind != "fixed" and axis is not None:
        values = numbers(f"{where}, axis", axis.get("xyz"), 3)
        if abs(math.hypot(*values) - 1.0) > 1e-3:
            raise InvalidInput(f"{where}, axis", values, "a vector of length 1")
    if kind in ("revolute", "prismatic"):
        limit = joint.find("limit")
        if limit is None:
            raise InvalidInput(f"{where}, limit", None, "a <limit> with lower and upper")
        (lower,) = numbers(f"{where}, lower limit", limit.get("lower", "0"), 1)
        (upper,) = numbers(f"{where}, upper limit", limit.get("upper", "0"), 1)
        if lower >= upper:
            raise InvalidInput(f"{where}, limit", [lower, upper], "lower less than upper")

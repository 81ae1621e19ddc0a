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

SHAPES = ("box", "sphere")
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
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(where, "a DOCTYPE or ENTITY", "plain URDF without a document type")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InvalidInput(where, str(error), "well-formed XML") from None
    if root.tag != "robot":
        raise InvalidInput(where, f"<{root.tag}>", "a <robot> element at the top")
    links = root.findall("link")
    for link in links:
        _check_inertia(link, f"{where}, link '{link.get('name')}'")
        for element in link.findall("collision/geometry/*"):
            _check_shape(element, f"{where}, link '{link.get('name')}', collision")
    for joint in root.findall("joint"):
        _check_joint(joint, f"{where}, joint '{joint.get('name')}'")
    return Counts(len(links), len(root.findall("link/collision")))


def _numbers(where: str, text: str | None, count: int) -> list[float]:
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
    (value,) = _numbers(f"{where}, mass", mass.get("value"), 1)
    if value <= 0.0:
        raise InvalidInput(f"{where}, mass", value, "greater than 0 kg")
    entry = {
        key: _numbers(f"{where}, {key}", inertia.get(key), 1)[0]
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


def _check_shape(element: ElementTree.Element, where: str) -> None:
    if element.tag not in SHAPES:
        raise InvalidInput(where, element.tag, f"collision shapes {' and '.join(SHAPES)}")
    key, count = ("size", 3) if element.tag == "box" else ("radius", 1)
    sizes = _numbers(f"{where} {element.tag}, {key}", element.get(key), count)
    if min(sizes) <= 0.0:
        raise InvalidInput(f"{where} {element.tag}, {key}", sizes, "greater than 0 m")


def _check_joint(joint: ElementTree.Element, where: str) -> None:
    kind = joint.get("type")
    if kind not in JOINTS:
        raise InvalidInput(f"{where}, type", kind, ", ".join(JOINTS))
    if joint.find("mimic") is not None:
        raise InvalidInput(where, "mimic", "joints that move on their own")
    axis = joint.find("axis")
    if kind != "fixed" and axis is not None:
        values = _numbers(f"{where}, axis", axis.get("xyz"), 3)
        if abs(math.hypot(*values) - 1.0) > 1e-3:
            raise InvalidInput(f"{where}, axis", values, "a vector of length 1")
    if kind in ("revolute", "prismatic"):
        limit = joint.find("limit")
        if limit is None:
            raise InvalidInput(f"{where}, limit", None, "a <limit> with lower and upper")
        (lower,) = _numbers(f"{where}, lower limit", limit.get("lower", "0"), 1)
        (upper,) = _numbers(f"{where}, upper limit", limit.get("upper", "0"), 1)
        if lower >= upper:
            raise InvalidInput(f"{where}, limit", [lower, upper], "lower less than upper")

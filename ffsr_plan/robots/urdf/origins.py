"""Placements: `<origin>` with roll, pitch and yaw, or with the quaternion of URDF 1.1."""

from __future__ import annotations

import math
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.known_elements import check_element
from ffsr_plan.robots.urdf.number_texts import attribute_numbers, attribute_text, numbers
from ffsr_plan.robots.urdf.xml_reading import placed_errors, refused

LARGEST = 1000.0
"""Limit [m] of any size, coordinate or prismatic limit: Coal's errors grow with the sizes, and the
proofs allow 1e-7 m for them."""


def lengths(where: str, text: str | None, count: int) -> list[float]:
    """Parse `count` lengths [m], none of them beyond `LARGEST`; see `numbers`."""
    values = numbers(where, text, count)
    if max(map(abs, values)) > LARGEST:
        raise InvalidInput(where, values, f"at most {LARGEST:g} m")
    return values


def add_origin(part: ElementTree.Element, element: ElementTree.Element, where: str) -> None:
    """Add the canonical `<origin>` of an element to its canonical copy, if it has one.

    Args:
        part: the copy.
        element: a joint, an inertial or a shape.
        where: what has the origin, for the message.

    Raises:
        InvalidInput: not three numbers, too large, a quaternion not of length 1, or both `rpy` and
            `quat_xyzw`.
    """
    origin = element.find("origin")
    if origin is None:
        return
    about = f"{where} origin"
    check_element(origin, about)
    with placed_errors(origin):
        xyz = lengths(f"{about}, xyz", origin.get("xyz", "0 0 0"), 3)
        rpy = numbers(f"{about}, rpy", origin.get("rpy", "0 0 0"), 3)
        if (text := origin.get("quat_xyzw")) is not None:
            if "rpy" in origin.attrib:
                raise refused(origin, about, "rpy and quat_xyzw", "one of the two")
            quat = numbers(f"{about}, quat_xyzw", text, 4)
            norm = math.hypot(*quat)
            if abs(norm - 1.0) > 1e-3:
                allowed = "a quaternion (x, y, z, w) of length 1"
                raise refused(origin, f"{about}, quat_xyzw", quat, allowed)
            rpy = roll_pitch_yaw(rotations.matrix(np.array(quat) / norm))
    ElementTree.SubElement(part, "origin", xyz=attribute_text(xyz), rpy=attribute_text(rpy))


def transform(element: ElementTree.Element) -> tuple[Array, Array]:
    """Rotation (3, 3) and translation (3,) [m] of the `<origin>` of a canonical element."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(3), np.zeros(3)
    roll, pitch, yaw = attribute_numbers(origin, "rpy", "0 0 0")
    rotation = _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)
    return rotation, attribute_numbers(origin, "xyz", "0 0 0")


def roll_pitch_yaw(rotation: Array) -> list[float]:
    """Roll, pitch and yaw of a rotation matrix (3, 3); accurate near their singularity too."""
    yaw = float(np.arctan2(rotation[1, 0], rotation[0, 0]))
    pitch = float(np.arctan2(-rotation[2, 0], np.hypot(rotation[0, 0], rotation[1, 0])))
    sine, cosine = np.sin(yaw), np.cos(yaw)
    # second row of Rz(-yaw) R: roll fits the yaw used, also where yaw is arbitrary
    rest = -sine * rotation[0] + cosine * rotation[1]
    return [float(np.arctan2(-rest[2], rest[1])), pitch, yaw]


def _about(axis: int, angle: float) -> Array:
    """(3, 3) rotation about a coordinate axis."""
    result, (i, j) = np.eye(3), ((1, 2), (2, 0), (0, 1))[axis]
    result[i, i] = result[j, j] = np.cos(angle)
    result[j, i] = np.sin(angle)
    result[i, j] = -result[j, i]
    return result

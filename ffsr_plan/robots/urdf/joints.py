"""Joints in canonical form, and their limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.known_elements import check_element
from ffsr_plan.robots.urdf.number_texts import attribute_text, numbers
from ffsr_plan.robots.urdf.origins import add_origin, lengths
from ffsr_plan.robots.urdf.xml_reading import is_comment, placed_errors, refused

JOINTS = ("revolute", "continuous", "prismatic", "fixed")
NO_JOINT = "no joint, as none of the robot's joints moves"
"""What messages allow where the name of a joint is wrong and there is none."""
_AT_LEAST_ZERO = ("effort", "velocity")
_ABOVE_ZERO = ("acceleration", "deceleration", "jerk")
_OF_MIMIC = {"multiplier": "1", "offset": "0"}
_OF_DYNAMICS = ("damping", "friction")


class RateLimits(NamedTuple):
    """Limits of URDF 1.2 that Pinocchio does not know; infinity where the file has none.

    Attributes:
        acceleration: the lesser of acceleration and deceleration [rad/s^2 or m/s^2].
        jerk: [rad/s^3 or m/s^3].
    """

    acceleration: float
    jerk: float


def canonical_joint(joint: ElementTree.Element, where: str) -> ElementTree.Element:
    """A joint in canonical form; what does not concern a fixed joint is left out.

    Args:
        joint: the `<joint>`.
        where: file or robot name and joint, for the message.

    Raises:
        InvalidInput: names the element, the value and what is allowed.
    """
    check_element(joint, where)
    kind = joint.get("type")
    if kind not in JOINTS:
        raise refused(joint, f"{where}, type", kind, ", ".join(JOINTS))
    copy = ElementTree.Element("joint", name=str(joint.get("name")), type=kind)
    add_origin(copy, joint, where)
    for key in ("parent", "child"):
        end = joint.find(key)
        if end is None or not end.get("link"):
            raise refused(joint, f"{where}, {key}", None, "a link")
        check_element(end, f"{where}, {key}")
        ElementTree.SubElement(copy, key, link=str(end.get("link")))
    limit = _limit(joint, kind, where)
    # what a fixed joint says of its motion is read, for wrong numbers in it, and then left out
    moving = copy if kind != "fixed" else ElementTree.Element("joint")
    _add_axis(moving, joint, where, any_length=kind == "fixed")
    moving.extend([] if limit is None else [limit])
    _add_mimic(moving, joint, where)
    _add_dynamics(moving, joint, where)
    copy.extend(part for part in joint if is_comment(part))
    return copy


def rate_limits(robot: ElementTree.Element) -> Mapping[str, RateLimits]:
    """Limits of acceleration and jerk of the moving joints of a canonical robot, by name."""
    found = {}
    for joint in robot.findall("joint"):
        given = {} if (limit := joint.find("limit")) is None else limit.attrib
        values = {key: float(given.get(key, "inf")) for key in _ABOVE_ZERO}
        least = min(values["acceleration"], values["deceleration"])
        found[str(joint.get("name"))] = RateLimits(least, values["jerk"])
    return found


def position_limits(joint: ElementTree.Element) -> tuple[float, float]:
    """Lower and upper limit of a canonical joint [rad or m]; infinite without limits."""
    limit = joint.find("limit")
    if joint.get("type") == "continuous" or limit is None:
        return -math.inf, math.inf
    return float(limit.get("lower", "0")), float(limit.get("upper", "0"))


def check_ranges(robot: ElementTree.Element, where: str) -> None:
    """Check that the moving joints of a canonical robot have a range.

    Args:
        robot: the canonical robot, joints that the user locks being fixed.
        where: file or robot name that starts every message.

    Raises:
        InvalidInput: a range that is empty.
    """
    for joint in robot.findall("joint"):
        about = f"{where}, joint '{joint.get('name')}'"
        lower, upper = position_limits(joint)
        if lower >= upper and joint.get("type") != "fixed":
            raise InvalidInput(f"{about}, limit", [lower, upper], "lower less than upper")


def _add_axis(
    copy: ElementTree.Element, joint: ElementTree.Element, where: str, any_length: bool
) -> None:
    axis = joint.find("axis")
    if axis is None:
        ElementTree.SubElement(copy, "axis", xyz="1 0 0")
        return
    check_element(axis, f"{where}, axis")
    with placed_errors(axis):
        values = numbers(f"{where}, axis", axis.get("xyz"), 3)
        norm = math.hypot(*values)
        if abs(norm - 1.0) > 1e-3 and not any_length:
            raise InvalidInput(f"{where}, axis", values, "a vector of length 1")
    if abs(norm - 1.0) > 1e-15 and norm > 0.0:  # else a second reading might change the last digit
        values = (np.array(values) / norm).tolist()
    ElementTree.SubElement(copy, "axis", xyz=attribute_text(values))


def _limit(joint: ElementTree.Element, kind: str, where: str) -> ElementTree.Element | None:
    """The canonical `<limit>` of a joint; None if it has none."""
    limit, bounded = joint.find("limit"), kind in ("revolute", "prismatic")
    if limit is None:
        if bounded:
            allowed = "a <limit> with lower, upper, effort and velocity"
            raise refused(joint, f"{where}, limit", None, allowed)
        return None
    about = f"{where}, limit"
    check_element(limit, about)
    kept = ElementTree.Element("limit")
    with placed_errors(limit):
        if bounded:
            check = lengths if kind == "prismatic" else numbers
            for key in ("lower", "upper"):
                (value,) = check(f"{where}, {key} limit", limit.get(key, "0"), 1)
                kept.set(key, attribute_text(value))
        for key in (*_AT_LEAST_ZERO, *_ABOVE_ZERO):
            if key in _ABOVE_ZERO and key not in limit.attrib:
                continue  # Pinocchio refuses limits without the others
            (value,) = numbers(f"{about}, {key}", limit.get(key), 1)
            if value < 0.0 or (value == 0.0 and key in _ABOVE_ZERO):
                least = "at least 0" if key in _AT_LEAST_ZERO else "greater than 0"
                raise InvalidInput(f"{about}, {key}", value, least)
            kept.set(key, attribute_text(value))
    return kept


def _add_mimic(copy: ElementTree.Element, joint: ElementTree.Element, where: str) -> None:
    mimic = joint.find("mimic")
    if mimic is None:
        return
    about = f"{where}, mimic"
    check_element(mimic, about)
    kept = ElementTree.SubElement(copy, "mimic", joint=str(mimic.get("joint")))
    with placed_errors(mimic):
        for key, default in _OF_MIMIC.items():
            (value,) = numbers(f"{about} {key}", mimic.get(key, default), 1)
            kept.set(key, attribute_text(value))


def _add_dynamics(copy: ElementTree.Element, joint: ElementTree.Element, where: str) -> None:
    dynamics = joint.find("dynamics")
    if dynamics is None:
        return
    with placed_errors(dynamics):
        kept = {
            key: attribute_text(numbers(f"{where}, dynamics, {key}", dynamics.get(key), 1))
            for key in _OF_DYNAMICS
            if key in dynamics.attrib
        }
    if kept:
        ElementTree.SubElement(copy, "dynamics", kept)

"""Joints of a URDF that are fixed at a value, and joints that mimic them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.checks import number, unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.joints import NO_JOINT, position_limits
from ffsr_plan.robots.urdf.number_texts import attribute_numbers, attribute_text, numbers
from ffsr_plan.robots.urdf.origins import roll_pitch_yaw

_SAME = 1e-6
"""Difference [rad or m] by which two values for one joint may differ: they are often rounded."""


class _Mimic(NamedTuple):
    """A joint follows another: value = factor * value of the leader + offset."""

    leader: str
    factor: float
    offset: float


def fix_locked_joints(
    robot: ElementTree.Element, locked: Mapping[str, float] | None, where: str
) -> None:
    """Make joints of a URDF fixed, in place, and remove what they mimic.

    Of joints that mimic one another, either the leader or a follower may be named: all others
    follow from it.

    Args:
        robot: the canonical `<robot>` element.
        locked: joints to fix, at a value [rad, or m where prismatic].
        where: name of the robot in messages.

    Raises:
        InvalidInput: an unknown joint, a value outside the joint's limits or two that contradict
            each other, or a joint that mimics one that is not fixed.
    """
    if locked is not None and not isinstance(locked, Mapping):
        raise InvalidInput("locked", locked, "a mapping from joint names to values")
    elements = _take_mimics(robot)
    joints = {str(j.get("name")): j for j in robot.findall("joint") if j.get("type") != "fixed"}
    mimics = {
        name: _mimic(element, name, joints, where)
        for name, element in elements.items()
        if name in joints
    }
    values = {}
    for name, value in (locked or {}).items():
        if name not in joints:
            raise unknown_name(f"{where}, locked", name, joints, NO_JOINT)
        values[name] = _within(joints[name], value, f"{where}, locked '{name}'")
    _follow(values, mimics, joints, where)
    for name, mimic in mimics.items():
        if name not in values:
            about, leader = f"{where}, joint '{name}', mimic", mimic.leader
            allowed = f"joints that move on their own; lock it with locked={{'{leader}': ...}}"
            raise InvalidInput(about, leader, allowed)
    for name, value in values.items():
        _fix(joints[name], value)


def _take_mimics(robot: ElementTree.Element) -> dict[str, ElementTree.Element]:
    """Remove all `<mimic>` elements from the robot; returns them by joint."""
    mimics = {}
    for joint in robot.findall("joint"):
        for mimic in joint.findall("mimic"):
            joint.remove(mimic)
            mimics[str(joint.get("name"))] = mimic
    return mimics


def _mimic(
    element: ElementTree.Element,
    name: str,
    joints: Mapping[str, ElementTree.Element],
    where: str,
) -> _Mimic:
    """What a joint mimics."""
    about, leader = f"{where}, joint '{name}', mimic", element.get("joint")
    if leader == name:
        raise InvalidInput(
            about, f"a mimic of '{name}' itself", "a mimic of another joint that moves"
        )
    if leader is None or leader not in joints:
        raise unknown_name(f"{about} joint", leader, joints, NO_JOINT)
    (factor,) = numbers(f"{about} multiplier", element.get("multiplier", "1"), 1)
    (offset,) = numbers(f"{about} offset", element.get("offset", "0"), 1)
    return _Mimic(leader, factor, offset)


def _follow(
    values: dict[str, float],
    mimics: Mapping[str, _Mimic],
    joints: Mapping[str, ElementTree.Element],
    where: str,
) -> None:
    """Add the values of all joints that follow from those already there, in place."""
    given = {name: name for name in values}  # the joint named in `locked` that a value comes from
    waiting = True
    while waiting:
        waiting = False
        for name, (leader, factor, offset) in mimics.items():
            if leader in values or factor == 0.0:
                source, other = leader, name
                value = factor * values.get(leader, 0.0) + offset
            elif name in values:
                source, other = name, leader
                value = (values[name] - offset) / factor
            else:
                continue
            if other not in values:
                given[other], waiting = given.get(source, source), True
                about = f"{where}, joint '{other}', which follows from '{given[other]}'"
                values[other] = _within(joints[other], _snapped(joints[other], value), about)
            elif abs(values[other] - value) > _SAME * max(1.0, abs(factor)):
                allowed = f"the {value:g} that joint '{name}' mimics (it follows '{leader}')"
                raise InvalidInput(f"{where}, locked '{other}'", values[other], allowed)


def _within(joint: ElementTree.Element, value: object, about: str) -> float:
    """A value [rad or m] inside the joint's limits."""
    low, high = position_limits(joint)
    return number(about, value, at_least=low, at_most=high)


def _snapped(joint: ElementTree.Element, value: float) -> float:
    """A value that is computed, at a limit if it is beyond it by rounding alone."""
    inside = float(np.clip(value, *position_limits(joint)))
    return inside if abs(inside - value) <= _SAME else value


def _fix(joint: ElementTree.Element, value: float) -> None:
    """Fix a joint at a value [rad or m], in place."""
    origin = joint.find("origin")
    if origin is None:
        origin = ElementTree.SubElement(joint, "origin")
    position = attribute_numbers(origin, "xyz", "0 0 0")
    rotation = rotations.from_angles(attribute_numbers(origin, "rpy", "0 0 0")[::-1])
    element = joint.find("axis")
    axis = np.array([1.0, 0.0, 0.0]) if element is None else attribute_numbers(element, "xyz")
    axis /= np.linalg.norm(axis)
    if joint.get("type") == "prismatic":
        position = position + rotations.rotate(rotation, value * axis)
    else:
        rotation = rotations.multiply(rotation, rotations.exp(value * axis))
        origin.set("rpy", attribute_text(roll_pitch_yaw(rotations.matrix(rotation))))
    origin.set("xyz", attribute_text(position))
    joint.set("type", "fixed")
    for tag in ("axis", "limit", "dynamics"):
        for part in joint.findall(tag):
            joint.remove(part)

"""SRDF: pairs of links exempt from self-collision, and named postures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from xml.etree import ElementTree

from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.joints import NO_JOINT
from ffsr_plan.robots.urdf.number_texts import numbers
from ffsr_plan.robots.urdf.xml_reading import parse

NO_POSTURE = "no posture, as no <group_state> of an SRDF gives the robot one"
"""What messages allow where the name of a posture is wrong and there is none."""


def disabled_pairs(text: str, where: str, links: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Pairs of links of the `<disable_collisions>` elements.

    Args:
        text: the SRDF; empty for none.
        where: file or robot name that starts every message.
        links: names of the robot's links.

    Returns:
        The pairs, each sorted, in sorted order.

    Raises:
        InvalidInput: not XML, a document type, a URDF, or a link that the robot does not have.
    """
    if not text:
        return ()
    root, pairs = parse(text, where), set()
    tags = {element.tag for element in root}
    if "link" in tags and not tags & {"disable_collisions", "group_state"}:
        raise InvalidInput(
            where, "a URDF (it has <link> elements)", "an SRDF: disable_collisions, group_state"
        )
    for element in root.findall("disable_collisions"):
        pair = [element.get(key) for key in ("link1", "link2")]
        for key, link in zip(("link1", "link2"), pair, strict=True):
            if link not in links:
                raise unknown_name(f"{where}, disable_collisions {key}", link, links)
        if pair[0] == pair[1]:
            raise InvalidInput(f"{where}, disable_collisions", pair, "two different links")
        first, second = sorted(map(str, pair))
        pairs.add((first, second))
    return tuple(sorted(pairs))


def named_postures(
    text: str,
    where: str,
    limits: Mapping[str, tuple[float, float]],
    unmoved: Sequence[str] = (),
) -> dict[str, dict[str, float]]:
    """Postures of the `<group_state>` elements.

    A posture contains only the joints that it lists. States of one name in several groups are one
    posture, in which a joint has one value. Values of virtual joints, by which an SRDF names the
    free base, and of joints that do not move are ignored; a state of such joints alone is no
    posture.

    Args:
        text: the SRDF; empty for none.
        where: file or robot name that starts every message.
        limits: lower and upper limit of each of the robot's joints, by name [rad or m].
        unmoved: names of joints of the URDF that do not move.

    Returns:
        Joint values [rad or m] by joint, by name of the posture.

    Raises:
        InvalidInput: not XML, two states of one name in one group, a joint that the robot does not
            have or that has two values, or a value that is no number or outside the joint's limits.
    """
    postures: dict[str, dict[str, float]] = {}
    states: set[tuple[str, str | None]] = set()
    root = parse(text, where) if text else ElementTree.Element("robot")
    ignored = {*unmoved, *(joint.get("name") for joint in root.findall("virtual_joint"))}
    for state in root.findall("group_state"):
        name = state.get("name")
        if not name:
            raise InvalidInput(f"{where}, group_state", name, "a name")
        if (name, state.get("group")) in states:
            allowed = "one group_state of each name in a group"
            raise InvalidInput(f"{where}, group_state '{name}'", "two of them", allowed)
        states.add((name, state.get("group")))
        joints = state.findall("joint")
        listed = [joint for joint in joints if joint.get("name") not in ignored - {*limits}]
        if joints and not listed:
            continue
        about, values = f"{where}, group_state '{name}'", postures.setdefault(name, {})
        for joint, value in _joint_values(about, listed, limits):
            if values.setdefault(joint, value) != value:
                both = f"{values[joint]:g} and {value:g}"
                raise InvalidInput(f"{about}, joint '{joint}'", both, "one value")
    return postures


def _joint_values(
    about: str, joints: Sequence[ElementTree.Element], limits: Mapping[str, tuple[float, float]]
) -> Iterator[tuple[str, float]]:
    """Names and values of the joints of a state, each within its limits."""
    for joint in joints:
        name = joint.get("name")
        if name is None or name not in limits:
            raise unknown_name(f"{about}, joint", name, limits, NO_JOINT)
        (value,) = numbers(f"{about}, joint '{name}'", joint.get("value"), 1)
        lower, upper = limits[name]
        if not lower <= value <= upper:
            raise InvalidInput(f"{about}, joint '{name}'", value, f"{lower:g} to {upper:g}")
        yield name, value

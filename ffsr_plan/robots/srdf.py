"""What an SRDF says: pairs of links exempt from self-collision, and named postures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.robots.urdf_validation import numbers, parse


def disabled_pairs(text: str, where: str, links: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """The pairs of `<disable_collisions>`, each sorted, in sorted order; the rest is not read.

    Args:
        text: the SRDF; empty for none.
        where: file or robot name that starts every message.
        links: names of the robot's links.

    Raises:
        InvalidInput: not XML, a document type, a URDF, or a link that the robot does not have.
    """
    if not text:
        return ()
    root, pairs = parse(text, where), set()
    told = [root.find(tag) is not None for tag in ("link", "disable_collisions", "group_state")]
    if told == [True, False, False]:
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
    text: str, where: str, limits: Mapping[str, tuple[float, float]]
) -> dict[str, dict[str, float]]:
    """The postures of `<group_state>`: joint values [rad or m] by joint, by name of the state.

    A posture speaks of the joints that it lists and of no others. States of one name in several
    groups are one posture.

    Args:
        text: the SRDF; empty for none.
        where: file or robot name that starts every message.
        limits: lower and upper limit of each of the robot's joints, by name.

    Raises:
        InvalidInput: not XML, a joint that the robot does not have, or a value that is no number
            or outside the joint's limits.
    """
    postures: dict[str, dict[str, float]] = {}
    for state in parse(text, where).findall("group_state") if text else ():
        name = state.get("name")
        if not name:
            raise InvalidInput(f"{where}, group_state", name, "a name")
        values = postures.setdefault(name, {})
        for joint in state.findall("joint"):
            about, named = f"{where}, group_state '{name}'", joint.get("name")
            if named is None or named not in limits:
                raise unknown_name(f"{about}, joint", named, limits)
            (value,) = numbers(f"{about}, joint '{named}'", joint.get("value"), 1)
            lower, upper = limits[named]
            if not lower <= value <= upper:
                allowed = f"{lower:g} to {upper:g}"
                raise InvalidInput(f"{about}, joint '{named}'", value, allowed)
            values[named] = value
    return postures

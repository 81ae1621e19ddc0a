"""Adjacent links, which may touch."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree


def may_touch(robot: ElementTree.Element) -> Callable[[str, str], bool]:
    """Predicate for pairs of links that are exempt from self-collision.

    Two links may touch if they belong to one rigid body, or if exactly one moving joint and no
    other link with a shape lies between them.

    Args:
        robot: the `<robot>` element of a checked URDF.

    Returns:
        A function of two link names.
    """
    above: dict[str, tuple[str, bool]] = {}  # parent link, and whether the joint to it moves
    for joint in robot.findall("joint"):
        ends = {end.tag: str(end.get("link")) for end in joint if end.tag in ("parent", "child")}
        above[ends["child"]] = (ends["parent"], joint.get("type") != "fixed")
    shaped = {link.get("name") for link in robot.findall("link") if link.findall("collision")}

    def chain_to_root(link: str) -> list[str]:
        links = [link]
        while links[-1] in above:
            links.append(above[links[-1]][0])
        return links

    def adjacent(first: str, second: str) -> bool:
        one, other = chain_to_root(first), chain_to_root(second)
        while len(one) > 1 and len(other) > 1 and one[-2] == other[-2]:
            one.pop()
            other.pop()
        moving = sum(above[link][1] for link in (*one[:-1], *other[:-1]))
        between = {*one, *other} - {first, second}
        return moving == 0 or (moving == 1 and not between & shaped)

    return adjacent

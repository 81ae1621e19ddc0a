"""Which links of a robot may touch because of how they are joined."""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree


def may_touch(robot: ElementTree.Element) -> Callable[[str, str], bool]:
    """Whether two links may touch: of one rigid body, or with one moving joint between them.

    Links without a shape of their own, such as mounts, do not count as lying between.
    """
    above: dict[str, tuple[str, bool]] = {}
    for joint in robot.findall("joint"):
        ends = {end.tag: str(end.get("link")) for end in joint if end.tag in ("parent", "child")}
        above[ends["child"]] = (ends["parent"], joint.get("type") != "fixed")
    shaped = {link.get("name") for link in robot.findall("link") if link.findall("collision")}

    def way_up(link: str) -> list[str]:
        links = [link]
        while links[-1] in above:
            links.append(above[links[-1]][0])
        return links

    def tied(first: str, second: str) -> bool:
        up, down = way_up(first), way_up(second)
        while len(up) > 1 and len(down) > 1 and up[-2] == down[-2]:
            up.pop()
            down.pop()
        moving = sum(above[link][1] for link in (*up[:-1], *down[:-1]))
        between = {*up, *down} - {first, second}
        return moving == 0 or (moving == 1 and not between & shaped)

    return tied

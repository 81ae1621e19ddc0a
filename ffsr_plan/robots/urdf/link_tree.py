"""The tree of links: names, ends of joints, one root, and the root of a floating base."""

from __future__ import annotations

from xml.etree import ElementTree

from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.urdf.xml_reading import placed, refused

_RESERVED_JOINTS = ("universe", "root_joint")
"""Names of Pinocchio's own joints: it misplaces children of a URDF joint with such a name."""
_MOST_LINKS, _MOST_JOINTS_IN_A_ROW = 1000, 500
_WORLD = "world"


def without_world(robot: ElementTree.Element, where: str) -> None:
    """Remove a `world` link and the floating joint on it, in place; its child becomes the root.

    Args:
        robot: the parsed robot.
        where: file or robot name that starts every message.

    Raises:
        InvalidInput: a floating joint elsewhere, or a `world` link with a mass or a shape.
    """
    floating = [joint for joint in robot.findall("joint") if joint.get("type") == "floating"]
    if not floating:
        return
    joint = floating[0]
    ends = {
        key: end.get("link") for key in ("parent", "child") if (end := joint.find(key)) is not None
    }
    worlds = [link for link in robot.findall("link") if link.get("name") == ends.get("parent")]
    others = [
        end.get("link")
        for other in robot.findall("joint")
        if other is not joint
        for end in other
        if end.tag in ("parent", "child")
    ]
    about = f"{where}, joint '{joint.get('name')}', type"
    allowed = (
        "revolute, continuous, prismatic, fixed; floating only once, from an empty root link to "
        "the base"
    )
    if len(floating) > 1 or len(worlds) != 1 or ends.get("parent") in others:
        raise refused(floating[-1], about, "floating", allowed)
    if any(part.tag in ("inertial", "visual", "collision") for part in worlds[0]):
        value = f"link '{ends['parent']}' with an inertial or a shape"
        raise refused(joint, about, value, allowed)
    robot.remove(joint)
    robot.remove(worlds[0])


def check_tree(robot: ElementTree.Element, where: str) -> None:
    """Check that names are unique and that the joints connect all links to one tree.

    Args:
        robot: the parsed robot.
        where: file or robot name that starts every message.

    Raises:
        InvalidInput: names the link or joint, the value and what is allowed.
    """
    names = {tag: _names(robot, tag, where) for tag in ("link", "joint")}
    links = names["link"]
    if not 1 <= len(links) <= _MOST_LINKS:
        raise InvalidInput(f"{where}, links", len(links), f"1 to {_MOST_LINKS} links")
    for name in _RESERVED_JOINTS:
        if name in names["joint"]:
            allowed = f"a name other than Pinocchio's own: {', '.join(_RESERVED_JOINTS)}"
            raise InvalidInput(f"{where}, joint '{name}', name", name, allowed)
    parents = _parents(robot, names, where)
    roots = [link for link in links if link not in parents]
    if len(roots) > 1:
        allowed = "one link that is no joint's child, with the others below it"
        raise InvalidInput(f"{where}, root links", roots, allowed)
    deepest = _deepest(links, parents, where)
    if deepest > _MOST_JOINTS_IN_A_ROW:
        allowed = f"at most {_MOST_JOINTS_IN_A_ROW}"
        raise InvalidInput(f"{where}, links", f"{deepest} joints in a row", allowed)


def _parents(root: ElementTree.Element, names: dict[str, list[str]], where: str) -> dict[str, str]:
    """Parent link of each link that is the child of a joint; checks the ends of the joints."""
    parents: dict[str, str] = {}
    known = set(names["link"])
    for joint, name in zip(root.findall("joint"), names["joint"], strict=True):
        ends = []
        for key in ("parent", "child"):
            element = joint.find(key)
            link = None if element is None else element.get("link")
            if link is None or link not in known:
                about = f"{where}, joint '{name}', {key}"
                raise placed(joint, unknown_name(about, link, names["link"]))
            ends.append(link)
        parent, child = ends
        if child in parents:
            about = f"{where}, joint '{name}', child"
            raise refused(joint, about, child, "a link of no other joint")
        parents[child] = parent
    return parents


def _deepest(links: list[str], parents: dict[str, str], where: str) -> int:
    """Most joints in a row from the root to a link; `InvalidInput` if links form a cycle."""
    depth = {link: 0 for link in links if link not in parents}
    for link in links:
        above: list[str] = []
        while link not in depth:
            if link in above:
                cycle = above[above.index(link) :]
                raise InvalidInput(f"{where}, joints", cycle, "no links that carry each other")
            above.append(link)
            link = parents[link]  # towards the root, to a link of known depth
        for known, below in enumerate(reversed(above), depth[link] + 1):
            depth[below] = known
    return max(depth.values())


def _names(root: ElementTree.Element, tag: str, where: str) -> list[str]:
    """Names of all links or joints; checks that they differ."""
    names: dict[str, None] = {}
    for number, element in enumerate(root.findall(tag)):
        name = element.get("name")
        if not name:
            raise refused(element, f"{where}, {tag} number {number}, name", name, "a name")
        if name in names:
            allowed = f"a name of one {tag} only"
            raise refused(element, f"{where}, {tag} '{name}', name", name, allowed)
        names[name] = None
    return list(names)

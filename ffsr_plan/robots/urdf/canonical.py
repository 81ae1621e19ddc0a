"""The canonical URDF: what was read of a robot, and nothing else, written one way.

Pinocchio, the reader of shapes, the independent check, plan files, `SpaceRobot.save` and `compose`
all receive this text, so that none of them can read a file differently from the others. It holds
known elements only, numbers with all their digits, and orientations as roll, pitch and yaw. Reading
it once more gives the same text.
"""

from __future__ import annotations

from xml.etree import ElementTree

from ffsr_plan.core.checks import one_of
from ffsr_plan.robots.urdf.inertias import INERTIA
from ffsr_plan.robots.urdf.joints import canonical_joint
from ffsr_plan.robots.urdf.known_elements import check_element
from ffsr_plan.robots.urdf.link_tree import check_tree, without_world
from ffsr_plan.robots.urdf.links import COLLISION, canonical_link, check_shapes, colours_of
from ffsr_plan.robots.urdf.xml_reading import is_comment, parse, refused

_VERSIONS = ("1.0", "1.1", "1.2")


def read_urdf(
    text: str, where: str, *, collision: str = "collision", inertia: str = "exact"
) -> ElementTree.Element:
    """Read a URDF.

    Joints that mimic others and empty joint ranges stay in; see `joints.check_ranges`.

    Args:
        text: the URDF.
        where: file or robot name that starts every message.
        collision: `collision` to refuse links with `<visual>` and no `<collision>`, `visual` to
            take their visual shapes, `ignore` to leave them without a shape.
        inertia: `exact` to refuse tensors that no body has, `balance` to take the nearest valid
            ones.

    Returns:
        The canonical `<robot>` element.

    Raises:
        InvalidInput: names the element, the value and what is allowed, and where known the line.
    """
    one_of("collision", collision, COLLISION)
    one_of("inertia", inertia, INERTIA)
    given = parse(text, where)
    check_element(given, f"{where}, robot")
    if not given.get("name"):
        raise refused(given, f"{where}, robot name", given.get("name"), "a name")
    if given.get("version", "1.0").strip() not in _VERSIONS:
        raise refused(given, f"{where}, robot version", given.get("version"), ", ".join(_VERSIONS))
    without_world(given, where)
    check_tree(given, where)
    colours = colours_of(given, where)
    robot = ElementTree.Element("robot", name=str(given.get("name")))
    for part in given:
        about = f"{where}, {part.tag} '{part.get('name')}'"
        if is_comment(part):
            robot.append(part)
        elif part.tag == "link":
            robot.append(canonical_link(part, about, colours, collision, inertia))
        elif part.tag == "joint":
            robot.append(canonical_joint(part, about))
    if collision == "collision":
        check_shapes(robot, where)
    return robot


def urdf_text(robot: ElementTree.Element) -> str:
    """The text of a canonical robot."""
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n"

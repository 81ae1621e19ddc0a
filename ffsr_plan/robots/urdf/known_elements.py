"""Elements and attributes of URDF 1.0 to 1.2, and those that common files add to them.

A misspelt attribute or element would be dropped in silence, and with it an orientation, a limit or
a shape. So in the elements that are used every attribute has to be known. Elements of other tools
(`gazebo`, `transmission`, ...) are ignored with all that they contain.
"""

from __future__ import annotations

from collections import Counter
from difflib import get_close_matches
from typing import NamedTuple
from xml.etree import ElementTree

from ffsr_plan.core.checks import unknown_name
from ffsr_plan.robots.urdf.xml_reading import EXPAND, placed, refused

_MANY = 100_000


class Known(NamedTuple):
    """What an element may have.

    Attributes:
        attributes: names; `None` if none of them is used.
        parts: elements in it, and how many of each there may be.
    """

    attributes: tuple[str, ...] | None
    parts: dict[str, int] = {}  # noqa: RUF012 - never changed


_SHAPE_PARTS = {"origin": 1, "geometry": 1, "material": 1}
SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
    "cylinder": {"radius": 1, "length": 1},
    "mesh": {},
}
"""Positive sizes of each shape: how many numbers each attribute contains."""
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ONCE_IN_A_JOINT = (
    "origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "calibration",
    "safety_controller",
)  # fmt: skip
ELEMENTS = {
    "robot": Known(
        ("version",),
        dict.fromkeys(("link", "joint", "material", "transmission", "gazebo"), _MANY),
    ),
    "link": Known(("type",), {"origin": 1, "inertial": 1, "collision": _MANY, "visual": _MANY}),
    "inertial": Known((), {"origin": 1, "mass": 1, "inertia": 1}),
    "mass": Known(("value",)),
    "inertia": Known(MOMENTS),
    "collision": Known(("group",), _SHAPE_PARTS),
    "visual": Known(("group",), _SHAPE_PARTS),
    "geometry": Known((), dict.fromkeys(SHAPES, 1)),
    "mesh": Known(("filename", "scale")),
    **{tag: Known(tuple(sizes)) for tag, sizes in SHAPES.items() if sizes},
    "material": Known((), {"color": 1, "texture": 1}),
    "color": Known(("rgba",)),
    "texture": Known(("filename",)),
    "joint": Known(("type", "dont_collapse"), dict.fromkeys(_ONCE_IN_A_JOINT, 1)),
    "origin": Known(("xyz", "rpy", "quat_xyzw")),
    "parent": Known(("link",)),
    "child": Known(("link",)),
    "axis": Known(("xyz",)),
    "limit": Known(
        (
            "lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk",
            "command_effort", "current", "gear_velocity",
        )
    ),
    "mimic": Known(("joint", "multiplier", "offset")),
    "dynamics": Known(None),
    "calibration": Known(None),
    "safety_controller": Known(None),
}  # fmt: skip
"""All known elements by their tag; each may have a name as well."""


def check_element(element: ElementTree.Element, where: str) -> None:
    """Check the attributes and parts of a known element.

    Args:
        element: the element.
        where: robot, link or joint, and element, for the message.

    Raises:
        InvalidInput: an unknown attribute, a part that is misspelt, doubled or belongs elsewhere,
            or an expression of xacro in an attribute.
    """
    known = ELEMENTS[element.tag]
    if known.attributes is not None:
        _check_attributes(element, where, ("name", *known.attributes))
    counts = Counter(part.tag for part in element if isinstance(part.tag, str))
    for part in element:
        if not isinstance(part.tag, str):
            continue
        tag, local = part.tag, part.tag.rpartition(":")[2]
        if tag in known.parts:
            if counts[tag] > known.parts[tag]:
                value = f"{counts[tag]} of them"
                raise refused(part, f"{where}, <{tag}>", value, "one of them")
        elif local in ELEMENTS:
            allowed = f"<{local}> without a prefix" if ":" in tag else "no such element there"
            raise refused(part, where, f"<{tag}>", allowed)
        elif ":" not in tag and get_close_matches(tag.lower(), known.parts, 1, 0.75):
            raise placed(part, unknown_name(where, tag, known.parts))


def _check_attributes(element: ElementTree.Element, where: str, known: tuple[str, ...]) -> None:
    """Raise `InvalidInput` for an attribute that is unknown or holds an expression of xacro."""
    for key, value in element.attrib.items():
        local = key.rpartition(":")[2]
        if key not in known:
            if (":" in key and local not in known) or key == "xmlns":
                continue  # of another tool
            raise placed(element, unknown_name(f"{where}, attribute", key, known))
        if "${" in value or "$(" in value:
            raise refused(element, f"{where}, {key}", value, EXPAND)

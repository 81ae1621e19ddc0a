"""Validation of a URDF before Pinocchio loads it.

Pinocchio silently drops the collision shapes of a link whose mass is not a number, accepts negative
masses, and makes of a zero axis a joint that does not rotate. These are errors here. So are inputs
that Pinocchio refuses without a reason (links that form no tree, incomplete limits) and inputs for
which neither Pinocchio nor Coal is made (chains of thousands of links, lengths of kilometres).
"""

from __future__ import annotations

import math
from difflib import get_close_matches
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput, unknown_name

SHAPES: dict[str, dict[str, int]] = {
    "box": {"size": 3},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
    "cylinder": {"radius": 1, "length": 1},
    "mesh": {},
}
"""Positive sizes of each shape: how many numbers each attribute contains."""
JOINTS = ("revolute", "continuous", "prismatic", "fixed")
LARGEST = 1000.0
"""Limit [m] of any size, coordinate or prismatic limit: Coal's errors grow with the sizes, and the
proofs allow 1e-7 m for them."""
HEAVIEST = 1e9
"""Limit [kg] of the mass of a body; beside heavier ones, light bodies are lost in rounding."""
_RESERVED_JOINTS = ("universe", "root_joint")
"""Names of Pinocchio's own joints: it misplaces children of a URDF joint with such a name."""
_MANY = 10_000
_LINK_PARTS = {"inertial": 1, "collision": _MANY, "visual": _MANY}
_JOINT_PARTS = dict.fromkeys(
    (
        "origin",
        "parent",
        "child",
        "axis",
        "limit",
        "mimic",
        "dynamics",
        "calibration",
        "safety_controller",
    ),
    1,
)
_MOST_LINKS, _MOST_JOINTS_IN_A_ROW = 1000, 500
MOST_CHARACTERS = 50_000_000
"""Limit of the length of a URDF or SRDF."""


class Counts(NamedTuple):
    """Numbers of elements of a URDF, which the loaded model must have too.

    Attributes:
        links: number of links.
        collisions: number of collision shapes.
    """

    links: int
    collisions: int


def check_urdf(text: str, where: str) -> Counts:
    """Check a URDF.

    Args:
        text: the URDF.
        where: file or robot name that starts every message.

    Returns:
        Numbers of its links and collision shapes.

    Raises:
        InvalidInput: names the link or joint, the value and what is allowed.
    """
    root = parse(text, where)
    _check_tree(root, where)
    links = root.findall("link")
    for link in links:
        _check_parts(link, f"{where}, link '{link.get('name')}'", _LINK_PARTS)
        _check_inertia(link, f"{where}, link '{link.get('name')}'")
        for element in link.findall("collision"):
            _check_collision(element, f"{where}, link '{link.get('name')}', collision")
    for joint in root.findall("joint"):
        _check_joint(joint, f"{where}, joint '{joint.get('name')}'")
    return Counts(len(links), len(root.findall("link/collision")))


def parse(text: str, where: str) -> ElementTree.Element:
    """Parse a URDF or SRDF. Entities are refused, not expanded.

    Args:
        text: the URDF or SRDF.
        where: file or robot name that starts every message.

    Returns:
        The `<robot>` element.

    Raises:
        InvalidInput: a document type, not XML, too long, or another element at the top.
    """
    if len(text) > MOST_CHARACTERS:
        raise InvalidInput(where, f"{len(text)} characters", f"at most {MOST_CHARACTERS}")
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InvalidInput(where, "a DOCTYPE or ENTITY", "plain XML without a document type")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InvalidInput(where, str(error), "well-formed XML") from None
    if root.tag != "robot":
        raise InvalidInput(where, f"<{root.tag}>", "a <robot> element at the top")
    return root


def numbers(where: str, text: str | None, count: int) -> list[float]:
    """Parse and check the numbers of an attribute.

    Args:
        where: link or joint and attribute, for the message.
        text: the attribute; None if it is missing.
        count: how many finite numbers it must contain.

    Returns:
        The numbers.

    Raises:
        InvalidInput: other than `count` finite numbers.
    """
    allowed = f"{count} finite number{'s' if count > 1 else ''}"
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        raise InvalidInput(where, text, allowed) from None
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InvalidInput(where, text, allowed)
    return values


def attribute_numbers(element: ElementTree.Element, key: str, default: str = "") -> Array:
    """Parse the numbers of an attribute that has been checked.

    Args:
        element: the element of a checked URDF.
        key: name of the attribute.
        default: its text if it is missing.

    Returns:
        (n,) the numbers.
    """
    return np.array([float(word) for word in element.get(key, default).split()])


def _lengths(where: str, text: str | None, count: int) -> list[float]:
    """Parse `count` lengths [m], none of them beyond `LARGEST`; see `numbers`."""
    values = numbers(where, text, count)
    if max(map(abs, values)) > LARGEST:
        raise InvalidInput(where, values, f"at most {LARGEST:g} m")
    return values


def _check_origin(element: ElementTree.Element, where: str) -> None:
    origin = element.find("origin")
    if origin is None:
        return
    for key, check in (("xyz", _lengths), ("rpy", numbers)):
        if origin.get(key) is not None:
            check(f"{where} origin, {key}", origin.get(key), 3)


def _check_tree(root: ElementTree.Element, where: str) -> None:
    """Check that names are unique and that the joints connect all links to one tree."""
    names = {tag: _names(root, tag, where) for tag in ("link", "joint")}
    links = names["link"]
    if not 1 <= len(links) <= _MOST_LINKS:
        raise InvalidInput(f"{where}, links", len(links), f"1 to {_MOST_LINKS} links")
    for name in _RESERVED_JOINTS:
        if name in names["joint"]:
            allowed = f"a name other than Pinocchio's own: {', '.join(_RESERVED_JOINTS)}"
            raise InvalidInput(f"{where}, joint '{name}', name", name, allowed)
    parents = _parents(root, names, where)
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
    for joint, name in zip(root.findall("joint"), names["joint"], strict=True):
        ends = []
        for key in ("parent", "child"):
            element = joint.find(key)
            link = None if element is None else element.get("link")
            if link is None or link not in names["link"]:
                raise unknown_name(f"{where}, joint '{name}', {key}", link, names["link"])
            ends.append(link)
        parent, child = ends
        if child in parents:
            raise InvalidInput(f"{where}, joint '{name}', child", child, "a link of no other joint")
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
            raise InvalidInput(f"{where}, {tag} number {number}, name", name, "a name")
        if name in names:
            raise InvalidInput(f"{where}, {tag} '{name}', name", name, f"a name of one {tag} only")
        names[name] = None
    return list(names)


def _check_inertia(link: ElementTree.Element, where: str) -> None:
    inertial = link.find("inertial")
    if inertial is None:
        return  # a frame; `check_loaded` checks that each moving body has a mass
    _check_origin(inertial, f"{where}, inertial")
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        raise InvalidInput(where, "inertial without mass or inertia", "both of them")
    (value,) = numbers(f"{where}, mass", mass.get("value"), 1)
    if value > HEAVIEST:
        raise InvalidInput(f"{where}, mass", value, f"at most {HEAVIEST:g} kg")
    entry = {
        key: numbers(f"{where}, {key}", inertia.get(key), 1)[0]
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    is_frame = value == 0.0 and not any(entry.values())  # some files have such tool frames
    if value <= 0.0 and not is_frame:
        allowed = "greater than 0 kg, or 0 kg without inertia for a frame"
        raise InvalidInput(f"{where}, mass", value, allowed)
    tensor = np.array(
        [
            [entry["ixx"], entry["ixy"], entry["ixz"]],
            [entry["ixy"], entry["iyy"], entry["iyz"]],
            [entry["ixz"], entry["iyz"], entry["izz"]],
        ]
    )
    small, middle, large = np.linalg.eigvalsh(tensor)
    if small < 0.0 or small + middle < large * (1.0 - 1e-9):
        raise InvalidInput(
            f"{where}, inertia",
            [float(small), float(middle), float(large)],
            "principal moments >= 0 of which no two sum to less than the third",
        )


def _check_collision(collision: ElementTree.Element, where: str) -> None:
    _check_origin(collision, where)
    shapes = collision.findall("geometry/*")
    if len(shapes) != 1 or shapes[0].tag not in SHAPES:
        tags = ", ".join(shape.tag for shape in shapes) or None
        raise InvalidInput(where, tags, f"one shape of: {', '.join(SHAPES)}")
    shape = shapes[0]
    where = f"{where} {shape.tag}"
    for key, count in SHAPES[shape.tag].items():
        sizes = _lengths(f"{where}, {key}", shape.get(key), count)
        if min(sizes) <= 0.0:
            raise InvalidInput(f"{where}, {key}", sizes, "greater than 0 m")
    if shape.tag == "mesh":
        if not shape.get("filename"):
            raise InvalidInput(f"{where}, filename", shape.get("filename"), "the address of a file")
        scale = numbers(f"{where}, scale", shape.get("scale", "1 1 1"), 3)
        if 0.0 in scale:
            raise InvalidInput(f"{where}, scale", scale, "three numbers other than 0")


def _check_parts(element: ElementTree.Element, where: str, known: dict[str, int]) -> None:
    """Check that no known part is misspelt or occurs too often.

    Other parts, which some tools add, are ignored.
    """
    tags = [part.tag for part in element if isinstance(part.tag, str)]
    for tag in tags:
        if tag not in known and get_close_matches(tag.lower(), known, 1, 0.75):
            raise unknown_name(where, tag, list(known))
        if tag in known and tags.count(tag) > known[tag]:
            raise InvalidInput(f"{where}, <{tag}>", f"{tags.count(tag)} of them", "one of them")


def _check_joint(joint: ElementTree.Element, where: str) -> None:
    _check_parts(joint, where, _JOINT_PARTS)
    kind = joint.get("type")
    if kind not in JOINTS:
        raise InvalidInput(f"{where}, type", kind, ", ".join(JOINTS))
    if joint.find("mimic") is not None:
        allowed = "joints that move on their own; ffsr_plan.compose fixes others with `locked`"
        raise InvalidInput(where, "mimic", allowed)
    axis = joint.find("axis")
    if kind != "fixed" and axis is not None:
        values = numbers(f"{where}, axis", axis.get("xyz"), 3)
        if abs(math.hypot(*values) - 1.0) > 1e-3:
            raise InvalidInput(f"{where}, axis", values, "a vector of length 1")
    _check_origin(joint, where)
    _check_limit(joint, kind, where)


def _check_limit(joint: ElementTree.Element, kind: str, where: str) -> None:
    limit = joint.find("limit")
    if limit is not None:
        for key in ("effort", "velocity"):  # not used, but Pinocchio refuses limits without them
            (value,) = numbers(f"{where}, limit, {key}", limit.get(key), 1)
            if value < 0.0:
                raise InvalidInput(f"{where}, limit, {key}", value, "at least 0")
    if kind in ("revolute", "prismatic"):
        if limit is None:
            allowed = "a <limit> with lower, upper, effort and velocity"
            raise InvalidInput(f"{where}, limit", None, allowed)
        check = _lengths if kind == "prismatic" else numbers
        (lower,) = check(f"{where}, lower limit", limit.get("lower", "0"), 1)
        (upper,) = check(f"{where}, upper limit", limit.get("upper", "0"), 1)
        if lower >= upper:
            raise InvalidInput(f"{where}, limit", [lower, upper], "lower less than upper")

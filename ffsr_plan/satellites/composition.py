"""Composition of a satellite: arms mounted on a bus, as one self-contained URDF.

Meshes become boxes, because the address of a mesh is valid on one machine only. Capsules of an arm
are kept, although Pinocchio's own reader drops them and yourdfpy refuses them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Annotated, Any
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core.arrays import ReadOnlyDict
from ffsr_plan.core.checks import number, one_of
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import NamedNumbers, Numbers, OneOf, Rule, Text, Vector
from ffsr_plan.core.settings import Given, setting, settings
from ffsr_plan.meshes.box_cover import boxes_around
from ffsr_plan.meshes.hull_reduction import beyond
from ffsr_plan.meshes.mesh_addresses import find
from ffsr_plan.meshes.mesh_files import hull, surface
from ffsr_plan.robots.collision_shapes import origin
from ffsr_plan.robots.loading import robot_from_urdf, warn_of_shapeless_links
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.urdf.inertias import INERTIA
from ffsr_plan.robots.urdf.links import COLLISION
from ffsr_plan.robots.urdf.number_texts import attribute_numbers, attribute_text
from ffsr_plan.robots.urdf.origins import LARGEST
from ffsr_plan.satellites.arms import Arm, load_arm
from ffsr_plan.satellites.bus import Bus
from ffsr_plan.satellites.urdf_xml import (
    box_shape,
    bus_elements,
    comment,
    fixed_joint,
)

SHAPES = ("boxes", "meshes")
_NO_INERTIA = (
    '<inertial><mass value="0"/>'
    '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
)


@dataclass(frozen=True)
class PathOrName(Rule):
    """A path, or a name; for an SRDF also None."""

    meaning: str
    optional: bool = False

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if value is None and self.optional:
            return value
        if not isinstance(value, (str, Path)):
            raise InvalidInput(what, value, self.meaning)
        checked_path(what, value)
        return value


@dataclass(frozen=True)
class Paths(Rule):
    """Paths, kept as texts."""

    meaning: str

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> tuple[str, ...]:
        """See `Rule.check`."""
        if isinstance(value, (str, Path)) or not isinstance(value, Sequence):
            raise InvalidInput(what, value, self.meaning)
        return tuple(str(checked_path(what, each)) for each in value)


@settings(of="a mount")
class Mount:
    """An arm and its place on the bus.

    Attributes:
        arm: the name of an arm (see `arm_names`), or a path to a `.urdf` file.
        position: (3,) origin of the arm's root link in the bus frame [m].
        attitude: (3,) ZYX angles (alpha, beta, gamma) of that link in the bus frame [rad].
        prefix: put before the names of the arm's links and joints.
        locked: joints of the arm that are fixed, by the arm's own names, at a value [rad, or m
            where prismatic]; the planner does not move them. Of joints that mimic one another,
            such as two fingers, name one: the others are fixed with it.
        srdf: path to an SRDF of the arm, by whose `<disable_collisions>` links may touch. An arm
            given by its name has its own, if example-robot-data has one.
        collision: what becomes of links with visual and without collision shapes, as in
            `load_robot`; by default `visual` for an arm given by its name, `collision` for a file.
        inertia: `exact` or `balance`, as in `load_robot`.
        package_dirs: folders in which `package://` and relative mesh addresses are looked up,
            before the folder of the `.urdf` file; see `load_robot`.

    Raises:
        InvalidInput: a value that is not finite, or of another type.
    """

    arm: Annotated[str | Path, PathOrName("a name or a path")]
    position: Annotated[Vector, Numbers(3, at_most=LARGEST)] = setting(default=(0.0, 0.0, 0.0))
    attitude: Annotated[Vector, Numbers(3)] = setting(default=(0.0, 0.0, 0.0))
    prefix: Annotated[str, Text("a text, such as 'left_'")] = ""
    locked: Annotated[
        Given[ReadOnlyDict[str, float], Mapping[str, float]],
        NamedNumbers("a mapping from joint names to values"),
    ] = setting(default_factory=dict)
    srdf: Annotated[str | Path | None, PathOrName("a path", optional=True)] = None
    collision: Annotated[str, OneOf(COLLISION)] | None = None
    inertia: Annotated[str, OneOf(INERTIA)] = "exact"
    package_dirs: Annotated[
        Given[tuple[str, ...], Sequence[str | Path]], Paths("a list of paths")
    ] = setting(default=())


def compose(
    bus: Bus,
    arms: Sequence[Mount],
    name: str = "satellite",
    *,
    shapes: str = "boxes",
    postures: Mapping[str, Mapping[str, float]] | None = None,
    may_touch: Sequence[tuple[str, str]] = (),
) -> SpaceRobot:
    """Mount arms on a bus.

    `robot.urdf` is the URDF text, and `robot.save(path)` writes it. Masses, inertias, joints and
    limits are those of the arms; links without mass stay without mass. Boxes, spheres, cylinders
    and capsules stay as they are. A mesh is replaced by up to three boxes, which contain all that
    the mesh encloses; a comment in the URDF states the mesh's name and how far the boxes protrude
    from its convex hull. The URDF then needs no other file.

    Args:
        bus: the bus, the robot's root link, in whose frame the arms are mounted.
        arms: a `Mount` for each arm.
        name: name of the robot.
        shapes: `boxes` to replace collision meshes by boxes, or `meshes` to keep collision and
            visual meshes by their absolute paths; such a URDF works on this machine only.
        postures: joint values by joint, prefix included [rad or m], by name of the posture.
        may_touch: further pairs of links, prefixes included, exempt from self-collision.

    Returns:
        The robot.

    Raises:
        InvalidInput: names that occur twice, an unknown arm, joint or link, a value outside a
            joint's limits, a joint that mimics another, or a mesh that cannot be read.
    """
    if not isinstance(bus, Bus):
        raise InvalidInput("bus", bus, "a Bus")
    if not isinstance(name, str) or not name or not name.isprintable():
        raise InvalidInput("name", name, "a name")
    one_of("shapes", shapes, SHAPES)
    if not isinstance(arms, Sequence) or isinstance(arms, str):
        raise InvalidInput("arms", arms, "a sequence of Mounts")
    for mount in arms:
        if not isinstance(mount, Mount):
            allowed = "Mounts, such as Mount('ur5', position=(0, 0, 0.5), prefix='left_')"
            raise InvalidInput("arms", mount, allowed)
    if not isinstance(may_touch, Sequence) or isinstance(may_touch, (str, bytes)):
        raise InvalidInput("may_touch", may_touch, "pairs of link names")
    loaded = [
        load_arm(m.arm, m.locked, m.srdf, m.package_dirs, collision=m.collision, inertia=m.inertia)
        for m in arms
    ]
    both = list(zip(loaded, arms, strict=True))
    robot = put_together(bus, both, name, shapes, {} if postures is None else postures, may_touch)
    warn_of_shapeless_links(robot)
    return robot


def put_together(
    bus: Bus,
    arms: Sequence[tuple[Arm, Mount]],
    name: str,
    shapes: str,
    postures: Mapping[str, Mapping[str, float]],
    may_touch: Sequence[tuple[str, str]],
) -> SpaceRobot:
    """Compose a satellite from arms that have been read; see `compose`.

    Args:
        bus: the bus.
        arms: the arms and their mounts.
        name: name of the robot.
        shapes: `boxes` or `meshes`.
        postures: joint values by joint, by name of the posture [rad or m].
        may_touch: further pairs of links exempt from self-collision.

    Returns:
        The robot.
    """
    robot = ElementTree.Element("robot", name=name)
    robot.extend(bus_elements(bus))
    pairs = []
    for arm, mount in arms:
        root = mount.prefix + arm.root
        joint = fixed_joint(f"bus_to_{root}", root, mount.position, mount.attitude)
        own = [part for part in arm.robot if part.tag in ("link", "joint")]
        parts = [joint, *(_renamed(part, arm, mount.prefix, shapes) for part in own)]
        _check_names(robot, parts, arm, mount.prefix)
        robot.append(comment(f"arm {Path(arm.where.removeprefix('arm ')).name}"))
        robot.extend(parts)
        pairs += [(mount.prefix + one, mount.prefix + two) for one, two in arm.may_touch]
    ElementTree.indent(robot)
    urdf = ElementTree.tostring(robot, encoding="unicode") + "\n"
    srdf = _srdf(name, postures, [*pairs, *may_touch])
    return robot_from_urdf(urdf, name, srdf=srdf, collision="ignore")  # the arms are checked


def _check_names(
    robot: ElementTree.Element, parts: list[ElementTree.Element], arm: Arm, prefix: str
) -> None:
    """Check that the names of an arm's links and joints are not yet used."""
    for tag in ("link", "joint"):
        taken = {element.get("name") for element in robot.findall(tag)}
        twice = [
            part.get("name") for part in parts if part.tag == tag and part.get("name") in taken
        ]
        if twice:
            about = f"{arm.where}, prefix '{prefix}', {tag}s"
            allowed = f"{tag} names that occur once; give the arm another prefix"
            raise InvalidInput(about, ", ".join(map(str, twice)), allowed)


def _renamed(part: ElementTree.Element, arm: Arm, prefix: str, shapes: str) -> ElementTree.Element:
    """A copy of a link or joint with prefixed names, reduced to what a robot needs."""
    copy = ElementTree.Element(part.tag, name=prefix + str(part.get("name")))
    if part.tag == "joint":
        copy.set("type", str(part.get("type")))
        for end in ("parent", "child"):
            link = part.find(end).get("link")  # type: ignore[union-attr]
            ElementTree.SubElement(copy, end, link=f"{prefix}{link}")
        fixed = part.get("type") == "fixed"
        copy.extend(part.findall("origin"))
        copy.extend([] if fixed else [*part.findall("axis"), *part.findall("limit")])
        return copy
    # links without mass get an explicit zero: engines invent a mass for shapes without inertial
    massless = ElementTree.fromstring(_NO_INERTIA)
    copy.append(massless if (inertial := part.find("inertial")) is None else inertial)
    if shapes == "meshes":
        for tag in ("visual", "collision"):
            copy.extend(_with_addresses(shape, arm) for shape in part.findall(tag))
        return copy
    if part.find("collision") is None:  # a link that is not checked remains to be seen
        copy.extend(_self_contained(part, "visual", arm))
    copy.extend(_self_contained(part, "collision", arm))
    return copy


def _self_contained(link: ElementTree.Element, tag: str, arm: Arm) -> list[ElementTree.Element]:
    """Copies of a link's shapes, boxes in place of the meshes."""
    copies: list[ElementTree.Element] = []
    for shape in link.findall(tag):
        mesh = shape.find("geometry/mesh")
        if mesh is None:
            copies.append(_bare(shape))
        else:
            copies.extend(_boxes(shape, mesh, arm, str(link.get("name"))))
    return copies


def _bare(shape: ElementTree.Element) -> ElementTree.Element:
    """A copy of a `<collision>` or `<visual>` with its origin and geometry only."""
    copy = ElementTree.Element(shape.tag)
    copy.extend([*shape.findall("origin"), *shape.findall("geometry")])
    return copy


def _with_addresses(shape: ElementTree.Element, arm: Arm) -> ElementTree.Element:
    """A copy of a shape, its mesh addressed by an absolute path if the file exists."""
    copy = _bare(shape)
    copy.extend(shape.findall("material"))
    for mesh in copy.findall("geometry/mesh"):
        path = find(mesh.get("filename", ""), arm.folders)
        if path is not None:
            mesh.set("filename", str(path))
    return copy


def _boxes(
    shape: ElementTree.Element, mesh: ElementTree.Element, arm: Arm, link: str
) -> list[ElementTree.Element]:
    """Boxes that replace a mesh, after a comment that names the mesh."""
    where, address = f"{arm.where}, link '{link}', {shape.tag} mesh", str(mesh.get("filename"))
    scale = attribute_numbers(mesh, "scale", "1 1 1")
    triangles = surface(address, arm.folders, where) * scale
    boxes = boxes_around(triangles)
    corners, _ = hull(triangles.reshape(-1, 3), where, address)
    ends = np.array([[box.low, box.high] for box in boxes])
    points = [list(product(*pair.T)) for pair in ends]
    excess = max(0.0, float(beyond(corners, np.concatenate(points)).max()))
    frame, rpy = origin(shape), "0 0 0"
    if (element := shape.find("origin")) is not None:
        rpy = element.get("rpy", rpy)
    count = "a box" if len(boxes) == 1 else f"{len(boxes)} boxes"
    about = f"{count} around {Path(address).name}, at most {1e3 * excess:.1f} mm beyond its hull"
    elements = [comment(about)]
    for low, high in ends:
        center = frame.act(0.5 * (low + high)).round(12)
        elements.append(box_shape(shape.tag, (high - low).round(7), center, rpy))
    return elements


def _srdf(
    name: str, postures: Mapping[str, Mapping[str, float]], may_touch: Sequence[tuple[str, str]]
) -> str:
    """Postures and exempt pairs as an SRDF; empty if there are none."""
    if not isinstance(postures, Mapping):
        raise InvalidInput("postures", postures, "joint values by joint, by name of the posture")
    root = ElementTree.Element("robot", name=name)
    if postures:
        ElementTree.SubElement(root, "group", name="arms")
    for posture, joints in postures.items():
        if not isinstance(posture, str) or not isinstance(joints, Mapping):
            raise InvalidInput("postures", {posture: joints}, "joint values by joint, by name")
        state = ElementTree.SubElement(root, "group_state", name=posture, group="arms")
        for joint, value in joints.items():
            checked = number(f"postures['{posture}'], '{joint}'", value)
            ElementTree.SubElement(state, "joint", name=str(joint), value=attribute_text(checked))
    for pair in may_touch:
        if (
            not isinstance(pair, Sequence)
            or len(pair) != 2
            or not all(isinstance(link, str) for link in pair)
        ):
            raise InvalidInput("may_touch", pair, "pairs of link names")
        ElementTree.SubElement(root, "disable_collisions", link1=pair[0], link2=pair[1])
    if not len(root):
        return ""
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"

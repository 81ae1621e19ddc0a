"""Independent reader of a robot's URDF, for verification.

It shares no code with the planner: yourdfpy parses, and the kinematics here and the distances in
`solids` and `separation` are plain numpy over many configurations at once. Collision shapes are
read here, because yourdfpy rejects capsules.

If a cylinder or mesh is replaced by another solid, distances are to that solid, as in the plan.
`Bodies.uncovered` checks that it contains the original, so that clearances of the replacement are
lower bounds for the original.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.verification.solids import Shape, ball, box, capsule, covers_cylinder, covers_points

if TYPE_CHECKING:
    from ffsr_plan.robots.collision_shapes import Replacement


class Joint(NamedTuple):
    """A joint of a URDF.

    Attributes:
        name: its name.
        parent: name of the link nearer to the root.
        child: name of the other link.
        origin: (4, 4) pose of the joint in the parent's frame.
        axis: (3,) unit vector in the joint's frame; zero for a fixed joint.
        moves: whether it is not fixed.
        slides: whether it is prismatic.
    """

    name: str
    parent: str
    child: str
    origin: Array
    axis: Array
    moves: bool
    slides: bool


class Bodies:
    """Links, joints, masses and shapes of a URDF.

    Attributes:
        root: name of the root link.
        inertials: mass, centre of mass and inertia of each link that has a mass, by name.
        shapes: the collision shapes, in the order of the URDF.
        unchecked: links with a mass or a visual shape, but no collision shape.
    """

    def __init__(self, urdf: str, srdf: str = "", replacements: Sequence[Replacement] = ()) -> None:
        """Read a robot.

        Args:
            urdf: text of the URDF.
            srdf: text of the SRDF, empty for none.
            replacements: the solids that replace cylinders and meshes.

        Raises:
            InvalidInput: a cylinder or mesh has no replacement.
        """
        import yourdfpy

        root = ElementTree.fromstring(urdf)
        self._collisions = [
            (str(link.get("name")), number, collision)
            for link in root.findall("link")
            for number, collision in enumerate(link.findall("collision"))
        ]
        seen = {str(link.get("name")) for link in root.findall("link") if link.findall("visual")}
        for link in root.findall("link"):
            for shape in [*link.findall("collision"), *link.findall("visual")]:
                link.remove(shape)
        robot = yourdfpy.URDF.load(
            io.BytesIO(ElementTree.tostring(root)), build_scene_graph=False, load_meshes=False
        ).robot
        self._exempt = {
            frozenset((pair.get("link1"), pair.get("link2")))
            for pair in ElementTree.fromstring(srdf or "<robot/>").iter("disable_collisions")
        }
        self._children: dict[str, list[Any]] = {link.name: [] for link in robot.links}
        for joint in robot.joints:
            self._children[joint.parent].append(joint)
        heads = {joint.child for joint in robot.joints}
        self.root = next(link.name for link in robot.links if link.name not in heads)
        shaped = {name for name, _, _ in self._collisions}
        self.unchecked = tuple(
            link.name
            for link in robot.links
            if link.name not in shaped
            and (link.name in seen or (link.inertial and link.inertial.mass > 0.0))
        )
        self.inertials = {link.name: link.inertial for link in robot.links if link.inertial}
        replaced = {(r.link, r.number): r for r in replacements}
        self.shapes = [
            _shape(link, collision, replaced.get((link, number)))
            for link, number, collision in self._collisions
        ]

    def uncovered(self, meshes: Mapping[str, Array]) -> list[str]:
        """Links with a cylinder or mesh that is not contained in its replacement.

        Args:
            meshes: (n, 3) corners of the meshes' hulls by address, before the URDF's scale.

        Returns:
            The names of these links.
        """
        links = []
        for shape, (link, _, collision) in zip(self.shapes, self._collisions, strict=True):
            element = collision.find("geometry")[0]  # type: ignore[index]
            if element.tag == "cylinder":
                covered = covers_cylinder(shape, *_floats(element, "radius", "length"))
            elif element.tag == "mesh":
                scale = np.array(element.get("scale", "1 1 1").split(), dtype=np.float64)
                covered = covers_points(shape, meshes[str(element.get("filename"))] * scale)
            else:
                continue
            if not covered:
                links.append(link)
        return links

    def pairs(self) -> list[tuple[Shape, Shape]]:
        """Pairs of shapes that must not touch.

        Shapes of one rigid body are no pair, nor are those of two links with only one moving joint
        and no link with a shape between them, nor those that the SRDF exempts.
        """
        neighbours: dict[str, list[tuple[str, int]]] = {name: [] for name in self._children}
        for parent, joints in self._children.items():
            for joint in joints:
                moves = int(joint.type != "fixed")
                neighbours[parent].append((joint.child, moves))
                neighbours[joint.child].append((parent, moves))
        shaped = {shape.link for shape in self.shapes}
        return [
            (a, b)
            for a, b in combinations(self.shapes, 2)
            if frozenset((a.link, b.link)) not in self._exempt
            and b.link not in _may_touch(a.link, neighbours, shaped)
        ]

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """All joints, each after those between it and the root."""
        found, waiting = [], [self.root]
        while waiting:
            for joint in self._children[waiting.pop()]:
                axis = np.array([1.0, 0.0, 0.0]) if joint.axis is None else np.array(joint.axis)
                found.append(
                    Joint(
                        joint.name,
                        joint.parent,
                        joint.child,
                        np.eye(4) if joint.origin is None else np.asarray(joint.origin),
                        axis / np.linalg.norm(axis) if joint.type != "fixed" else np.zeros(3),
                        joint.type != "fixed",
                        joint.type == "prismatic",
                    )
                )
                waiting.append(joint.child)
        return tuple(found)

    def link_poses(self, base: Array, joints: Mapping[str, Array]) -> dict[str, Array]:
        """(N, 4, 4) pose of every link in the world.

        Args:
            base: (N, 4, 4) pose of the root link.
            joints: (N,) values of each moving joint by name [rad or m].

        Returns:
            (N, 4, 4) for each link by name.
        """
        poses = {self.root: base}
        for joint in self.joints:
            pose = poses[joint.parent] @ joint.origin
            if joint.moves:
                pose = pose @ _displacement(joint, joints[joint.name])
            poses[joint.child] = pose
        return poses


def pose(position: Array, quat_xyzw: Array) -> Array:
    """Homogeneous transforms of positions and attitudes.

    Args:
        position: (N, 3) [m].
        quat_xyzw: (N, 4) unit quaternions (xyzw).

    Returns:
        (N, 4, 4) transforms; the columns of their rotations are the rotated unit vectors.
    """
    vector, scalar = quat_xyzw[:, :3], quat_xyzw[:, 3]
    result = np.zeros((len(position), 4, 4))
    for k, unit in enumerate(np.eye(3)):
        turned = np.cross(vector, unit)
        result[:, :3, k] = unit + 2.0 * (scalar[:, None] * turned + np.cross(vector, turned))
    result[:, :3, 3] = position
    result[:, 3, 3] = 1.0
    return result


def _displacement(joint: Joint, value: Array) -> Array:
    """(N, 4, 4) displacement by a joint's values (N,) [rad or m]."""
    result = np.broadcast_to(np.eye(4), (len(value), 4, 4)).copy()
    if joint.slides:
        result[:, :3, 3] = value[:, None] * joint.axis
        return result
    x, y, z = joint.axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
    result[:, :3, :3] = np.eye(3) + sine * skew + (1.0 - cosine) * (skew @ skew)  # Rodrigues
    return result


def _shape(link: str, collision: ElementTree.Element, replacement: Replacement | None) -> Shape:
    placement = _placement(collision.find("origin"))
    element = collision.find("geometry")[0]  # type: ignore[index]
    if element.tag == "box":
        size = np.array(str(element.get("size")).split(), dtype=np.float64)
        return box(link, placement, 0.5 * size)
    if element.tag == "sphere":
        return ball(link, placement, *_floats(element, "radius"))
    if element.tag == "capsule":
        return capsule(link, placement, *_floats(element, "radius", "length"))
    if replacement is None:
        raise InvalidInput(f"{element.tag} of link '{link}'", None, "a solid that replaces it")
    points = (np.array(replacement.points) - placement[:3, 3]) @ placement[:3, :3]
    return Shape(link, placement, points, replacement.radius)


def _floats(element: ElementTree.Element, *keys: str) -> list[float]:
    return [float(str(element.get(key))) for key in keys]


def _placement(origin: ElementTree.Element | None) -> Array:
    """(4, 4) of an `<origin>`: rotations about the fixed x, y and z axes, then the translation."""
    result = np.eye(4)
    if origin is None:
        return result
    for axis, angle in enumerate(origin.get("rpy", "0 0 0").split()):
        cosine, sine = np.cos(float(angle)), np.sin(float(angle))
        rotation, (i, j) = np.eye(4), ((1, 2), (2, 0), (0, 1))[axis]
        rotation[i, i] = rotation[j, j] = cosine
        rotation[j, i], rotation[i, j] = sine, -sine
        result = rotation @ result
    result[:3, 3] = np.array(origin.get("xyz", "0 0 0").split(), dtype=np.float64)
    return result


def _may_touch(
    link: str, neighbours: dict[str, list[tuple[str, int]]], shaped: set[str]
) -> set[str]:
    """Links that may touch `link`, itself included.

    They are connected to it by joints of which at most one moves, without passing a link with a
    shape unless all joints are fixed.
    """
    links: set[str] = set()
    waiting, seen = [(link, 0, False)], set()
    while waiting:
        current, moved, passed = state = waiting.pop()
        if state in seen:
            continue
        seen.add(state)
        links.add(current)
        passed |= current in shaped and current != link
        for other, moves in neighbours[current]:
            if moved + moves <= (0 if passed else 1):
                waiting.append((other, moved + moves, passed))
    return links

"""What Pinocchio and the reader of shapes hold, compared with the URDF link by link.

Masses, tensors, placements, axes, limits and shapes are worked out here once more from the
canonical URDF. A difference would be a wrong answer in silence, so it is an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InternalError
from ffsr_plan.robots.collision_shapes import Replacement
from ffsr_plan.robots.urdf.inertias import moments
from ffsr_plan.robots.urdf.joints import position_limits
from ffsr_plan.robots.urdf.number_texts import attribute_numbers
from ffsr_plan.robots.urdf.origins import transform

_TOLERANCE = 1e-9  # of rounding, relative to the size of the robot and of the value


class Placed(NamedTuple):
    """A link of the URDF and where it is.

    Attributes:
        link: the `<link>` element.
        joint: name of the moving joint that carries it; empty for the base.
        rotation: (3, 3) link axes to axes of that joint.
        position: (3,) link's origin in the frame of that joint [m].
    """

    link: ElementTree.Element
    joint: str
    rotation: Array
    position: Array


def placed_links(robot: ElementTree.Element) -> dict[str, Placed]:
    """All links of a canonical robot by name, each with its placement."""
    links = {str(link.get("name")): link for link in robot.findall("link")}
    below: dict[str, list[ElementTree.Element]] = {name: [] for name in links}
    for joint in robot.findall("joint"):
        below[end(joint, "parent")].append(joint)
    heads = {end(joint, "child") for joint in robot.findall("joint")}
    root = next(name for name in links if name not in heads)
    placed = {root: Placed(links[root], "", np.eye(3), np.zeros(3))}
    waiting = [root]
    while waiting:
        parent = waiting.pop()
        for joint in below[parent]:
            child = end(joint, "child")
            if joint.get("type") == "fixed":
                on = placed[parent]
                rotation, position = transform(joint)
                position = on.rotation @ position + on.position
                placed[child] = Placed(links[child], on.joint, on.rotation @ rotation, position)
            else:
                name = str(joint.get("name"))
                placed[child] = Placed(links[child], name, np.eye(3), np.zeros(3))
            waiting.append(child)
    return placed


def end(joint: ElementTree.Element, key: str) -> str:
    """Name of the parent or child link of a canonical joint."""
    element = joint.find(key)
    return "" if element is None else str(element.get("link"))


def compare(
    robot: ElementTree.Element,
    model: pin.Model,
    collision: pin.GeometryModel,
    replacements: Sequence[Replacement],
) -> None:
    """Compare the models with the URDF that they were made from.

    Args:
        robot: the canonical `<robot>` element.
        model: the kinematic model.
        collision: the collision shapes.
        replacements: the solids that replace some of them.

    Raises:
        InternalError: the first difference, with link or joint and both values.
    """
    placed = placed_links(robot)
    _compare_links(placed, model)
    _compare_inertias(placed, model)
    _compare_joints(robot, placed, model)
    _compare_shapes(placed, collision, replacements)


def _compare_links(placed: dict[str, Placed], model: pin.Model) -> None:
    frames = {f.name: f for f in model.frames if f.type == pin.FrameType.BODY}
    if sorted(frames) != sorted(placed):
        missing = sorted(placed.keys() ^ frames.keys())
        raise InternalError(f"links {missing} are in the URDF or in Pinocchio's model only")
    for name, own in placed.items():
        frame = frames[name]
        carrier = own.joint or "root_joint"
        if model.names[frame.parentJoint] != carrier:
            raise InternalError(f"link '{name}' hangs on {model.names[frame.parentJoint]}")
        _same(f"link '{name}', rotation", frame.placement.rotation, own.rotation, 1.0)
        _same(f"link '{name}', position", frame.placement.translation, own.position, 1.0)


def _compare_inertias(placed: dict[str, Placed], model: pin.Model) -> None:
    """Compare mass, centre and tensor of each moving body, the sum of the links fixed together."""
    bodies: dict[str, list[Placed]] = {}
    for own in placed.values():
        bodies.setdefault(own.joint, []).append(own)
    for joint, links in bodies.items():
        held = model.inertias[model.getJointId(joint) if joint else 1]
        mass, center, tensor = combined(links)
        about = f"bodies at joint '{joint or 'root_joint'}'"
        _same(f"{about}, mass", held.mass, mass)
        if mass > 0.0:
            _same(f"{about}, centre of mass", held.lever, center, 1.0)
            size = float(np.linalg.norm(center)) + 1e-3
            _same(f"{about}, tensor", held.inertia, tensor, np.abs(tensor).max() + mass * size**2)


def combined(links: Sequence[Placed]) -> tuple[float, Array, Array]:
    """Mass, centre of mass and tensor about it of links fixed together, in their joint's frame."""
    parts = list(_bodies(links))
    mass = sum(part[0] for part in parts)
    center = sum((m * c for m, c, _ in parts), np.zeros(3)) / (mass or 1.0)
    tensor = np.zeros((3, 3))
    for m, c, own in parts:
        arm = c - center
        tensor += own + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, center, tensor


def _bodies(links: Sequence[Placed]) -> Iterator[tuple[float, Array, Array]]:
    for link, _, rotation, position in links:
        inertial = link.find("inertial")
        mass = None if inertial is None else inertial.find("mass")
        if inertial is None or mass is None:
            continue
        turn, shift = transform(inertial)
        xx, xy, xz, yy, yz, zz = moments(inertial.find("inertia"))
        own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        axes = rotation @ turn
        yield float(str(mass.get("value"))), rotation @ shift + position, axes @ own @ axes.T


def _compare_joints(
    robot: ElementTree.Element, placed: dict[str, Placed], model: pin.Model
) -> None:
    """Compare placement, axis and limits of each moving joint."""
    moving = {str(j.get("name")): j for j in robot.findall("joint") if j.get("type") != "fixed"}
    if sorted(moving) != sorted(model.names[2:]):
        raise InternalError(
            f"joints {list(model.names[2:])} in Pinocchio, {list(moving)} in the URDF"
        )
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    for name, joint in moving.items():
        number, about = model.getJointId(name), f"joint '{name}'"
        on = placed[end(joint, "parent")]
        if model.names[model.parents[number]] != (on.joint or "root_joint"):
            raise InternalError(f"{about} hangs on {model.names[model.parents[number]]}")
        rotation, position = transform(joint)
        held = model.jointPlacements[number]
        _same(f"{about}, rotation", held.rotation, on.rotation @ rotation, 1.0)
        _same(f"{about}, position", held.translation, on.rotation @ position + on.position, 1.0)
        index = model.joints[number].idx_v
        column = pin.getJointJacobian(model, data, number, pin.LOCAL)[:, index]
        axis = attribute_numbers(joint.find("axis"), "xyz")  # type: ignore[arg-type]
        slides = joint.get("type") == "prismatic"
        parts = (axis, np.zeros(3)) if slides else (np.zeros(3), axis)
        _same(f"{about}, axis", column, np.concatenate(parts), 1.0)
        _compare_limits(about, joint, model, number)


def _compare_limits(about: str, joint: ElementTree.Element, model: pin.Model, number: int) -> None:
    index, place = model.joints[number].idx_v, model.joints[number].idx_q
    limit = joint.find("limit")
    given = {} if limit is None else limit.attrib
    if joint.get("type") != "continuous":
        held = model.lowerPositionLimit[place], model.upperPositionLimit[place]
        _same(f"{about}, limits", held, position_limits(joint))
    for key, held in (
        ("velocity", model.upperVelocityLimit[index]), ("effort", model.upperEffortLimit[index])
    ):  # fmt: skip
        if key in given:
            _same(f"{about}, {key} limit", held, float(given[key]))


def _compare_shapes(
    placed: dict[str, Placed], collision: pin.GeometryModel, replacements: Sequence[Replacement]
) -> None:
    replaced = {(r.link, r.number): r for r in replacements}
    wanted = {
        f"{name}_{k}": (own, shape, replaced.get((name, k)))
        for name, own in placed.items()
        for k, shape in enumerate(own.link.findall("collision"))
    }
    held = {shape.name: shape for shape in collision.geometryObjects}
    if sorted(held) != sorted(wanted) or collision.ngeoms != len(wanted):
        missing = sorted(held.keys() ^ wanted.keys())
        raise InternalError(f"collision shapes {missing} are in the URDF or in the model only")
    for name, (own, element, replacement) in wanted.items():
        shape, about = held[name], f"collision shape '{name}'"
        if replacement is not None:
            points = np.array(replacement.points) @ own.rotation.T + own.position
            _compare_solid_around(about, shape, points, replacement.radius)
            continue
        rotation, position = transform(element)
        _same(f"{about}, rotation", shape.placement.rotation, own.rotation @ rotation, 1.0)
        position = own.rotation @ position + own.position
        _same(f"{about}, position", shape.placement.translation, position, 1.0)
        solid = next(iter(element.iterfind("geometry/*")))
        _same(f"{about}, size", sizes_of(shape.geometry), _sizes_in_text(solid))


def _compare_solid_around(
    about: str, shape: pin.GeometryObject, points: Array, radius: float
) -> None:
    """Compare a solid in place of a cylinder or mesh with the record of it."""
    solid = shape.geometry
    if isinstance(solid, coal.Capsule):
        ends = np.array([[0.0, 0.0, -solid.halfLength], [0.0, 0.0, solid.halfLength]])
        _same(f"{about}, radius", solid.radius, radius)
    else:
        ends = np.array([solid.point(k) for k in range(solid.num_points)])
    corners = ends @ shape.placement.rotation.T + shape.placement.translation
    if len(corners) != len(points):
        raise InternalError(f"{about} has {len(corners)} corners, not {len(points)}")
    _same(f"{about}, corners", corners, points, 1.0)


def sizes_of(solid: coal.CollisionGeometry) -> tuple[float, ...]:
    """Sides of a box, radius of a sphere, radius and length of a capsule [m]."""
    if isinstance(solid, coal.Box):
        return tuple(2.0 * solid.halfSide)
    if isinstance(solid, coal.Sphere):
        return (solid.radius,)
    return solid.radius, 2.0 * solid.halfLength


def _sizes_in_text(solid: ElementTree.Element) -> list[float]:
    keys = {"box": ("size",), "sphere": ("radius",)}.get(solid.tag, ("radius", "length"))
    return [value for key in keys for value in attribute_numbers(solid, key).tolist()]


def _same(what: str, held: ArrayLike, own: ArrayLike, scale: float = 0.0) -> None:
    """Raise `InternalError` where two values differ by more than rounding of `scale` or them."""
    one, other = np.asarray(held, dtype=np.float64), np.asarray(own, dtype=np.float64)
    largest = max(scale, float(np.max(np.abs(other), initial=0.0)))
    if one.shape != other.shape or not np.all(np.abs(one - other) <= _TOLERANCE * largest):
        raise InternalError(
            f"{what}: the model holds {one.tolist()}, the URDF says {other.tolist()}"
        )

"""Whether masses and inertias can be those of the bodies: moving bodies have mass, units fit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.loaded_model_checks import Placed, combined, end, placed_links
from ffsr_plan.robots.urdf.known_elements import SHAPES
from ffsr_plan.robots.urdf.number_texts import attribute_numbers
from ffsr_plan.robots.urdf.origins import LARGEST, transform

LEAST_INERTIA = 1e-9
"""Least principal moment of the base, relative to the robot's mass times its size squared. For a
smaller one the base turns by a radian while the arms move by less than the integration can see."""
LIGHTEST = 1e-6
"""Least mass [kg] of a moving body: Pinocchio loses the centres of mass of lighter ones."""
_MOST_GYRATION = 10.0  # radius of gyration relative to the body's size; 1 for a body in its shape
_LEAST_SIZE = 1.0  # [m] counted for slides, whose steps are in metres


class Body(NamedTuple):
    """Links fixed together.

    Attributes:
        name: name of the first link.
        links: the links.
        mass: of all of them [kg].
        gyration: largest radius of gyration about the centre of mass [m].
        size: largest distance from the centre of mass to a known point: a corner of a shape, an
            origin of a link or of a joint [m].
        whole: whether the extents of all links with an inertia are known.
    """

    name: str
    links: list[Placed]
    mass: float
    gyration: float
    size: float
    whole: bool


def check_bodies(
    robot: ElementTree.Element, where: str, model: pin.Model, collision: pin.GeometryModel
) -> None:
    """Check that moving bodies have mass, the base enough inertia, and inertias fit the sizes.

    Args:
        robot: the canonical `<robot>` element.
        where: file or robot name that starts every message.
        model: the kinematic model.
        collision: the collision shapes.

    Raises:
        InvalidInput: a moving body has no mass, the base has too little inertia, or a radius of
            gyration is far larger than the body and the robot.
    """
    base = model.inertias[1]
    least = float(np.linalg.eigvalsh(base.inertia)[0])
    if base.mass <= 0.0 or least <= 0.0:
        raise InvalidInput(
            f"{where}, root link", f"mass {base.mass:g} kg", "a mass and a full inertia"
        )
    for frame in model.frames:  # a joint's inertia is that of all links fixed to one another
        mass = model.inertias[frame.parentJoint].mass
        if frame.type == pin.FrameType.BODY and mass < LIGHTEST:
            allowed = "a mass of the moving link or of a link fixed to it"
            allowed += f", at least {LIGHTEST:g} kg" if mass > 0.0 else ""
            raise InvalidInput(f"{where}, link '{frame.name}'", f"{mass:g} kg", allowed)
    found = bodies(robot, collision)
    reach = float(sum(body.size for body in found))
    _check_gyration(found, where, reach)
    moved = sum(body.mass for body in found[1:])
    if any(joint.get("type") == "prismatic" for joint in robot.findall("joint")):
        reach = max(reach, _LEAST_SIZE)
    floor = LEAST_INERTIA * moved * reach**2
    if least < floor:
        allowed = (
            f"at least {floor:.3g} kg m^2: {LEAST_INERTIA:g} of the arms' {moved:.3g} kg times "
            f"({reach:.3g} m)^2, or the base turns faster than can be integrated"
        )
        raise InvalidInput(f"{where}, link '{found[0].name}', least moment", least, allowed)


def _check_gyration(found: Sequence[Body], where: str, reach: float) -> None:
    for body in found:
        most = max(_MOST_GYRATION * body.size, reach) if body.whole else LARGEST
        if body.gyration > most:
            allowed = (
                f"at most {most:.3g} m for a body of {body.size:.3g} m; are the "
                "units right, kg m^2 and kg?"
            )
            value = f"radius of gyration {body.gyration:.3g} m"
            raise InvalidInput(f"{where}, link '{body.name}', inertia", value, allowed)


def bodies(robot: ElementTree.Element, collision: pin.GeometryModel) -> list[Body]:
    """Mass, radius of gyration and size of each moving body, the base first.

    Args:
        robot: the canonical `<robot>` element.
        collision: its collision shapes.
    """
    groups: dict[str, list[Placed]] = {}
    placed = placed_links(robot)
    for own in placed.values():
        groups.setdefault(own.joint, []).append(own)
    points: dict[str, list[Array]] = {joint: [np.zeros(3)] for joint in groups}
    for own in placed.values():
        points[own.joint].append(own.position)
        points[own.joint].extend(_visual_corners(own))
    for joint in robot.findall("joint"):
        on = placed[end(joint, "parent")]
        points[on.joint].append(on.rotation @ transform(joint)[1] + on.position)
    for shape in collision.geometryObjects:
        points[placed[shape.name.rpartition("_")[0]].joint].extend(_corners(shape))
    return [_body(links, np.array(points[joint])) for joint, links in groups.items()]


def _body(links: list[Placed], points: Array) -> Body:
    mass, center, tensor = combined(links)
    moment = max(float(np.linalg.eigvalsh(tensor)[2]), 0.0)
    size = float(np.linalg.norm(points - center, axis=1).max())
    unknown = any(
        own.link.find("collision") is None
        and (own.link.find("visual") is None or own.link.find("visual/geometry/mesh") is not None)
        and own.link.find("inertial") is not None
        for own in links
    )
    name = str(links[0].link.get("name"))
    gyration = float(np.sqrt(moment / mass)) if mass > 0.0 else 0.0
    return Body(name, links, mass, gyration, size, not unknown)


def _visual_corners(own: Placed) -> Array:
    """(n, 3) corners of boxes around visual shapes other than meshes, in the joint's frame [m]."""
    found = [np.empty((0, 3))]
    for visual in own.link.findall("visual"):
        solid = next(iter(visual.iterfind("geometry/*")))
        if not SHAPES[solid.tag]:
            continue
        half = 0.5 * np.concatenate([attribute_numbers(solid, key) for key in SHAPES[solid.tag]])
        if solid.tag != "box":
            radius, length = 2.0 * half[0], half[-1] if len(half) > 1 else 0.0
            half = np.array([radius, radius, length + radius])
        rotation, position = transform(visual)
        corners = _box(-half, half) @ rotation.T + position
        found.append(corners @ own.rotation.T + own.position)
    return np.concatenate(found)


def _corners(shape: pin.GeometryObject) -> Array:
    """(8, 3) corners of a box around a collision shape, in the joint's frame [m]."""
    shape.geometry.computeLocalAABB()
    box = shape.geometry.aabb_local
    corners = _box(np.array(box.min_), np.array(box.max_))
    return corners @ shape.placement.rotation.T + shape.placement.translation


def _box(low: Array, high: Array) -> Array:
    """(8, 3) corners of a box."""
    ends = np.array([low, high])
    index = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    return ends[index, np.arange(3)]

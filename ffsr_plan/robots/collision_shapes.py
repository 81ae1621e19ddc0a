"""Collision shapes of a URDF as Coal solids.

Boxes, spheres and capsules are taken as they are. Coal's distances to cylinders are not exact in
penetration, and those to meshes are slow. A cylinder or mesh is therefore replaced by a convex
solid that contains it and has exact distances: what is proven for the container holds for the
original. Pinocchio's own reader is not used, because it drops every shape of a link that has a
`<capsule>`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.hull_reduction import beyond, reduced
from ffsr_plan.meshes.mesh_files import hull, hull_corners
from ffsr_plan.robots.urdf.number_texts import attribute_numbers
from ffsr_plan.robots.urdf.origins import LARGEST

CONTAINERS = ("hull", "capsule")
SIDES = 24
"""Sides of the prism around a cylinder; its corners lie 0.86 % of the radius outside of it."""
SMALLEST = 1e-4
"""Least length of a mesh [m]; smaller meshes are lost in rounding."""
_GRAY = np.array([0.9, 0.9, 0.9, 1.0])


class Replacement(NamedTuple):
    """A collision shape that is replaced by a solid around it.

    The solid consists of all points within `radius` of the convex hull of `points`.

    Attributes:
        link: name of the link.
        number: number of the `<collision>` in the link, from 0.
        shape: the original, such as `cylinder` or `mesh finger.stl`.
        by: the solid, such as `prism of 24 sides`.
        excess: greatest distance from a point of the solid to the convex hull of the original [m].
        points: corners of the hull, or the two ends of the capsule's axis, in the link's frame [m].
        radius: radius of the capsule [m]; 0 for a hull.
    """

    link: str
    number: int
    shape: str
    by: str
    excess: float
    points: tuple[tuple[float, float, float], ...]
    radius: float


class Containers(NamedTuple):
    """Kinds of the solids that replace shapes.

    Attributes:
        meshes: `hull` or `capsule`.
        cylinders: `hull` or `capsule`.
    """

    meshes: str = "hull"
    cylinders: str = "hull"


class _Container(NamedTuple):
    """A solid around a shape.

    Attributes:
        solid: Coal's geometry.
        placement: frame of the solid in the frame of the shape.
        by: the solid in words.
        excess: see `Replacement`.
        points: as of `Replacement`, in the frame of the shape [m].
        radius: as of `Replacement` [m].
    """

    solid: coal.CollisionGeometry
    placement: pin.SE3
    by: str
    excess: float
    points: Array
    radius: float


def collision_geometry(
    model: pin.Model,
    robot: ElementTree.Element,
    where: str,
    folders: Sequence[str],
    containers: Containers,
    meshes: dict[str, Array],
) -> tuple[pin.GeometryModel, tuple[Replacement, ...]]:
    """Collision geometry of a robot.

    Args:
        model: the kinematic model of the same URDF.
        robot: the URDF's root element, checked.
        where: file or robot name that starts every message.
        folders: folders in which `package://` and plain mesh addresses are looked up.
        containers: kinds of the solids that replace meshes and cylinders.
        meshes: (n, 3) hull corners by address, before scaling [m]; missing ones are read and added.

    Returns:
        The shapes in the order of the model's links, and which of them are replaced.

    Raises:
        InvalidInput: a mesh that is missing, cannot be read, is flat, too small or too large.
    """
    geometry = pin.GeometryModel()
    replacements: list[Replacement] = []
    links = {link.get("name"): link for link in robot.findall("link")}
    for index, frame in enumerate(model.frames):
        if frame.type != pin.FrameType.BODY:
            continue
        for k, collision in enumerate(links[frame.name].findall("collision")):
            element = next(iter(collision.iterfind("geometry/*")))
            placement = origin(collision)
            if element.tag in ("cylinder", "mesh"):
                about = f"{where}, link '{frame.name}', collision mesh"
                shape, container = _contained(element, about, folders, containers, meshes)
                replacements.append(_replacement(frame.name, k, shape, container, placement))
                solid, placement = container.solid, placement * container.placement
            else:
                solid = _exact(element)
            solid.computeLocalAABB()
            shape_object = pin.GeometryObject(
                f"{frame.name}_{k}", frame.parentJoint, index, frame.placement * placement, solid
            )
            shape_object.meshColor = _GRAY
            geometry.addGeometryObject(shape_object)
    return geometry, tuple(replacements)


def origin(element: ElementTree.Element) -> pin.SE3:
    """Placement of a checked `<collision>`, `<visual>` or `<joint>` element by its `<origin>`."""
    child = element.find("origin")
    if child is None:
        return pin.SE3.Identity()
    roll, pitch, yaw = attribute_numbers(child, "rpy", "0 0 0")
    return pin.SE3(pin.rpy.rpyToMatrix(roll, pitch, yaw), attribute_numbers(child, "xyz", "0 0 0"))


def convex(points: Array, triangles: Array) -> coal.Convex:
    """Convex solid of Coal.

    Args:
        points: (n, 3) corners [m].
        triangles: (k, 3) indices of corners, counterclockwise from outside.
    """
    corners, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in points:
        corners.append(point)
    for a, b, c in triangles.tolist():
        faces.append(coal.Triangle(a, b, c))
    return coal.Convex(corners, faces)


def sharpen(request: coal.DistanceRequest) -> None:
    """Make Coal's distances to hulls exact to 1e-8 m, in place.

    With Coal's defaults they are up to a millionth of the distance too large where a hull is finely
    curved. Tolerances below 1e-9 are no better: at slivers of rounded meshes, Coal then reports
    some penetrations as contact (distance 0); at 1e-9 it does so for one in 70 000 centres that lie
    a nanometre from the surface. Distances to boxes, spheres and capsules are exact in any case.

    Args:
        request: the request to change.
    """
    request.gjk_tolerance = request.epa_tolerance = 1e-9
    request.gjk_max_iterations = request.epa_max_iterations = 1000


def _contained(
    element: ElementTree.Element,
    about: str,
    folders: Sequence[str],
    containers: Containers,
    meshes: dict[str, Array],
) -> tuple[str, _Container]:
    """A cylinder or mesh in words, and the solid around it."""
    if element.tag == "cylinder":
        return "cylinder", _around_cylinder(element, containers.cylinders)
    address = str(element.get("filename"))
    if address not in meshes:
        meshes[address] = hull_corners(address, folders, about)
    corners = meshes[address] * attribute_numbers(element, "scale", "1 1 1")
    _check_size(corners, about, address)
    return f"mesh {address}", _around_points(corners, containers.meshes, about, address)


def _replacement(
    link: str, number: int, shape: str, container: _Container, placement: pin.SE3
) -> Replacement:
    """The record of a container whose shape has a placement in the link's frame."""
    points = container.points @ placement.rotation.T + placement.translation
    plain = tuple((x, y, z) for x, y, z in points.tolist())
    by, excess, radius = container.by, container.excess, container.radius
    return Replacement(link, number, shape, by, excess, plain, radius)


def _exact(element: ElementTree.Element) -> coal.CollisionGeometry:
    if element.tag == "box":
        return coal.Box(attribute_numbers(element, "size"))
    radius = float(element.get("radius", ""))
    if element.tag == "sphere":
        return coal.Sphere(radius)
    return coal.Capsule(radius, float(element.get("length", "")))


def _around_cylinder(element: ElementTree.Element, kind: str) -> _Container:
    radius, length = float(element.get("radius", "")), float(element.get("length", ""))
    if kind == "hull":
        # with flat sides towards x and y the box around the prism is as narrow as the cylinder
        angles = 2.0 * np.pi / SIDES * (np.arange(SIDES) + 0.5)
        outer = radius / np.cos(np.pi / SIDES)
        ring = np.column_stack([outer * np.cos(angles), outer * np.sin(angles)])
        points = np.vstack([np.insert(ring, 2, z, axis=1) for z in (-0.5 * length, 0.5 * length)])
        corners, triangles = hull(points, "", "cylinder")
        solid = convex(corners, triangles)
        by = f"prism of {SIDES} sides"
        return _Container(solid, pin.SE3.Identity(), by, float(outer - radius), corners, 0.0)
    # with ends g inside the cylinder's ends, the excess is sqrt(r^2 + g^2) - r radially and
    # sqrt(r^2 + g^2) - g axially; their maximum is least at g = r
    inset = min(radius, 0.5 * length)
    outer = float(np.hypot(radius, inset))
    half = 0.5 * length - inset
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    solid = coal.Capsule(outer, 2.0 * half)
    return _Container(solid, pin.SE3.Identity(), "capsule", outer - inset, ends, outer)


def _check_size(corners: Array, where: str, address: str) -> None:
    """Check that a scaled mesh is neither too small nor too large for exact distances."""
    farthest, extent = float(np.abs(corners).max()), float(np.ptp(corners, axis=0).max())
    if not farthest <= LARGEST:
        allowed = f"coordinates of at most {LARGEST:g} m, scale included"
        raise InvalidInput(where, f"{address} with {farthest:g} m", allowed)
    if extent < SMALLEST:
        allowed = f"a mesh of at least {SMALLEST:g} m across, scale included"
        raise InvalidInput(where, f"{address} of {extent:g} m", allowed)


def _around_points(points: Array, kind: str, where: str, address: str) -> _Container:
    """The convex hull of the points, or a capsule along the longest side of their oriented box.

    A hull of many corners is replaced by a simpler solid around it.
    """
    from trimesh.bounds import oriented_bounds

    corners, _ = hull(points, where, address)
    around = reduced(corners)
    simple, triangles = hull(around, where, address)
    try:
        to_box, _ = oriented_bounds(simple)  # type: ignore[no-untyped-call]
    except (TypeError, ValueError):  # raised if all faces are slivers
        raise InvalidInput(where, address, "a mesh that is not flat") from None
    if kind == "capsule":
        return _capsule_around(corners, to_box)
    local, rotation, center = _in_box(simple, to_box)
    by = f"convex hull of {len(corners)} vertices"
    if around is not corners:
        by = f"solid of {len(simple)} vertices around the {by}"
    excess = 0.0 if around is corners else max(0.0, float(beyond(corners, simple).max()))
    placement = pin.SE3(rotation, rotation @ center)
    return _Container(convex(local, triangles), placement, by, excess, simple, 0.0)


def _in_box(corners: Array, to_box: Array) -> tuple[Array, Array, Array]:
    """Corners relative to the centre of their box, the box's axes as columns, and its centre.

    Corners and centre are in the axes of the box.
    """
    local = corners @ to_box[:3, :3].T
    center = 0.5 * (local.min(axis=0) + local.max(axis=0))
    local -= center  # after rounding too, so that half sides bound the hull on both sides
    return local, to_box[:3, :3].T, center


def _capsule_around(corners: Array, to_box: Array) -> _Container:
    """A capsule around all corners, along the longest side of their box."""
    local, rotation, center = _in_box(corners, to_box)
    longest = int(np.argmax(np.ptp(local, axis=0)))
    along, across = local[:, longest], np.delete(local, longest, axis=1)
    off_axis = np.linalg.norm(across, axis=1)
    radius = float(off_axis.max()) * (1.0 + 1e-12)  # rounding must not leave a corner outside
    inside = np.sqrt(radius**2 - off_axis**2)
    low, high = float((along + inside).min()), float((along - inside).max())
    if low > high:  # a single ball contains all corners, its centre anywhere between the two
        low = high = 0.5 * (low + high)
    axis = rotation[:, longest]
    ends = rotation @ center + np.outer([low, high], axis)
    # the other two columns of `rotation`, in cyclic order: a capsule's own axis is z
    columns = rotation[:, [(longest + 1) % 3, (longest + 2) % 3, longest]]
    placement = pin.SE3(columns, 0.5 * (ends[0] + ends[1]))
    # the distance from a convex solid is a convex function, so it is greatest at an end
    excess = radius + float(beyond(corners, ends).max())
    solid = coal.Capsule(radius, high - low)
    return _Container(solid, placement, "capsule", excess, frozen(ends), radius)

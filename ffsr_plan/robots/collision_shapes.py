"""Collision shapes of a URDF as Coal solids: as they stand, or inside a convex solid, on record.

Boxes, spheres and capsules stay what they are. Coal's distances to cylinders are not exact in
penetration, and those to meshes slow; a cylinder or mesh is therefore put inside a solid with exact
distances that contains it: what is proven of the container holds for what is inside. Pinocchio's
own reading is not used, because it drops every shape of a link that has a `<capsule>`.
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
from ffsr_plan.robots.urdf_validation import LARGEST

CONTAINERS = ("hull", "capsule")
SIDES = 24
"""Of the prism around a cylinder: its corners lie 0.86 % of the radius outside the cylinder."""
SMALLEST = 1e-4
"""Least length of a mesh [m]; boxes around smaller ones drown in rounding."""
_GRAY = np.array([0.9, 0.9, 0.9, 1.0])


class Replacement(NamedTuple):
    """A collision shape that was put inside another one: all points within `radius` of a hull."""

    link: str
    number: int
    """Which `<collision>` of the link, from 0."""
    shape: str
    """What the URDF says, e.g. `cylinder` or `mesh finger.stl`."""
    by: str
    excess: float
    """[m], farthest that the replacement reaches beyond the convex hull of the original."""
    points: tuple[tuple[float, float, float], ...]
    """Corners of the hull, or the two ends of the capsule's axis, in the link's frame [m]."""
    radius: float
    """Of the capsule [m]; 0 for a hull."""


class Containers(NamedTuple):
    """Which solids stand for the shapes that are not taken as they are: `hull` or `capsule`."""

    meshes: str = "hull"
    cylinders: str = "hull"


class _Container(NamedTuple):
    """A solid, and the same as points and a radius in the frame of the shape that it contains."""

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
    """Shapes in the order of the model's links, and which of them were replaced.

    Args:
        model: the model of the same URDF.
        robot: the URDF's root element, checked.
        where: file or robot name that starts every message.
        folders: where `package://` and plain mesh addresses are looked up.
        containers: what to put meshes and cylinders in.
        meshes: (n, 3) hull corners by address, before scaling; missing ones are read and added.

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
            about = f"{where}, link '{frame.name}', collision mesh"
            placement = origin(collision)
            if element.tag in ("cylinder", "mesh"):
                if element.tag == "cylinder":
                    box = _around_cylinder(element, containers.cylinders)
                    shape = "cylinder"
                else:
                    address = str(element.get("filename"))
                    if address not in meshes:
                        meshes[address] = hull_corners(address, folders, about)
                    corners = meshes[address] * _numbers(element, "scale", "1 1 1")
                    _check_size(corners, about, address)
                    box = _around_points(corners, containers.meshes, about, address)
                    shape = f"mesh {address}"
                points = box.points @ placement.rotation.T + placement.translation
                plain = tuple((x, y, z) for x, y, z in points.tolist())
                replacements.append(
                    Replacement(frame.name, k, shape, box.by, box.excess, plain, box.radius)
                )
                solid, placement = box.solid, placement * box.placement
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
    """The `<origin>` of a checked element."""
    found = element.find("origin")
    if found is None:
        return pin.SE3.Identity()
    roll, pitch, yaw = _numbers(found, "rpy", "0 0 0")
    return pin.SE3(pin.rpy.rpyToMatrix(roll, pitch, yaw), _numbers(found, "xyz", "0 0 0"))


def convex(points: Array, triangles: Array) -> coal.Convex:
    """A Coal solid from corners (n, 3) and outward triangles (k, 3)."""
    corners, faces = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in points:
        corners.append(point)
    for a, b, c in triangles.tolist():
        faces.append(coal.Triangle(a, b, c))
    return coal.Convex(corners, faces)


def sharpen(request: coal.DistanceRequest) -> None:
    """Make Coal's distances to hulls exact to 1e-8 m, in place.

    By default they are up to a millionth of the distance too large where a hull is finely curved.
    Tolerances below 1e-9 are no better: where rounded meshes have slivers, Coal then calls some
    penetrations a touch (distance 0), as it does at 1e-9 for one in 70 000 centres that lie a
    nanometre from the surface. Distances to boxes, spheres and capsules are exact anyway.
    """
    request.gjk_tolerance = request.epa_tolerance = 1e-9
    request.gjk_max_iterations = request.epa_max_iterations = 1000


def _numbers(element: ElementTree.Element, key: str, default: str = "") -> Array:
    return np.array([float(word) for word in element.get(key, default).split()])


def _exact(element: ElementTree.Element) -> coal.CollisionGeometry:
    if element.tag == "box":
        return coal.Box(_numbers(element, "size"))
    radius = float(element.get("radius", ""))
    if element.tag == "sphere":
        return coal.Sphere(radius)
    return coal.Capsule(radius, float(element.get("length", "")))


def _around_cylinder(element: ElementTree.Element, kind: str) -> _Container:
    radius, length = float(element.get("radius", "")), float(element.get("length", ""))
    if kind == "hull":
        # flat sides towards x and y keep the box around the prism as narrow as the cylinder
        turn = 2.0 * np.pi / SIDES * (np.arange(SIDES) + 0.5)
        outer = radius / np.cos(np.pi / SIDES)
        ring = np.column_stack([outer * np.cos(turn), outer * np.sin(turn)])
        points = np.vstack([np.insert(ring, 2, z, axis=1) for z in (-0.5 * length, 0.5 * length)])
        corners, triangles = hull(points, "", "cylinder")
        solid = convex(corners, triangles)
        by = f"prism of {SIDES} sides"
        return _Container(solid, pin.SE3.Identity(), by, float(outer - radius), corners, 0.0)
    # ends g inside the cylinder's: sideways excess sqrt(r^2 + g^2) - r, axial sqrt(r^2 + g^2) - g,
    # the larger of the two least at g = r
    inset = min(radius, 0.5 * length)
    outer = float(np.hypot(radius, inset))
    half = 0.5 * length - inset
    ends = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
    solid = coal.Capsule(outer, 2.0 * half)
    return _Container(solid, pin.SE3.Identity(), "capsule", outer - inset, ends, outer)


def _check_size(corners: Array, where: str, address: str) -> None:
    """Raise `InvalidInput` for a scaled mesh of a size that distances to it are not exact for."""
    farthest, across = float(np.abs(corners).max()), float(np.ptp(corners, axis=0).max())
    if not farthest <= LARGEST:
        allowed = f"coordinates of at most {LARGEST:g} m, scale included"
        raise InvalidInput(where, f"{address} with {farthest:g} m", allowed)
    if across < SMALLEST:
        allowed = f"a mesh of at least {SMALLEST:g} m across, scale included"
        raise InvalidInput(where, f"{address} of {across:g} m", allowed)


def _around_points(points: Array, kind: str, where: str, address: str) -> _Container:
    """The convex hull, or a capsule along the longest side of the tight box around the points.

    A hull of many corners gives way to a simpler solid around it.
    """
    from trimesh.bounds import oriented_bounds

    corners, _ = hull(points, where, address)
    around = reduced(corners)
    simple, triangles = hull(around, where, address)
    try:
        to_box, _ = oriented_bounds(simple)  # type: ignore[no-untyped-call]
    except (TypeError, ValueError):  # where all faces are slivers, it finds no box
        raise InvalidInput(where, address, "a mesh that is not flat") from None
    if kind == "capsule":
        return _capsule_around(corners, to_box)
    local, turn, middle = _in_box(simple, to_box)
    by = f"convex hull of {len(corners)} vertices"
    if around is not corners:
        by = f"solid of {len(simple)} vertices around the {by}"
    excess = 0.0 if around is corners else max(0.0, float(beyond(corners, simple).max()))
    placement = pin.SE3(turn, turn @ middle)
    return _Container(convex(local, triangles), placement, by, excess, simple, 0.0)


def _in_box(corners: Array, to_box: Array) -> tuple[Array, Array, Array]:
    """Corners about the middle of their box, the box's axes as columns, and its middle there."""
    local = corners @ to_box[:3, :3].T
    middle = 0.5 * (local.min(axis=0) + local.max(axis=0))
    local -= middle  # centred to the last digit: half sides bound the hull on both sides
    return local, to_box[:3, :3].T, middle


def _capsule_around(corners: Array, to_box: Array) -> _Container:
    """A capsule that holds all corners, along the longest side of their box."""
    local, turn, middle = _in_box(corners, to_box)
    longest = int(np.argmax(np.ptp(local, axis=0)))
    along, across = local[:, longest], np.delete(local, longest, axis=1)
    off_axis = np.linalg.norm(across, axis=1)
    radius = float(off_axis.max()) * (1.0 + 1e-12)  # rounding must not leave a corner outside
    inside = np.sqrt(radius**2 - off_axis**2)
    low, high = float((along + inside).min()), float((along - inside).max())
    if low > high:  # one ball would do, anywhere between the two
        low = high = 0.5 * (low + high)
    axis = turn[:, longest]
    ends = turn @ middle + np.outer([low, high], axis)
    upright = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis).matrix()
    placement = pin.SE3(upright, 0.5 * (ends[0] + ends[1]))
    # the distance from a convex solid is a convex function: a capsule is farthest out at an end
    excess = radius + float(beyond(corners, ends).max())
    solid = coal.Capsule(radius, high - low)
    return _Container(solid, placement, "capsule", excess, frozen(ends), radius)

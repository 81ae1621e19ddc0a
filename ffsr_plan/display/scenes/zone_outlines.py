"""Lines and sides of keep-in zones, and the names that pictures give them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from textwrap import fill
from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.display.scenes.shape_outlines import mesh_of, outline_of
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace, Zone, planes_of
from ffsr_plan.scene.shapes.obstacle_shapes import Ball

ZONE = "keep-in zone"
_AHEAD, _ASIDE = 0.1, 0.02  # of the largest extent: planes so far beyond what is shown are drawn,
# and go so far beyond it
_CIRCLE = 96  # segments
_EDGE_ON = 1e-6  # cosine between the picture and the normal of a plane that is seen as a line
_FACE_ON = 0.05  # of the normal's part in the picture: less is a plane parallel to it, not drawn
_DASHES = 48  # along the largest extent
_CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
_CUBE_EDGES = _CUBE[[(a, b) for a in range(8) for b in range(8) if a < b and a ^ b in (1, 2, 4)]]


class ZoneLines(NamedTuple):
    """Lines that show where a zone ends.

    Attributes:
        segments: (k, 2, 3) ends in the world [m].
        outward: (k, 3) directions out of the zone there.
    """

    segments: Array
    outward: Array


class FlatZone(NamedTuple):
    """A zone as it is seen in a picture.

    Attributes:
        inside: (k, 2) corners of the part of the picture in it, counter-clockwise [m].
        border: (m, 2) corners of the line where it ends [m].
        certain: whether all that is seen outside is outside of the zone.
    """

    inside: Array
    border: Array
    certain: bool


def lines_of(zone: Zone, low: Array, high: Array) -> ZoneLines:
    """Edges of a box, three dashed circles of a ball, the edge of a piece of a half-space's plane.

    Args:
        zone: the zone.
        low: (3,) least coordinates of what the picture shows [m].
        high: (3,) greatest ones [m].
    """
    if isinstance(zone, HalfSpace):
        corners = patch(zone, low, high)
        segments = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        return ZoneLines(segments, np.tile(planes_of(zone)[0, :3], (len(segments), 1)))
    turn = rotations.matrix(zone.attitude).T
    if isinstance(zone, Ball):
        angle = np.linspace(0.0, 2.0 * np.pi, _CIRCLE + 1)
        flat = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
        circles = np.stack([np.roll(flat, k, axis=1) for k in range(3)])
        ends = np.stack([circles[:, :-1:2], circles[:, 1::2]], axis=2).reshape(-1, 2, 3)
        return ZoneLines(zone.radius * ends + zone.position, ends.mean(axis=1))
    ends = _CUBE_EDGES * zone.half_sides @ turn + zone.position
    return ZoneLines(ends, _CUBE_EDGES.mean(axis=1) @ turn)


def sides_of(zone: Zone, low: Array, high: Array) -> Array:
    """(k, 3, 3) triangles of where a zone ends, counter-clockwise from outside; see `lines_of`."""
    if not isinstance(zone, HalfSpace):
        return mesh_of(zone).triangles
    corners = patch(zone, low, high)
    fan = [corners[[0, k, k + 1]] for k in range(1, len(corners) - 1)]
    return np.array(fan).reshape(-1, 3, 3)


def patch(zone: HalfSpace, low: Array, high: Array) -> Array:
    """The piece of a half-space's plane in a box that is a little larger than what is shown.

    Args:
        zone: the half-space.
        low: (3,) least coordinates of what the picture shows [m].
        high: (3,) greatest ones [m].

    Returns:
        (k, 3) corners, counter-clockwise from outside [m]; none if the plane lies elsewhere.
    """
    (plane,) = planes_of(zone)
    normal, largest = plane[:3], float(np.max(high - low)) + 1e-6
    beyond = np.full(3, _ASIDE * largest)
    beyond[np.argmax(np.abs(normal))] = _AHEAD * largest
    middle, half = 0.5 * (low + high), 0.5 * (high - low) + beyond
    box = middle + half * _CUBE_EDGES
    depth = box @ normal - plane[3]
    crossing = (depth[:, 0] < 0.0) != (depth[:, 1] < 0.0)
    share = depth[crossing, :1] / (depth[crossing, :1] - depth[crossing, 1:])
    points = box[crossing, 0] + share * (box[crossing, 1] - box[crossing, 0])
    if len(points) < 3:
        return np.zeros((0, 3))
    right = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    right /= np.linalg.norm(right)
    upwards, around = np.cross(normal, right), points - points.mean(axis=0)
    return points[np.argsort(np.arctan2(around @ upwards, around @ right))]


def dashed(segments: Array, extent: float) -> Array:
    """(n, 2, 3) dashes along segments (k, 2, 3), for pictures of an extent [m]."""
    dashes = []
    for begin, end in segments:
        length = float(np.linalg.norm(end - begin))
        count = max(1, round(0.5 * (length / extent * _DASHES + 1.0)))  # a dash at both ends
        at = np.arange(2 * count) / (2 * count - 1)
        dashes.append((begin + at[:, None] * (end - begin)).reshape(-1, 2, 3))
    return np.concatenate([np.zeros((0, 2, 3)), *dashes])


def flat_zone(zone: Zone, axes: Array, height: float, corners: Array) -> FlatZone | None:
    """A zone in a picture: what is in its outline, or on the inner side of its plane.

    Args:
        zone: the zone.
        axes: (3, 3) view axes, see `view_axes`.
        height: towards the viewer [m] of the plane in which a half-space is cut that is not seen
            edge-on.
        corners: (4, 2) of the picture, counter-clockwise [m].

    Returns:
        None for a plane that is parallel to the picture, or has all of it inside.
    """
    if not isinstance(zone, HalfSpace):
        outline = outline_of(zone, axes[:2])
        return FlatZone(outline, np.vstack([outline, outline[:1]]), True)
    (plane,) = planes_of(zone)
    normal = axes @ plane[:3]
    if np.linalg.norm(normal[:2]) < _FACE_ON:
        return None
    depth = corners @ normal[:2] + normal[2] * height - plane[3]
    kept, border = [], []
    for k, (here, following) in enumerate(zip(depth, np.roll(depth, -1), strict=True)):
        begin, end = corners[k], corners[(k + 1) % len(corners)]
        if here < 0.0:
            kept.append(begin)
        if (here < 0.0) != (following < 0.0):
            border.append(begin + here / (here - following) * (end - begin))
            kept.append(border[-1])
    if len(border) != 2:
        return None
    return FlatZone(np.array(kept), np.array(border), abs(float(normal[2])) < _EDGE_ON)


def legend_of(zones: Sequence[Zone], own: str, widest: int) -> str:
    """The text of zones in a legend: their names, if they have any, after what they are.

    Args:
        zones: the zones.
        own: the figure's word for zones; one that the user chose stays as it is.
        widest: letters of a line.
    """
    names = [zone.name for zone in zones if zone.name]
    return fill(f"{own}: {', '.join(names)}", widest) if names and own == ZONE else own


def name_places(zones: Sequence[Zone], low: Array, high: Array) -> list[tuple[str, Array]]:
    """Names of zones and where they are written, at a corner of each [m]; see `lines_of`."""
    places = []
    for zone in zones:
        ends = lines_of(zone, low, high).segments.reshape(-1, 3)
        if zone.name and len(ends):
            places.append((zone.name, ends[np.argmax(ends @ [1.0, 1.1, 1.2])]))
    return places

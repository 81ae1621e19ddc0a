"""Convex hulls that together cover what a closed mesh encloses.

Planes across the axes cut the enclosed solid S into parts, each in a box B without ends or with
some. S in B is a body with flat sides. Its corners are corners of the mesh, places where an edge of
the mesh meets a side of B or a side of the mesh an edge of B, and corners of B that lie in S. The
triangles of the mesh, cut at the planes, have all of these but the last as corners. So the hull of
their corners, with the corners of B that lie in S, contains S in B.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.sphere_cover import check_closed, winding_number

_PLACES = 7  # candidates for a cut along each axis, at equal distances
_GAIN = 0.01  # share of the volume that is worth a cut
_OUTSIDE = 0.01  # winding number about a point that is certainly outside
_FLAT = 1e-9  # share of the whole volume below which a hull is flat


class _Mesh(NamedTuple):
    """Triangles (k, 3, 3) of a part, and those of the whole connected mesh [m]."""

    part: Array
    whole: Array


class _Piece(NamedTuple):
    """A part of a mesh.

    Attributes:
        triangles: (k, 3, 3) [m].
        box: (2, 3) least and greatest coordinates of the box that it was cut to, or infinite [m].
        corners: (c, 3) corners of that box that the mesh encloses [m].
        volume: of the hull of both [m^3].
        saved: volume that the best cut saves [m^3].
        axis: of that cut; without one the longest axis.
        place: coordinate of its plane [m]; without one the middle.
    """

    triangles: Array
    box: Array
    corners: Array
    volume: float
    saved: float
    axis: int
    place: float

    @property
    def points(self) -> Array:
        """(n, 3) whose hull it is [m]."""
        return np.vstack([self.triangles.reshape(-1, 3), self.corners])


def convex_pieces(triangles: Array, most: int) -> list[Array]:
    """Points of hulls that cover what a closed mesh encloses, in as many pieces as help.

    Args:
        triangles: (k, 3, 3) corners of the mesh [m].
        most: number of hulls at most.

    Returns:
        (n, 3) points of each hull [m].

    Raises:
        InvalidInput: the mesh is flat or not closed, or has more connected parts than hulls are
            allowed.
    """
    check_closed(triangles, "mesh")
    whole = _volume(triangles.reshape(-1, 3))
    if whole <= 0.0:
        raise InvalidInput("mesh", "a flat mesh", "a mesh that encloses a volume")
    parts = connected_parts(triangles)
    if len(parts) > most:
        raise InvalidInput("pieces", most, f"at least {len(parts)}, the mesh's connected parts")
    flat, endless = _FLAT * whole, np.array([[-np.inf] * 3, [np.inf] * 3])
    pieces = [_with_best_cut(_Mesh(part, part), endless, flat) for part in parts]
    owners, enclosed = list(parts), abs(_enclosed_volume(triangles))
    while len(pieces) < most:
        k = max(range(len(pieces)), key=lambda j: pieces[j].saved)
        total = sum(each.volume for each in pieces)
        if total <= (1.0 + _GAIN) * enclosed:
            break
        if pieces[k].saved <= _GAIN * total:  # a ring is not better in halves, but in quarters
            k = max(range(len(pieces)), key=lambda j: pieces[j].volume)
        piece = pieces[k]
        sides = cut(piece.triangles, piece.axis, piece.place)
        boxes = _halves(piece.box, piece.axis, piece.place)
        pieces[k : k + 1] = [
            _with_best_cut(_Mesh(side, owners[k]), box, flat)
            for side, box in zip(sides, boxes, strict=True)
        ]
        owners[k : k + 1] = [owners[k], owners[k]]
    return [np.unique(piece.points, axis=0) for piece in pieces if piece.volume > 0.0]


def connected_parts(triangles: Array) -> list[Array]:
    """The triangles of a mesh by connected parts: those that share corners belong together.

    Args:
        triangles: (k, 3, 3) corners [m].
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 3)
    first, second = corner[:, [0, 1]].ravel(), corner[:, [1, 2]].ravel()
    size = int(corner.max()) + 1
    links = coo_array((np.ones(len(first)), (first, second)), shape=(size, size))
    count, part = connected_components(links, directed=False)
    return [triangles[part[corner[:, 0]] == k] for k in range(count)]


def cut(triangles: Array, axis: int, place: float) -> tuple[Array, Array]:
    """The parts of triangles on both sides of a plane across an axis.

    Args:
        triangles: (k, 3, 3) corners [m].
        axis: the axis, 0 to 2.
        place: coordinate of the plane [m].

    Returns:
        (a, 3, 3) those below, and (b, 3, 3) those above.
    """
    beyond = triangles[:, :, axis] > place
    count = beyond.sum(axis=1)
    below, above = [triangles[count == 0]], [triangles[count == 3]]
    for number, lone, rest in ((1, above, below), (2, below, above)):
        chosen = triangles[count == number]
        single = beyond[count == number] == (number == 1)
        first = np.argmax(single, axis=1)
        a, b, c = (chosen[np.arange(len(chosen)), (first + step) % 3] for step in range(3))
        on_b, on_c = _crossing(a, b, axis, place), _crossing(a, c, axis, place)
        lone.append(np.stack([a, on_b, on_c], axis=1))
        rest.append(np.stack([on_b, b, c], axis=1))
        rest.append(np.stack([on_b, c, on_c], axis=1))
    return np.concatenate(below), np.concatenate(above)


def _crossing(a: Array, b: Array, axis: int, place: float) -> Array:
    """(k, 3) where the lines from points a to b (k, 3) meet a plane between them."""
    share = (place - a[:, axis]) / (b[:, axis] - a[:, axis])
    points: Array = a + share[:, None] * (b - a)
    points[:, axis] = place
    return points


def _halves(box: Array, axis: int, place: float) -> tuple[Array, Array]:
    """Both parts of a box (2, 3) that a plane across an axis cuts."""
    below, above = box.copy(), box.copy()
    below[1, axis] = above[0, axis] = place
    return below, above


def _enclosed_corners(box: Array, whole: Array) -> Array:
    """(c, 3) corners of a box (2, 3) that a mesh encloses or that lie on it."""
    corners = np.array(list(product(*box.T)))
    corners = corners[np.all(np.isfinite(corners), axis=1)]
    kept = [corner for corner in corners if abs(winding_number(whole, corner)) > _OUTSIDE]
    return np.array(kept).reshape(-1, 3)


def _with_best_cut(mesh: _Mesh, box: Array, flat: float) -> _Piece:
    """A piece, and the plane across an axis that saves most of its hull's volume."""
    corners = _enclosed_corners(box, mesh.whole)
    best = _Piece(mesh.part, box, corners, 0.0, 0.0, 0, 0.0)
    points = best.points
    low, high = points.min(axis=0), points.max(axis=0)
    longest = int(np.argmax(high - low))
    middle = 0.5 * float(low[longest] + high[longest])
    best = best._replace(volume=_volume(points), axis=longest, place=middle)
    for axis in range(3):
        for place in np.linspace(low[axis], high[axis], _PLACES + 2)[1:-1].tolist():
            parts = cut(mesh.part, axis, place)
            sides = [
                _volume(np.vstack([part.reshape(-1, 3), corners[_on_side(corners, own)]]))
                for part, own in zip(parts, _halves(box, axis, place), strict=True)
            ]
            saved = best.volume - sum(sides)
            if min(sides) > flat and saved > best.saved:
                best = best._replace(saved=saved, axis=axis, place=place)
    return best


def _enclosed_volume(triangles: Array) -> float:
    """Signed volume that triangles (k, 3, 3) enclose [m^3]."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    return float(np.sum(a * np.cross(b, c))) / 6.0


def _on_side(points: Array, box: Array) -> Flags:
    """(n,) whether points lie in a box (2, 3)."""
    inside: Flags = np.all((box[0] <= points) & (points <= box[1]), axis=1)
    return inside


def _volume(points: Array) -> float:
    """Volume of the hull of points (n, 3); 0 if they lie in a plane [m^3]."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points).volume) if len(points) > 3 else 0.0
    except QhullError:
        return 0.0

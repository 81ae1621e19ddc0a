"""Spheres around a mesh: all that it encloses lies in them, and they reach no farther than stated.

Space is cut into cubes of edge h. Cubes that meet the surface are found by halving a large cube
again and again, each part tested against each triangle by separating axes. The others are told
inside from outside in bulk: two cubes that share a face, neither of which meets the surface, are on
the same side of it, so that one winding number decides for a whole connected region. A cube of edge
n h lies in the ball of radius sqrt(3) n h / 2 about its middle. Balls go around

- every cube that meets the surface (n = 1). The middle is within sqrt(3) h / 2 of the surface, so
  that no point of the ball is farther than sqrt(3) h from it;
- inner cubes, put together to larger ones. Such a ball leaves its cube by (sqrt(3) - 1) n h / 2 at
  most; the cube is taken only if it keeps that much, less sqrt(3) h, from what is not inside.

So every point of the balls is within sqrt(3) h of what the mesh encloses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.errors import InvalidInput

MOST_CUBES = 30_000_000
"""Of the grid around a mesh, for the memory's sake."""
_ROUNDING = 1e-9  # share of the largest coordinate by which cubes and balls are widened
_CHUNK = 200_000  # pairs of a cube and a triangle tested at once
_CORNERS = np.array(np.meshgrid(*[(0, 1)] * 3, indexing="ij")).reshape(3, 8).T


class Cover(NamedTuple):
    """Spheres around a mesh."""

    centers: Array
    """(N, 3) [m]."""
    radii: Array
    """(N,) [m]."""


def cover(triangles: Array, excess: float, inside: bool) -> Cover:
    """Spheres around a surface and what it encloses.

    Args:
        triangles: (k, 3, 3) corners of its triangles [m].
        excess: how far a sphere may reach beyond what the mesh encloses [m], > 0.
        inside: whether to cover what is enclosed as well as the surface. A point is enclosed if the
            surface winds around it; hollows with a wall of their own are not.

    Raises:
        InvalidInput: an excess too small for the size of the mesh, or a surface that is not closed
            where the inside is to be covered.
    """
    slack = _ROUNDING * float(np.abs(triangles).max())
    edge = (excess - 2.0 * slack) / np.sqrt(3.0)
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    least = np.sqrt(3.0) * (np.prod(high - low + 3.0 * max(edge, 0.0)) / MOST_CUBES) ** (1.0 / 3.0)
    if edge <= 0.0 or np.prod((high - low) / edge + 3.0) > MOST_CUBES:
        raise InvalidInput("mesh, excess", excess, f"about {least:.2g} m or more for its size")
    if inside:
        _check_closed(triangles)
    origin = low - 1.5 * edge  # an empty layer all around, and flat sides in the middle of cubes
    counts = np.ceil((high - origin) / edge + 1.0).astype(np.int64)
    surface = np.zeros(counts, dtype=bool)
    surface[tuple(_cubes_at_the_surface(triangles, origin, edge, counts, slack).T)] = True
    found = [(np.argwhere(surface), 1)]
    if inside:
        found += _large_cubes(_enclosed(triangles, surface, origin, edge))
    centers = [origin + (corner + 0.5 * n) * edge for corner, n in found]
    radii = [np.full(len(corner), 0.5 * np.sqrt(3.0) * n * edge + slack) for corner, n in found]
    return Cover(np.vstack(centers), np.concatenate(radii))


def _check_closed(triangles: Array) -> None:
    """Every edge has to be passed as often one way as the other: then winding numbers are whole."""
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 3)
    tails, tips = corner.ravel(), np.roll(corner, -1, axis=1).ravel()
    low, high = np.minimum(tails, tips), np.maximum(tails, tips)
    _, edge = np.unique(np.column_stack([low, high]), axis=0, return_inverse=True)
    passed = np.bincount(edge.ravel(), weights=np.sign(tips - tails))
    if np.any(passed != 0.0):
        raise InvalidInput(
            "mesh",
            f"{np.count_nonzero(passed)} edges without a neighbour that faces the same way",
            "a closed surface, or inside=False to cover the surface alone",
        )


def _cubes_at_the_surface(
    triangles: Array, origin: Array, edge: float, counts: IntArray, slack: float
) -> IntArray:
    """(m, 3) indices of all cubes of the grid that meet a triangle."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    extent = np.max(high - low, axis=1)
    levels = int(np.ceil(np.log2(counts.max())))
    cubes = np.zeros((len(triangles), 3), dtype=np.int64)
    owners = np.arange(len(triangles))
    for level in range(levels - 1, -1, -1):
        size = 2**level
        kept = []
        for begin in range(0, len(cubes), _CHUNK // 8):
            chunk = slice(begin, begin + _CHUNK // 8)
            parts = (2 * cubes[chunk, None] + _CORNERS).reshape(-1, 3)
            owner = np.repeat(owners[chunk], 8)
            corners = origin + parts * (size * edge)
            meets = np.all(parts * size < counts, axis=1)
            meets &= np.all(corners - slack <= high[owner], axis=1)
            meets &= np.all(corners + (size * edge + slack) >= low[owner], axis=1)
            # boxes around the triangles tell enough as long as cubes are larger than these
            exact = np.flatnonzero(meets & ((level == 0) | (extent[owner] > size * edge)))
            middles = corners[exact, None] + 0.5 * size * edge
            meets[exact] = _meet(triangles[owner[exact]] - middles, 0.5 * size * edge + slack)
            kept.append((parts[meets], owner[meets]))
        cubes = np.concatenate([part for part, _ in kept])
        owners = np.concatenate([owner for _, owner in kept])
    return np.unique(cubes, axis=0)


def _meet(triangles: Array, half: float) -> Flags:
    """Whether triangles (N, 3, 3) meet the cube of half edge `half` about the origin.

    They do not if some direction separates them: an axis of the cube, the triangle's normal, or the
    product of an axis and an edge.
    """
    sides = np.roll(triangles, -1, axis=1) - triangles
    normals = np.cross(sides[:, 0], sides[:, 1])[:, None]
    crossed = [np.cross(axis, sides) for axis in np.eye(3)]
    axes = np.broadcast_to(np.eye(3), (len(triangles), 3, 3))
    directions = np.concatenate([axes, normals, *crossed], axis=1)
    along = np.einsum("ndi,nci->ndc", directions, triangles)
    reach = half * np.abs(directions).sum(axis=2)
    apart = (along.min(axis=2) > reach) | (along.max(axis=2) < -reach)
    return ~np.asarray(apart.any(axis=1))


def _enclosed(triangles: Array, surface: Flags, origin: Array, edge: float) -> Flags:
    """Cubes off the surface that it winds around."""
    from scipy.ndimage import label

    regions, count = label(~surface)
    _, first = np.unique(regions, return_index=True)
    inner = np.zeros(count + 1, dtype=bool)
    for number, place in zip(regions.ravel()[first], first, strict=True):
        if number > 0:
            cube = np.array(np.unravel_index(place, regions.shape))
            inner[number] = abs(_winding(triangles, origin + (cube + 0.5) * edge)) > 0.5
    return np.asarray(inner[regions])


def _winding(triangles: Array, point: Array) -> float:
    """How often the surface winds around a point: its solid angle / 4 pi."""
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    x, y, z = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    facing = x * y * z + np.sum(a * b, 1) * z + np.sum(b * c, 1) * x + np.sum(c * a, 1) * y
    return float(np.sum(np.arctan2(volume, facing)) / (2.0 * np.pi))


def _large_cubes(inner: Flags) -> list[tuple[IntArray, int]]:
    """Inner cubes put together, the largest first: corners (m, 3) and edges n, in cubes."""
    from scipy.ndimage import distance_transform_cdt

    # 1 for cubes beside one that is not inner, 2 for the next ones in, and so on
    depth, n = distance_transform_cdt(inner), 1
    while n <= depth.max():
        n *= 2
    room = np.zeros([-(-size // n) * n for size in inner.shape], dtype=np.int32)
    room[tuple(map(slice, inner.shape))] = depth
    found = []
    while n >= 1:
        beyond = 0.5 * (np.sqrt(3.0) - 1.0) * n - np.sqrt(3.0)
        enough = room >= 1 + max(0, int(np.ceil(beyond)))
        a, b, c = (size // n for size in room.shape)
        whole = enough.reshape(a, n, b, n, c, n).all(axis=(1, 3, 5))
        found.append((n * np.argwhere(whole), n))
        room[whole.repeat(n, 0).repeat(n, 1).repeat(n, 2)] = 0
        n //= 2
    return found

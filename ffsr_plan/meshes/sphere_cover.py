"""Cover of a mesh by spheres with a bounded excess.

Space is divided into cubes of edge h. The cubes that meet the surface are found by subdividing a
large cube, each part being tested against each triangle by separating axes. The other cubes are
classified region by region: two cubes that share a face and do not meet the surface are on the same
side of it, so that one winding number classifies a whole connected region. A cube of edge n h lies
in the ball of radius sqrt(3) n h / 2 about its centre. The balls of the cover are those of

- every cube that meets the surface (n = 1). Its centre is within sqrt(3) h / 2 of the surface, so
  that no point of the ball is farther than sqrt(3) h from it;
- enclosed cubes, merged to larger ones. Such a ball protrudes from its cube by at most
  (sqrt(3) - 1) n h / 2; the cube is used only if its distance from all cubes that are not enclosed
  is at least that, less sqrt(3) h.

Hence every point of the balls is within sqrt(3) h of the enclosed volume, and the balls contain all
of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.errors import InvalidInput

MOST_CUBES = 30_000_000
"""Limit of the size of the grid around a mesh, to limit memory use."""
_ROUNDING = 1e-9  # share of the largest coordinate by which cubes and balls are enlarged
_CHUNK = 200_000  # pairs of a cube and a triangle tested at once
_CORNERS = np.array(np.meshgrid(*[(0, 1)] * 3, indexing="ij")).reshape(3, 8).T


class Cover(NamedTuple):
    """Spheres that cover a mesh.

    Attributes:
        centers: (N, 3) [m].
        radii: (N,) [m].
    """

    centers: Array
    radii: Array


def cover(triangles: Array, excess: float, inside: bool, where: str = "mesh") -> Cover:
    """Cover a surface and the volume that it encloses by spheres.

    Args:
        triangles: (k, 3, 3) corners of its triangles [m].
        excess: greatest distance of a point of a sphere from the enclosed volume [m], > 0.
        inside: whether to cover the enclosed volume as well as the surface. A point is enclosed if
            the winding number of the surface about it is not zero; the inside of a cavity with a
            closed surface of its own is not enclosed.
        where: name of the mesh in messages.

    Returns:
        The spheres.

    Raises:
        InvalidInput: an excess too small for the size of the mesh, or `inside` with a surface that
            is not closed.
    """
    rounding = _ROUNDING * float(np.abs(triangles).max())
    edge = (excess - 2.0 * rounding) / np.sqrt(3.0)
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    least = np.sqrt(3.0) * (np.prod(high - low + 3.0 * max(edge, 0.0)) / MOST_CUBES) ** (1.0 / 3.0)
    if edge <= 0.0 or np.prod((high - low) / edge + 3.0) > MOST_CUBES:
        raise InvalidInput(f"{where}, excess", excess, f"about {least:.2g} m or more for its size")
    if inside:
        check_closed(triangles, where)
    origin = low - 1.5 * edge  # an empty layer all around; flat sides pass through cube centres
    counts = np.ceil((high - origin) / edge + 1.0).astype(np.int64)
    surface = np.zeros(counts, dtype=bool)
    surface[tuple(_cubes_at_the_surface(triangles, origin, edge, counts, rounding).T)] = True
    cubes = [(np.argwhere(surface), 1)]
    if inside:
        cubes += _large_cubes(_enclosed(triangles, surface, origin, edge))
    centers = [origin + (corner + 0.5 * n) * edge for corner, n in cubes]
    radii = [np.full(len(corner), 0.5 * np.sqrt(3.0) * n * edge + rounding) for corner, n in cubes]
    return Cover(np.vstack(centers), np.concatenate(radii))


def check_closed(triangles: Array, where: str) -> None:
    """Check that the surface is closed, so that its winding numbers are integers.

    The triangles must pass every edge as often in one direction as in the other. The properties
    `is_watertight` and `is_winding_consistent` of trimesh are stricter: they refuse parts that
    share an edge or a face, as assemblies have.
    """
    _, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    corner = corner.reshape(-1, 3)
    tails, tips = corner.ravel(), np.roll(corner, -1, axis=1).ravel()
    low, high = np.minimum(tails, tips), np.maximum(tails, tips)
    _, edge = np.unique(np.column_stack([low, high]), axis=0, return_inverse=True)
    passed = np.bincount(edge.ravel(), weights=np.sign(tips - tails))
    if np.any(passed != 0.0):
        raise InvalidInput(
            where,
            f"{np.count_nonzero(passed)} edges without a neighbour that faces the same way",
            "a closed surface, or inside=False to cover the surface alone",
        )


def _cubes_at_the_surface(
    triangles: Array, origin: Array, edge: float, counts: IntArray, rounding: float
) -> IntArray:
    """(m, 3) indices of all cubes of the grid that meet a triangle, cubes enlarged for rounding."""
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
            meets &= np.all(corners - rounding <= high[owner], axis=1)
            meets &= np.all(corners + (size * edge + rounding) >= low[owner], axis=1)
            # boxes around the triangles are sufficient while cubes are larger than triangles
            exact = np.flatnonzero(meets & ((level == 0) | (extent[owner] > size * edge)))
            middles = corners[exact, None] + 0.5 * size * edge
            meets[exact] = _meet(triangles[owner[exact]] - middles, 0.5 * size * edge + rounding)
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
    cube = half * np.abs(directions).sum(axis=2)
    apart = (along.min(axis=2) > cube) | (along.max(axis=2) < -cube)
    return ~apart.any(axis=1)


def _enclosed(triangles: Array, surface: Flags, origin: Array, edge: float) -> Flags:
    """Cubes that do not meet the surface and are enclosed by it."""
    from scipy.ndimage import label

    regions, count = label(~surface)
    _, first = np.unique(regions, return_index=True)
    inner = np.zeros(count + 1, dtype=bool)
    for number, place in zip(regions.ravel()[first], first, strict=True):
        if number > 0:
            cube = np.array(np.unravel_index(place, regions.shape))
            inner[number] = abs(winding_number(triangles, origin + (cube + 0.5) * edge)) > 0.5
    return inner[regions]


def winding_number(triangles: Array, point: Array) -> float:
    """Winding number of a closed surface about a point: its solid angle / (4 pi).

    Args:
        triangles: (k, 3, 3) corners of its triangles [m].
        point: (3,) [m], not on the surface.
    """
    a, b, c = np.moveaxis(triangles - point, 1, 0)
    x, y, z = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    facing = x * y * z + np.sum(a * b, 1) * z + np.sum(b * c, 1) * x + np.sum(c * a, 1) * y
    return float(np.sum(np.arctan2(volume, facing)) / (2.0 * np.pi))


def _large_cubes(inner: Flags) -> list[tuple[IntArray, int]]:
    """Enclosed cubes merged, the largest first: corners (m, 3) and edges n, in cubes."""
    from scipy.ndimage import distance_transform_cdt

    # 1 for enclosed cubes beside one that is not, 2 for the next layer, and so on
    depth, n = distance_transform_cdt(inner), 1
    while n <= depth.max():
        n *= 2
    padded = np.zeros([-(-size // n) * n for size in inner.shape], dtype=np.int32)
    padded[tuple(map(slice, inner.shape))] = depth
    merged = []
    while n >= 1:
        excess = 0.5 * (np.sqrt(3.0) - 1.0) * n - np.sqrt(3.0)
        enough = padded >= 1 + max(0, int(np.ceil(excess)))
        a, b, c = (size // n for size in padded.shape)
        whole = enough.reshape(a, n, b, n, c, n).all(axis=(1, 3, 5))
        merged.append((n * np.argwhere(whole), n))
        padded[whole.repeat(n, 0).repeat(n, 1).repeat(n, 2)] = 0
        n //= 2
    return merged

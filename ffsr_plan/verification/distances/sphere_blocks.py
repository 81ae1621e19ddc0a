"""Spheres in blocks of neighbours, so that those far from a point are passed over block by block.

The planner's tree over the spheres is not used: a mistake in it would be hidden here too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray

BLOCK = 64
"""Spheres of a block; the last one has fewer."""
_BITS = 20  # of each coordinate in a sphere's place on the curve


class SphereBlocks(NamedTuple):
    """N spheres, block after block.

    Attributes:
        centers: (N, 3) [m].
        radii: (N,) [m].
        lows: (b, 3) least coordinates of the centres of each block [m].
        highs: (b, 3) greatest ones [m].
        largest: (b,) largest radius of each block [m].
        inner: (N,) radii of the spheres inside what the spheres stand for [m].
        order: (N,) number of each sphere before they were put into blocks.
    """

    centers: Array
    radii: Array
    lows: Array
    highs: Array
    largest: Array
    inner: Array
    order: IntArray


def sphere_blocks(centers: Array, radii: Array, inner: Array | None = None) -> SphereBlocks:
    """Put spheres into blocks along a Z-order curve, on which neighbours are close in space.

    Args:
        centers: (N, 3) [m].
        radii: (N,) [m].
        inner: (N,) radii of spheres about the same centres, inside the obstacles that the others
            contain [m]; None if the obstacles are spheres.
    """
    within = radii if inner is None else inner
    if not len(radii):
        none, empty = np.zeros((0, 3)), np.zeros(0)
        return SphereBlocks(none, empty, none, none, empty, empty, np.zeros(0, dtype=np.int64))
    low = centers.min(axis=0)
    cell = max(float(np.max(centers - low)), 1e-9) / (2**_BITS - 1)
    cells = ((centers - low) / cell).astype(np.uint64)
    order = np.argsort(_places_on_the_curve(cells), kind="stable")
    own, sizes = centers[order], radii[order]
    begins = np.arange(0, len(sizes), BLOCK)
    return SphereBlocks(
        own,
        sizes,
        np.minimum.reduceat(own, begins),
        np.maximum.reduceat(own, begins),
        np.maximum.reduceat(sizes, begins),
        within[order],
        order,
    )


def _places_on_the_curve(cells: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """(N,) the bits of three whole numbers (N, 3), in turns."""
    places = np.zeros(len(cells), dtype=np.uint64)
    for axis, numbers in enumerate(cells.T):
        spread = numbers.copy()
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            spread = (spread | (spread << np.uint64(shift))) & np.uint64(mask)
        places |= spread << np.uint64(axis)
    return places

"""`SphereTree`: spheres inside spheres, so that the nearest of thousands is found in few steps.

Inner nodes are spheres as well, each around all that lies below it. One formula, the distance of a
link's shape to a sphere, serves nodes and obstacles alike: less the node's radius it is a lower
bound on the distance to everything inside, in penetration too, because a signed distance changes
by no more than its argument moves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, frozen

_LEAF = 4


class SphereTree(NamedTuple):
    """A binary tree over N spheres, as arrays for the compiled search."""

    nodes: Array
    """(M, 4) centre and radius of the sphere around each node [m]; node 0 is the root."""
    children: NDArray[np.int32]
    """(M, 2) the two nodes below; in a leaf, -1 - first and the end of its row of `spheres`."""
    spheres: Array
    """(N, 4) centre and radius of each obstacle [m], in the order of the leaves."""
    order: IntArray
    """(N,) index of each of them in the scene."""


def sphere_tree(centers: Array, radii: Array) -> SphereTree:
    """Build the tree of spheres (N, 3), (N,): halves along the longest side, down to four."""
    order = np.arange(len(radii))
    nodes: list[tuple[float, ...]] = []
    children: list[tuple[int, int]] = []

    def build(begin: int, end: int) -> int:
        inside = order[begin:end]
        own, reach = centers[inside], radii[inside]
        low, high = (own - reach[:, None]).min(axis=0), (own + reach[:, None]).max(axis=0)
        middle = 0.5 * (low + high)
        around = float(np.max(np.linalg.norm(own - middle, axis=1) + reach))
        me = len(nodes)
        nodes.append((*middle.tolist(), around))
        children.append((-1 - begin, end))
        if end - begin > _LEAF:
            half = (end - begin) // 2
            along = own[:, int(np.argmax(own.max(axis=0) - own.min(axis=0)))]
            order[begin:end] = inside[np.argpartition(along, half)]
            children[me] = (build(begin, begin + half), build(begin + half, end))
        return me

    if len(radii):
        build(0, len(radii))
    return SphereTree(
        frozen(np.array(nodes, dtype=np.float64).reshape(-1, 4)),
        frozen(np.array(children, dtype=np.int32).reshape(-1, 2)),
        frozen(np.column_stack([centers, radii])[order]),
        frozen(order),
    )

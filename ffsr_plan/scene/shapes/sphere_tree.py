"""Bounding-sphere tree for the search of the nearest sphere.

Every node has a sphere around all spheres below it. The signed distance from a shape to a node's
sphere is a lower bound on the distance to every sphere inside, in penetration too, because a signed
distance is 1-Lipschitz in the point. The same formula thus serves nodes and obstacles.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, frozen

_SPHERES_PER_LEAF = 4
_FEW = 20_000  # spheres that take less time without a kernel than its loading or compilation


class SphereTree(NamedTuple):
    """A binary tree over N spheres, as arrays for the compiled search.

    Attributes:
        nodes: (M, 4) centre and radius of the sphere around each node [m]; node 0 is the root.
        children: (M, 2) the two nodes below an inner node; (-1 - first, end) for a leaf, whose
            spheres are the rows first .. end - 1 of `spheres`.
        spheres: (N, 4) centre and radius of each obstacle [m], in the order of the leaves.
        order: (N,) index in the scene of each row of `spheres`.
    """

    nodes: Array
    children: NDArray[np.int32]
    spheres: Array
    order: IntArray


def sphere_tree(centers: Array, radii: Array) -> SphereTree:
    """Build the tree: halves along the longest side, down to four spheres per leaf.

    The same spheres give the same tree.

    Args:
        centers: (N, 3) centres of the spheres [m].
        radii: (N,) their radii [m].
    """
    tree = _tree_of_few(centers, radii) if len(radii) <= _FEW else _tree_of_many(centers, radii)
    for array in tree:
        frozen(array)
    return tree


def _tree_of_many(centers: Array, radii: Array) -> SphereTree:
    from ffsr_plan.scene.shapes.sphere_tree_kernel import fill_tree

    count = len(radii)
    spheres, order = np.column_stack([centers, radii]), np.arange(count)
    nodes, children = np.empty((count, 4)), np.empty((count, 2), dtype=np.int32)
    used = fill_tree(spheres, order, nodes, children, _SPHERES_PER_LEAF)
    return SphereTree(nodes[:used].copy(), children[:used].copy(), spheres, order)


def _tree_of_few(centers: Array, radii: Array) -> SphereTree:
    order = np.arange(len(radii))
    nodes: list[tuple[float, ...]] = []
    children: list[tuple[int, int]] = []

    def build(begin: int, end: int) -> int:
        inside = order[begin:end]
        own, radius = centers[inside], radii[inside]
        low, high = (own - radius[:, None]).min(axis=0), (own + radius[:, None]).max(axis=0)
        middle = 0.5 * (low + high)
        bounding = float(np.max(np.linalg.norm(own - middle, axis=1) + radius))
        node = len(nodes)
        nodes.append((*middle.tolist(), bounding))
        children.append((-1 - begin, end))
        if end - begin > _SPHERES_PER_LEAF:
            half = (end - begin) // 2
            along = own[:, int(np.argmax(own.max(axis=0) - own.min(axis=0)))]
            order[begin:end] = inside[np.argpartition(along, half)]
            children[node] = (build(begin, begin + half), build(begin + half, end))
        return node

    if len(radii):
        build(0, len(radii))
    return SphereTree(
        np.array(nodes, dtype=np.float64).reshape(-1, 4),
        np.array(children, dtype=np.int32).reshape(-1, 2),
        np.column_stack([centers, radii])[order],
        order,
    )

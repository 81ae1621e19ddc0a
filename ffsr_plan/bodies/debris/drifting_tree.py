"""One tree over drifting spheres that holds at every time.

Its topology is that of the spheres at one time, the middle of a flight. The sphere of each node
drifts too, at a velocity amid those of its spheres, and grows with the time from the middle on by
the largest difference from it. So it stays around all of its spheres, and no node is ever rebuilt.

Over a length of time each sphere can be inflated by half of its own path. That of a node counts by
the fastest of its spheres.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, frozen

SPHERES_PER_LEAF = 4


class DriftingTree(NamedTuple):
    """A binary tree over N drifting spheres, as arrays for the compiled search.

    Attributes:
        nodes: (M, 4) centre and radius of the sphere around each node at the middle time [m]; node
            0 is the root.
        node_drifts: (M, 5) velocity of that sphere, the rate at which its radius grows with the
            time before and after the middle, and the largest speed of a sphere inside [m/s].
        children: (M, 2) the two nodes below an inner node; (-1 - first, end) for a leaf, whose
            spheres are the rows first .. end - 1 of `spheres`.
        spheres: (N, 4) centre and radius of each sphere at the middle time [m], in the order of
            the leaves.
        drifts: (N, 5) velocity, zero, and speed of each sphere [m/s].
        order: (N,) number of each row of `spheres` among the spheres given.
        middle: the time to which nodes and spheres refer [s].
    """

    nodes: Array
    node_drifts: Array
    children: NDArray[np.int32]
    spheres: Array
    drifts: Array
    order: IntArray
    middle: float


def drifting_tree(centers: Array, radii: Array, velocities: Array, middle: float) -> DriftingTree:
    """Build the tree. The same spheres give the same tree.

    Args:
        centers: (N, 3) centres at time zero [m], N >= 1.
        radii: (N,) their radii [m].
        velocities: (N, 3) their velocities [m/s].
        middle: the time whose positions decide which spheres are neighbours [s].
    """
    from ffsr_plan.bodies.debris.drifting_tree_kernel import fill_node_drifts
    from ffsr_plan.scene.shapes.sphere_tree_kernel import fill_tree

    count = len(radii)
    spheres, order = np.column_stack([centers + middle * velocities, radii]), np.arange(count)
    nodes, children = np.empty((count, 4)), np.empty((count, 2), dtype=np.int32)
    used = fill_tree(spheres, order, nodes, children, SPHERES_PER_LEAF)
    own, speeds = velocities[order], np.linalg.norm(velocities[order], axis=1)
    drifts = np.column_stack([own, np.zeros(count), speeds])
    node_drifts = np.empty((used, 5))
    fill_node_drifts(children[:used], drifts, node_drifts)
    return DriftingTree(
        frozen(nodes[:used].copy()),
        frozen(node_drifts),
        frozen(children[:used].copy()),
        frozen(spheres),
        frozen(drifts),
        frozen(order),
        float(middle),
    )

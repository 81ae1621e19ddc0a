"""Compiled bounds on the clearances of nodes from those that were evaluated."""

from __future__ import annotations

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel


@kernel
def take_in(
    layers: IntArray,
    nodes: IntArray,
    exact: Array,
    distances: Array,
    bounds: Array,
    known: Flags,
) -> None:
    """Lower the bounds on layers by the clearance of one node of each.

    Args:
        layers: (k,) different layers.
        nodes: (k,) the node of each that was evaluated.
        exact: (k,) its clearance [m].
        distances: (n, n) distance between the offsets of any two nodes [m].
        bounds: (m + 1, n) upper bounds, exact where known, updated [m].
        known: (m + 1, n) the nodes that have been evaluated, updated.
    """
    for row in range(len(layers)):
        layer, node = layers[row], nodes[row]
        for k in range(bounds.shape[1]):
            if not known[layer, k]:
                bounds[layer, k] = min(bounds[layer, k], exact[row] + distances[node, k])
        bounds[layer, node] = exact[row]
        known[layer, node] = True

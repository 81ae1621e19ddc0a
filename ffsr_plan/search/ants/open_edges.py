"""Edges that ants may choose, dead ends excluded.

`open_edges` (m, n, n) says for every edge whether an ant may choose it: both ends are admissible,
it is not refused, and the goal can be reached from its head as far as is known. `open_counts`
(m, n) counts the open edges that leave each node; when the last one closes, those that lead to the
node close too.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import REFUSED


def find_open_edges(admissible: Flags, status: States) -> tuple[Flags, IntArray]:
    """`open_edges` and `open_counts` of a roadmap, dead ends closed."""
    open_edges = admissible[:-1, :, None] & admissible[1:, None, :] & (status != REFUSED)
    alive = np.ones(admissible.shape[1], dtype=bool)
    for layer in range(len(open_edges) - 1, -1, -1):
        open_edges[layer] &= alive
        alive = open_edges[layer].any(axis=1)
    return open_edges, np.count_nonzero(open_edges, axis=2)


@kernel
def close_refused(
    layer: int, status: States, open_edges: Flags, open_counts: IntArray, changed: Flags
) -> None:
    """Close the refused edges of one layer and those that lead to dead ends then.

    `changed` (m, n) is set for every node whose open edges have changed.
    """
    n = open_edges.shape[1]
    dead_layer = np.empty(open_edges.shape[0] * n, dtype=np.int64)
    dead_node = np.empty(open_edges.shape[0] * n, dtype=np.int64)
    dead = 0
    for j in range(n):
        for k in range(n):
            if open_edges[layer, j, k] and status[layer, j, k] == REFUSED:
                open_edges[layer, j, k] = False
                open_counts[layer, j] -= 1
                changed[layer, j] = True
                if open_counts[layer, j] == 0:
                    dead_layer[dead], dead_node[dead] = layer, j
                    dead += 1
    while dead > 0:
        dead -= 1
        i, node = dead_layer[dead], dead_node[dead]
        if i == 0:
            continue
        for j in range(n):
            if open_edges[i - 1, j, node]:
                open_edges[i - 1, j, node] = False
                open_counts[i - 1, j] -= 1
                changed[i - 1, j] = True
                if open_counts[i - 1, j] == 0:
                    dead_layer[dead], dead_node[dead] = i - 1, j
                    dead += 1

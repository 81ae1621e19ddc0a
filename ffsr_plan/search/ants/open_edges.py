"""Which edges ants may take: kernels that keep dead ends out of their reach.

`ways` (m, n, n) tells for every edge whether an ant may choose it: both ends admissible, not
refused, and the goal within reach from its head, as far as is known. `exits` (m, n) counts the ways
on from each node; when the last one closes, the ways into the node close too.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ffsr_plan.core.arrays import Flags, IntArray, States

_REFUSED = -1


def open_ways(admissible: Flags, status: States) -> tuple[Flags, IntArray]:
    """`ways` and `exits` of a roadmap, dead ends closed."""
    ways = admissible[:-1, :, None] & admissible[1:, None, :] & (status != _REFUSED)
    alive = np.ones(admissible.shape[1], dtype=bool)
    for layer in range(len(ways) - 1, -1, -1):
        ways[layer] &= alive
        alive = ways[layer].any(axis=1)
    return ways, np.count_nonzero(ways, axis=2)


@njit(cache=True, nogil=True)
def close_refused(layer: int, status: States, ways: Flags, exits: IntArray, changed: Flags) -> None:
    """Close the refused edges of one layer, and what they turn into dead ends.

    `changed` (m, n) is set for every node whose ways on have changed.
    """
    n = ways.shape[1]
    dead_layer = np.empty(ways.shape[0] * n, dtype=np.int64)
    dead_node = np.empty(ways.shape[0] * n, dtype=np.int64)
    dead = 0
    for j in range(n):
        for k in range(n):
            if ways[layer, j, k] and status[layer, j, k] == _REFUSED:
                ways[layer, j, k] = False
                exits[layer, j] -= 1
                changed[layer, j] = True
                if exits[layer, j] == 0:
                    dead_layer[dead], dead_node[dead] = layer, j
                    dead += 1
    while dead > 0:
        dead -= 1
        i, node = dead_layer[dead], dead_node[dead]
        if i == 0:
            continue
        for j in range(n):
            if ways[i - 1, j, node]:
                ways[i - 1, j, node] = False
                exits[i - 1, j] -= 1
                changed[i - 1, j] = True
                if exits[i - 1, j] == 0:
                    dead_layer[dead], dead_node[dead] = i - 1, j
                    dead += 1

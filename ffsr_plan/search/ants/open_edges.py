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
from ffsr_plan.time_limit.deadline import Deadline

_EDGES_AT_ONCE = 1_000_000  # that are looked at between two looks at the deadline


def find_open_edges(
    admissible: Flags, status: States, deadline: Deadline | None = None
) -> tuple[Flags, IntArray]:
    """`open_edges` and `open_counts` of a roadmap, dead ends closed.

    Raises:
        OutOfTime: at the deadline.
    """
    m, n = status.shape[:2]
    open_edges, open_counts = np.empty(status.shape, dtype=bool), np.empty((m, n), dtype=np.int64)
    stride = max(1, _EDGES_AT_ONCE // n**2)
    for first in range(0, m, stride):
        if deadline is not None:
            deadline.check()
        some = slice(first, min(first + stride, m))
        own = np.not_equal(status[some], REFUSED, out=open_edges[some])
        own &= admissible[some, :, None]
        own &= admissible[1:][some, None]
        open_counts[some] = np.count_nonzero(own, axis=2)
    for layer in range(m - 2, -1, -1):
        dead = admissible[layer + 1] & (open_counts[layer + 1] == 0)
        if dead.any():
            open_edges[layer][:, dead] = False
            open_counts[layer] = np.count_nonzero(open_edges[layer], axis=1)
    return open_edges, open_counts


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

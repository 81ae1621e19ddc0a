"""Compiled bounds on the drift of the spheres below each node of a tree."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel


@kernel
def fill_node_drifts(children: NDArray[np.int32], drifts: Array, node_drifts: Array) -> None:
    """Bound the drift of the spheres below each node.

    Args:
        children: (M, 2) as of `DriftingTree`; a parent comes before its children.
        drifts: (N, 5) of the spheres [m/s].
        node_drifts: (M, 5) of the nodes, filled in [m/s].
    """
    count = len(children)
    spans = np.empty((count, 2), np.int64)  # the spheres below each node
    for node in range(count - 1, -1, -1):
        left, right = children[node, 0], children[node, 1]
        if left < 0:
            spans[node, 0], spans[node, 1] = -1 - left, right
        else:
            spans[node, 0] = min(spans[left, 0], spans[right, 0])
            spans[node, 1] = max(spans[left, 1], spans[right, 1])
        own = node_drifts[node]
        for a in range(3):
            low, high = np.inf, -np.inf
            for k in range(spans[node, 0], spans[node, 1]):
                low, high = min(low, drifts[k, a]), max(high, drifts[k, a])
            own[a] = 0.5 * (low + high)
        growth, fastest = 0.0, 0.0
        for k in range(spans[node, 0], spans[node, 1]):
            x, y, z = drifts[k, 0] - own[0], drifts[k, 1] - own[1], drifts[k, 2] - own[2]
            growth = max(growth, math.sqrt(x * x + y * y + z * z))
            fastest = max(fastest, drifts[k, 4])
        own[3], own[4] = growth, fastest

"""Compiled marking of edges close to a refused edge."""

from __future__ import annotations

from ffsr_plan.core.arrays import Array, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import REFUSED


@kernel
def refuse_near(
    status: States, tails: Array, heads: Array, time: float, met: Array, depth: float
) -> None:
    """Refuse every edge of a layer that passes nearer than `depth` to a place at the same time.

    Args:
        status: (j, k) of the layer's edges, updated.
        tails: (j, 3) offsets at the edges' beginnings [m].
        heads: (k, 3) offsets at their ends [m].
        time: when, in [0, 1].
        met: (3,) offset of the place [m].
        depth: [m].
    """
    for j in range(len(tails)):
        x = (1.0 - time) * tails[j, 0] - met[0]
        y = (1.0 - time) * tails[j, 1] - met[1]
        z = (1.0 - time) * tails[j, 2] - met[2]
        for k in range(len(heads)):
            a, b, c = x + time * heads[k, 0], y + time * heads[k, 1], z + time * heads[k, 2]
            if a * a + b * b + c * c < depth * depth:
                status[j, k] = REFUSED

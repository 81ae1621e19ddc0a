"""Many edges at once, sampled at equal steps until they are proven free.

If no point travels farther over a step than the least clearance sampled, the clearances at both
ends of every step sum to more than that travel. So the edge is free (`interval_halving`), and its
clearance is nowhere below half of the least one sampled.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.proof.interval_halving import Verdict

LEVELS = (2, 4, 8, 16)
"""Numbers of steps, one after another."""


def sample_edges(
    measure: Callable[[IntArray, int], Array],
    ends: Array,
    speeds: Array,
    rounding: float,
    tolerance: float,
) -> list[Verdict]:
    """Sample edges at 2, 4, 8 and 16 steps, each edge until it is proven free.

    An edge with a clearance of at most `tolerance` is not sampled any more: it may be refused. An
    edge whose clearance is larger but less than the travel over the finest step is not proven free
    either.

    Args:
        measure: gives the clearances (t, j) of j of the edges at the times 1, 3, 5, ... over a
            number of steps [m].
        ends: (k, 2) clearances at both ends [m].
        speeds: (k,) bound on the travel of any point per unit of time [m].
        rounding: length added to every travel bound [m].
        tolerance: clearance below which an edge may be refused [m].

    Returns:
        k verdicts: whether the edge is proven free, and the least clearance sampled.
    """
    least, times = ends.min(axis=1), ends.argmin(axis=1).astype(np.float64)
    free, queries = np.zeros(len(ends), dtype=bool), np.zeros(len(ends), dtype=np.int64)
    for parts in LEVELS:
        left = np.flatnonzero(~free & (least > tolerance))
        if not len(left):
            break
        sampled = measure(left, parts)
        nearest = sampled.argmin(axis=0)
        found = sampled[nearest, np.arange(len(left))]
        closer = found < least[left]
        times[left[closer]] = (2.0 * nearest[closer] + 1.0) / parts
        least[left[closer]] = found[closer]
        queries[left] += len(sampled)
        free[left] = (least[left] > tolerance) & (least[left] >= speeds[left] / parts + rounding)
    columns = (free.tolist(), least.tolist(), times.tolist(), queries.tolist())
    return [Verdict(*row) for row in zip(*columns, strict=True)]

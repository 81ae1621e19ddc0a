"""Least change of velocity over all paths of a small lattice, path by path."""

from itertools import product

import numpy as np

from ffsr_plan.lattice.edge_states import REFUSED


def change_of(steps):
    """|e_1| + sum |e_t - e_(t-1)| + |e_m| of steps (m, 3), times m."""
    steps = np.asarray(steps)
    turns = np.linalg.norm(np.diff(steps, axis=0), axis=1).sum()
    ends = np.linalg.norm(steps[0]) + np.linalg.norm(steps[-1])
    return len(steps) * float(ends + turns)


def points(indices, spacing, length, path):
    """(m + 1, 3) positions of a path's nodes."""
    m = len(path) - 1
    at = np.zeros((m + 1, 3))
    at[:, 0] = np.arange(m + 1) / m * length
    at[:, 1 : 1 + indices.shape[1]] = indices[list(path)] * spacing
    return at


def least_change(indices, spacing, length, allowed, status):
    """The best path and its change; (None, infinity) without any."""
    m, origin = len(status), len(indices) // 2
    best = None, np.inf
    for inner in product(*(np.flatnonzero(row) for row in allowed[1:m])):
        path = (origin, *inner, origin)
        if any(status[i, path[i], path[i + 1]] == REFUSED for i in range(m)):
            continue
        change = change_of(np.diff(points(indices, spacing, length, path), axis=0))
        if change < best[1]:
            best = path, change
    return best

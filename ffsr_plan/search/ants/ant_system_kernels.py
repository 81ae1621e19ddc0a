"""The walk of the Ant System's ants, compiled: Eq. 11, one ant after the other."""

from __future__ import annotations

import numpy as np
from numba import njit

from ffsr_plan.core.arrays import Array, Flags, IntArray, States

_FREE = 1


@njit(cache=True, nogil=True)
def _spin_up(wheel: Array, log_weight: Array, open_row: Flags) -> None:
    """Cumulated weights of one row, scaled by its largest: only ratios count."""
    largest = -np.inf
    for k in range(len(wheel)):
        if open_row[k] and log_weight[k] > largest:
            largest = log_weight[k]
    total = 0.0
    for k in range(len(wheel)):
        if open_row[k]:
            total += np.exp(log_weight[k] - largest)
        wheel[k] = total


@njit(cache=True, nogil=True)
def walk(
    rng: np.random.Generator,
    tau: Array,
    alpha: float,
    log_visibility: Array,
    ways: Flags,
    exits: IntArray,
    status: States,
    wheels: Array,
    changed: Flags,
    paths: IntArray,
    ant: int,
    layer: int,
) -> tuple[int, int]:
    """Walk on from `ant` at `layer` until an unproven edge is chosen or all ants have arrived.

    Args:
        rng: numpy Generator.
        tau: (m, n, n) pheromone.
        alpha: its weight.
        log_visibility: (n, n) beta log eta.
        ways: (m, n, n) which edges may be chosen.
        exits: (m, n) number of ways on from each node.
        status: (m, n, n) what is known of each edge.
        wheels: (m, n, n) cumulated weights, kept between calls.
        changed: (m, n) rows of `wheels` that are out of date; set them all after each cycle.
        paths: (ants, m + 1) nodes; an edge chosen but unproven is left in it.
        ant: where to go on; the edge `layer` of its path may have been proven since.
        layer: as above.

    Returns:
        ant and layer of the unproven edge, or (ants, 0) at the end; ant -1 if the start is a dead
        end.
    """
    ants, m = len(paths), len(tau)
    n = ways.shape[1]
    scratch = np.empty(n)
    resumed = layer >= 0
    if not resumed:
        layer = 0
    while ant < ants:
        while layer < m:
            tail = paths[ant, layer]
            if resumed:
                resumed = False
                if status[layer, tail, paths[ant, layer + 1]] == _FREE:
                    layer += 1
                    continue
            if exits[layer, tail] == 0:
                if layer == 0:
                    return -1, 0
                layer = 0  # a dead end by now: the ant starts anew
                continue
            if changed[layer, tail]:
                for k in range(n):
                    scratch[k] = alpha * np.log(tau[layer, tail, k]) + log_visibility[tail, k]
                _spin_up(wheels[layer, tail], scratch, ways[layer, tail])
                changed[layer, tail] = False
            wheel = wheels[layer, tail]
            head = np.searchsorted(wheel, rng.random() * wheel[n - 1], side="right")
            paths[ant, layer + 1] = head
            if status[layer, tail, head] != _FREE:
                return ant, layer
            layer += 1
        ant += 1
        layer = 0
    return ants, 0

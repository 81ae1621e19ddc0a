"""Compiled tours of the Ant System's ants: Eq. 11, one ant after the other."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import FREE


@kernel
def _fill_roulette(
    roulette: Array, tau: Array, alpha: float, log_visibility: Array, open_row: Flags
) -> None:
    """Cumulative weights tau^alpha eta^beta of one row, scaled by the largest."""
    log_weights = alpha * np.log(tau) + log_visibility
    largest = -np.inf
    for k in range(len(roulette)):
        if open_row[k] and log_weights[k] > largest:
            largest = log_weights[k]
    total = 0.0
    for k in range(len(roulette)):
        if open_row[k]:
            total += np.exp(log_weights[k] - largest)
        roulette[k] = total


@kernel
def walk(
    rng: np.random.Generator,
    tau: Array,
    alpha: float,
    log_visibility: Array,
    open_edges: Flags,
    open_counts: IntArray,
    status: States,
    roulettes: Array,
    changed: Flags,
    paths: IntArray,
    ant: int,
    layer: int,
) -> tuple[int, int]:
    """Continue the tours from `ant` at `layer` until an unproven edge is chosen or all are done.

    Args:
        rng: source of randomness.
        tau: (m, n, n) pheromone.
        alpha: its weight.
        log_visibility: (n, n) beta log eta.
        open_edges: (m, n, n) edges that may be chosen.
        open_counts: (m, n) number of open edges from each node.
        status: (m, n, n) what is known of each edge.
        roulettes: (m, n, n) cumulative weights, kept between calls.
        changed: (m, n) rows of `roulettes` that are out of date; set them all after each cycle.
        paths: (ants, m + 1) nodes; an edge chosen but unproven is left in it.
        ant: ant to continue with; the edge `layer` of its path may have been proven since.
        layer: layer to continue at, -1 at the beginning.

    Returns:
        Ant and layer of the unproven edge; (ants, 0) at the end; (-1, 0) at a closed start.
    """
    ants, m = len(paths), len(tau)
    resumed, layer = layer >= 0, max(layer, 0)
    while ant < ants:
        while layer < m:
            tail = paths[ant, layer]
            if resumed:
                resumed = False
                if status[layer, tail, paths[ant, layer + 1]] == FREE:
                    layer += 1
                    continue
            if open_counts[layer, tail] == 0:
                if layer == 0:
                    return -1, 0
                layer = 0  # a dead end by now: the ant starts anew
                continue
            if changed[layer, tail]:
                row, seen = tau[layer, tail], log_visibility[tail]
                _fill_roulette(roulettes[layer, tail], row, alpha, seen, open_edges[layer, tail])
                changed[layer, tail] = False
            roulette = roulettes[layer, tail]
            head = np.searchsorted(roulette, rng.random() * roulette[-1], side="right")
            paths[ant, layer + 1] = head
            if status[layer, tail, head] != FREE:
                return ant, layer
            layer += 1
        ant, layer = ant + 1, 0
    return ants, 0

"""Compiled cycles of the max-min ant system.

All state lives in arrays that the caller owns, so that a run can stop where a path has to be
proven, and go on where it stopped.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import FREE
from ffsr_plan.search.ants.local_search_kernels import improve, path_cost

# What `run_cycles` returns with
DONE, PROVE = 0, 1
# Slots of `counters`: cycles done, cycles since the restart's best got better, stage within a cycle
CYCLE, STALE, STAGE = 0, 1, 2
# Slots of `values`: least F, that since the restart, mean F of the walks, level of untouched rows
BEST, SINCE_RESTART, MEAN, LEVEL = 0, 1, 2, 3

_ANTS_AT_ONCE = 64  # that walk together


class State(NamedTuple):
    """State of a colony: m edges a path, n nodes a layer, costs in units of length."""

    edge_costs: Array
    """(n, n), symmetric."""
    node_costs: Array
    """(m + 1, n), infinite where a node may not be entered."""
    open_edges: Flags
    """(m, n, n) edges that ants may choose."""
    status: States
    """(m, n, n) what is proven of each edge."""
    visibility: Array
    """(m, n, n) eta^beta, zero on closed edges."""
    near: IntArray
    """(n, w) displacements that local search tries on chosen ants."""
    wide: IntArray
    """(n, w) those that it tries on the best of a cycle."""
    rho: float
    """Persistence of pheromone."""
    least_pheromone: float
    """Lower bound of tau."""
    improved: int
    """Ants of a cycle that local search improves."""
    patience: float
    """Cycles without improvement before a restart; infinite for none."""
    use_pheromone: bool
    """Whether ants lay and follow pheromone."""
    tau: Array
    """(m, n or 1, n) pheromone on edges, or on the nodes that they lead to."""
    touched: Flags
    """(m, n or 1) rows of tau on which pheromone was laid since the restart."""
    sums: Array
    """(2, m, n, n) sums along the last axis of visibility, and on touched rows of it times tau."""
    sum_cycles: IntArray
    """(m, n) cycle in which a touched row was summed up."""
    paths: IntArray
    """(ants, m + 1)"""
    costs: Array
    """(ants,)"""
    searched: Array
    """Costs of the paths that local search came back with lately."""
    searched_wide: Array
    """The same for the wide search."""
    candidate: IntArray
    """(m + 1,) best path of the cycle, to be proven before it counts."""
    best_path: IntArray
    """(m + 1,)"""
    restart_path: IntArray
    """(m + 1,) best path since the restart."""
    counters: IntArray
    values: Array
    records: Array
    """(cycles, 4) best F, best and mean F of the cycle, number of different walks."""
    walked: IntArray
    """(m, n, n) ants that walked each edge."""
    left: Flags
    """(m, n) whether an ant walked an edge from each node."""
    laid: Array
    """(m, n, n) pheromone laid."""


@kernel
def _walk(rng: np.random.Generator, s: State) -> None:
    """All ants from start to goal, some at a time, layer after layer.

    On a layer no ant waits for another, and all read the same rows. Their numbers are drawn ant by
    ant, so that a walk does not depend on how many walk at a time.
    """
    ants, m = len(s.paths), len(s.visibility)
    draws = np.empty((min(ants, _ANTS_AT_ONCE), m))
    s.costs[:] = 0.0
    for first in range(0, ants, _ANTS_AT_ONCE):
        count = min(_ANTS_AT_ONCE, ants - first)
        for k in range(count):
            for i in range(m):
                draws[k, i] = rng.random()
        _walk_together(s, first, count, draws)


@kernel
def _walk_together(s: State, first: int, count: int, draws: Array) -> None:
    """Walks of `count` ants from `first` on, each row of weights summed up once a cycle at most.

    Where no pheromone was laid since the restart, all edges of a row have the same, and the row's
    weights are those of visibility alone. The draws (count, m) are compared with the sums of all
    ants' rows in turn, by halving, which the processor does for some ants at a time.
    """
    m, n, tau, visibility, sums = len(s.visibility), len(s.edge_costs), s.tau, s.visibility, s.sums
    paths, walked, left, touched, costs = s.paths, s.walked, s.left, s.touched, s.costs
    edge_costs, node_costs, sum_cycles = s.edge_costs, s.node_costs, s.sum_cycles
    cycle, by_edge, flat = s.counters[CYCLE], tau.shape[1] > 1, sums.ravel()
    begin, place = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    goal = np.empty(count)
    for i in range(m):
        for k in range(count):
            p = paths[first + k, i]
            row = p if by_edge else 0
            begin[k] = ((np.int64(touched[i, row]) * m + i) * n + p) * n
            if touched[i, row] & (sum_cycles[i, p] != cycle):  # rare: one branch, not two
                total = 0.0
                for head in range(n):
                    total += tau[i, row, head] * visibility[i, p, head]
                    sums[1, i, p, head] = total
                sum_cycles[i, p] = cycle
            goal[k] = draws[k, i] * flat[begin[k] + n - 1]
            place[k] = begin[k] - 1
        length = n  # of what is left of each row; what is sought is the first sum above the goal
        while length > 1:
            half = length // 2
            for k in range(count):
                middle = place[k] + half
                place[k] = middle if flat[np.uint64(middle)] <= goal[k] else place[k]
            length -= half
        for k in range(count):
            tail, chosen = np.uint64(paths[first + k, i]), np.uint64(place[k] + 1 - begin[k])
            paths[first + k, i + 1] = chosen
            walked[i, tail, chosen] += 1
            left[i, tail] = True
            costs[first + k] += edge_costs[tail, chosen] + node_costs[i + 1, chosen]


@kernel
def _among(searched: Array, cost: float) -> bool:
    """Whether a path is, by its cost, one that local search came back with lately."""
    return bool(np.any(np.abs(searched - cost) <= 1e-12 * cost))


@kernel
def _improve(s: State) -> None:
    """Local search on the best walk and on some that went elsewhere, then on the best of all."""
    ants, improved = len(s.paths), s.improved
    order = np.argsort(s.costs)
    different, last = 0, -1.0
    for ant in order:
        different += s.costs[ant] != last
        last = s.costs[ant]
    s.records[s.counters[CYCLE], 3] = different
    if improved == 0:
        return
    for share in range(improved):
        ant = order[share * ants // improved]
        if not _among(s.searched, s.costs[ant]):
            cost = improve(s.paths[ant], s.edge_costs, s.node_costs, s.open_edges, s.near)
            s.costs[ant] = cost
            s.searched[(s.counters[CYCLE] * improved + share) % len(s.searched)] = cost
    leader = np.argmin(s.costs)
    if not _among(s.searched_wide, s.costs[leader]):
        cost = improve(s.paths[leader], s.edge_costs, s.node_costs, s.open_edges, s.wide)
        s.costs[leader] = cost
        s.searched_wide[s.counters[CYCLE] % len(s.searched_wide)] = cost


@kernel
def _reevaluate(s: State) -> None:
    """Cost the paths again after edges were closed; local search on the refused candidate."""
    for ant in range(len(s.paths)):
        refused = np.all(s.paths[ant] == s.candidate)
        s.costs[ant] = path_cost(s.paths[ant], s.edge_costs, s.node_costs, s.open_edges)
        if refused and s.costs[ant] == np.inf and s.improved > 0:
            s.costs[ant] = improve(s.paths[ant], s.edge_costs, s.node_costs, s.open_edges, s.near)


@kernel
def _is_proven(path: IntArray, status: States) -> bool:
    free = 0
    for i in range(len(path) - 1):
        free += status[i, path[i], path[i + 1]] == FREE
    return free == len(path) - 1


@kernel
def _update_pheromone(s: State) -> None:
    """Let tau sink to max(rho tau, least); one path lays 1 - rho, up to 1 in all."""
    rho, least, tau, touched = s.rho, s.least_pheromone, s.tau, s.touched
    for i in range(tau.shape[0]):
        for p in range(tau.shape[1]):
            if touched[i, p]:
                for k in range(tau.shape[2]):
                    tau[i, p, k] = max(rho * tau[i, p, k], least)
    s.values[LEVEL] = max(rho * s.values[LEVEL], least)
    every = 2 if s.counters[STALE] > s.patience / 2 else 5
    chosen = s.restart_path if s.counters[CYCLE] % every == every - 1 else s.candidate
    for i in range(len(chosen) - 1):
        row, head = chosen[i] if s.tau.shape[1] > 1 else 0, chosen[i + 1]
        if not s.touched[i, row]:
            s.tau[i, row] = s.values[LEVEL]
            s.touched[i, row] = True
        s.tau[i, row, head] = min(s.tau[i, row, head] + 1.0 - rho, 1.0)
        s.laid[i, chosen[i], head] += 1.0 - rho


@kernel
def write_untouched_rows(s: State) -> None:
    """Write the level of untouched rows into tau, for readers; the cycles do so late."""
    for i in range(s.tau.shape[0]):
        for p in range(s.tau.shape[1]):
            if not s.touched[i, p]:
                s.tau[i, p] = s.values[LEVEL]


@kernel
def run_cycles(rng: np.random.Generator, until: int, s: State) -> int:
    """Go on until cycle `until` is done, or a path must be proven first.

    Returns:
        DONE, or PROVE with the path in question in `candidate`: certify it, close what was refused
        in `open_edges`, and call again.
    """
    while s.counters[CYCLE] < until:
        if s.counters[STAGE] == 0:
            _walk(rng, s)
            s.values[MEAN] = np.mean(s.costs)
            _improve(s)
            s.counters[STAGE] = 1
        else:
            _reevaluate(s)
        leader = np.argmin(s.costs)
        cost = s.costs[leader]
        if cost < np.inf:
            s.candidate[:] = s.paths[leader]
            if not _is_proven(s.candidate, s.status):
                return PROVE
        s.counters[STAGE] = 0
        s.counters[STALE] += 1
        if cost < s.values[BEST]:
            s.values[BEST] = cost
            s.best_path[:] = s.candidate
        if cost < s.values[SINCE_RESTART] * (1.0 - 1e-12):
            s.values[SINCE_RESTART] = cost
            s.restart_path[:] = s.candidate
            s.counters[STALE] = 0
        if s.use_pheromone and cost < np.inf:
            _update_pheromone(s)
        record = s.records[s.counters[CYCLE]]
        record[0], record[1], record[2] = s.values[BEST], cost, s.values[MEAN]
        s.counters[CYCLE] += 1
        if s.counters[STALE] >= s.patience:
            s.touched[:] = False
            s.values[LEVEL], s.values[SINCE_RESTART] = 1.0, np.inf
            s.counters[STALE] = 0
    return DONE

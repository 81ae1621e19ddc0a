"""The cycles of the max-min ant system, compiled.

State lives in arrays that the caller owns, so that a run can stop where a path has to be proven, and
go on where it stopped.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ffsr_plan.colony.local_search import improve, path_cost
from ffsr_plan.inputs import Array, Flags, IntArray, States

_FREE = 1
# What `run_cycles` returns with
DONE, PROVE = 0, 1
# Slots of `clock`: cycles done, cycles since the last restart without a better path, phase
CYCLE, STALE, PHASE = 0, 1, 2
# Slots of `values`: least F since the restart, mean F of the walks, pheromone of untouched rows
SINCE_RESTART, MEAN, LEVEL = 0, 1, 2


@njit(cache=True, nogil=True)
def _walk(
    rng: np.random.Generator,
    tau: Array,
    touched: Flags,
    visibility: Array,
    untouched_wheels: Array,
    wheels: Array,
    fresh: IntArray,
    stamp: int,
    edge_costs: Array,
    node_costs: Array,
    paths: IntArray,
    costs: Array,
) -> None:
    """All ants from start to goal, each row of weights summed up once a cycle at most.

    Where no pheromone was laid since the restart, all edges of a row have the same, and the row's
    weights are those of visibility alone.
    """
    m, n = visibility.shape[0], visibility.shape[1]
    by_edge = tau.shape[1] > 1
    for ant in range(len(paths)):
        cost = 0.0
        p = paths[ant, 0]
        for i in range(m):
            row = p if by_edge else 0
            wheel = wheels[i, p] if touched[i, row] else untouched_wheels[i, p]
            if touched[i, row] and fresh[i, p] != stamp:
                total = 0.0
                for k in range(n):
                    total += tau[i, row, k] * visibility[i, p, k]
                    wheel[k] = total
                fresh[i, p] = stamp
            spin = rng.random() * wheel[n - 1]
            low, length = 0, n  # the first k whose sum exceeds the spin, without a branch to miss
            while length > 1:
                half = length // 2
                low += half * (wheel[low + half - 1] <= spin)
                length -= half
            paths[ant, i + 1] = low
            cost += edge_costs[p, low] + node_costs[i + 1, low]
            p = low
        costs[ant] = cost


@njit(cache=True, nogil=True)
def _is_proven(path: IntArray, status: States) -> bool:
    for i in range(len(path) - 1):
        if status[i, path[i], path[i + 1]] != _FREE:
            return False
    return True


@njit(cache=True, nogil=True)
def _among(searched: Array, cost: float) -> bool:
    """Whether a walk is, by its cost, a path that local search came back with lately."""
    for known in searched:
        if abs(known - cost) <= 1e-12 * cost:
            return True
    return False


@njit(cache=True, nogil=True)
def _lay(tau: Array, touched: Flags, level: float, path: IntArray, amount: float) -> None:
    by_edge = tau.shape[1] > 1
    for i in range(len(path) - 1):
        row = path[i] if by_edge else 0
        if not touched[i, row]:
            tau[i, row] = level
            touched[i, row] = True
        tau[i, row, path[i + 1]] = min(tau[i, row, path[i + 1]] + amount, 1.0)


@njit(cache=True, nogil=True)
def _evaporate(tau: Array, touched: Flags, rho: float, least: float) -> None:
    for i in range(tau.shape[0]):
        for p in range(tau.shape[1]):
            if touched[i, p]:
                for k in range(tau.shape[2]):
                    tau[i, p, k] = max(rho * tau[i, p, k], least)


@njit(cache=True, nogil=True)
def run_cycles(
    rng: np.random.Generator,
    until: int,
    tau: Array,
    visibility: Array,
    edge_costs: Array,
    node_costs: Array,
    ways: Flags,
    status: States,
    table: IntArray,
    settings: Array,
    untouched_wheels: Array,
    wheels: Array,
    fresh: IntArray,
    touched: Flags,
    paths: IntArray,
    costs: Array,
    searched: Array,
    candidate: IntArray,
    best_path: IntArray,
    restart_path: IntArray,
    best: Array,
    clock: IntArray,
    values: Array,
    records: Array,
    walked: IntArray,
    laid: Array,
) -> int:
    """Go on until cycle `until` is done, or a path must be proven first.

    `settings` holds rho, the least pheromone, how many ants are improved, the stale cycles before a
    restart, and 1 where pheromone is used at all. `records` (cycles, 4) receives best F, best and
    mean F of the cycle, number of different walks.

    Returns:
        DONE, or PROVE with the path in question in `candidate`: certify it, close what was refused
        in `ways`, and call again.
    """
    rho, least, improved, patience = settings[0], settings[1], int(settings[2]), settings[3]
    with_pheromone = settings[4] > 0.0
    ants, m = len(paths), len(ways)
    while clock[CYCLE] < until:
        if clock[PHASE] == 0:
            _walk(
                rng, tau, touched, visibility, untouched_wheels, wheels, fresh, clock[CYCLE],
                edge_costs, node_costs, paths, costs,
            )  # fmt: skip
            for ant in range(ants):
                for i in range(m):
                    walked[i, paths[ant, i], paths[ant, i + 1]] += 1
            values[MEAN] = np.mean(costs)
            order = np.argsort(costs)
            different, last = 0, -1.0
            for ant in order:
                cost = costs[ant]
                if cost != last:  # else it is the same walk again
                    last = cost
                    different += 1
                    if different <= improved and not _among(searched, cost):
                        costs[ant] = improve(paths[ant], edge_costs, node_costs, ways, table)
                        slot = (clock[CYCLE] * improved + different) % len(searched)
                        searched[slot] = costs[ant]
            records[clock[CYCLE], 3] = different
            clock[PHASE] = 1
        else:  # edges have been refused or proven since
            for ant in range(ants):
                costs[ant] = path_cost(paths[ant], edge_costs, node_costs, ways)
            if path_cost(candidate, edge_costs, node_costs, ways) == np.inf and improved > 0:
                ant = 0
                for other in range(ants):  # the path in question: mend it within its corridor
                    if np.all(paths[other] == candidate):
                        ant = other
                costs[ant] = improve(paths[ant], edge_costs, node_costs, ways, table)
        leader = np.argmin(costs)
        cost = costs[leader]
        if cost < np.inf:
            candidate[:] = paths[leader]
            if not _is_proven(candidate, status):
                return PROVE
        clock[PHASE] = 0
        if cost < best[0]:
            best[0] = cost
            best_path[:] = candidate
        clock[STALE] += 1
        if cost < values[SINCE_RESTART] * (1.0 - 1e-12):
            values[SINCE_RESTART] = cost
            restart_path[:] = candidate
            clock[STALE] = 0
        if with_pheromone and cost < np.inf:
            _evaporate(tau, touched, rho, least)
            values[LEVEL] = max(rho * values[LEVEL], least)
            every = 2 if clock[STALE] > patience / 2 else 5
            chosen = restart_path if clock[CYCLE] % every == every - 1 else candidate
            _lay(tau, touched, values[LEVEL], chosen, 1.0 - rho)
            for i in range(m):
                laid[i, chosen[i], chosen[i + 1]] += 1.0 - rho
        records[clock[CYCLE], 0] = best[0]
        records[clock[CYCLE], 1] = cost
        records[clock[CYCLE], 2] = values[MEAN]
        clock[CYCLE] += 1
        if clock[STALE] >= patience:
            touched[:] = False
            values[LEVEL] = 1.0
            values[SINCE_RESTART] = np.inf
            clock[STALE] = 0
    return DONE

"""Ants among base offsets and postures, and the annealing of what they find; compiled."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ffsr_plan.colony.posture_cost import (
    Ground,
    clearance_at,
    edge_length,
    node_cost,
    path_cost,
)
from ffsr_plan.inputs import Array, IntArray


@njit(cache=True, nogil=True)
def cost_to_go(ground: Ground, nominal: Array) -> Array:
    """(m + 1, b, n) least cost [m] from each node to the goal, every layer at one attitude.

    Args:
        ground: the lattice.
        nominal: (m + 1, 4) the attitudes.
    """
    m, count = len(ground.turns), len(ground.successors)
    offsets, steps = len(ground.across), ground.successors.shape[1]
    frame, shift = np.empty(15), np.zeros(3)
    ahead = np.full((m + 1, offsets, count), np.inf)
    own = np.empty((offsets, count))
    for i in range(m, -1, -1):
        for b in range(offsets):
            for p in range(count):
                if i == m:
                    goal = ground.origin[0] == b and ground.origin[1] == p
                    ahead[m, b, p] = 0.0 if goal else np.inf
                    continue
                if not ground.allowed[i, p]:
                    continue
                for step in range(steps):
                    on = ground.successors[p, step]
                    if on < 0:
                        continue
                    for b_on in range(offsets):
                        rest = ahead[i + 1, b_on, on] + own[b_on, on]
                        if rest < ahead[i, b, p]:
                            total = rest + edge_length(ground, i, b, p, b_on, step)
                            ahead[i, b, p] = min(ahead[i, b, p], total)
        if i > 0:
            for b in range(offsets):
                for p in range(count):
                    if ahead[i, b, p] < np.inf:
                        clearance = clearance_at(ground, i, b, p, nominal[i], frame, shift)
                        own[b, p] = node_cost(ground, clearance, i < m)
                    else:
                        own[b, p] = 0.0
    return ahead


@njit(cache=True, nogil=True)
def walk(
    ground: Ground,
    rng: np.random.Generator,
    ahead: Array,
    keen: float,
    tau_offset: Array,
    tau_posture: Array,
    offsets: IntArray,
    postures: IntArray,
) -> bool:
    """One ant's path from start to goal; whether it got there.

    A step is chosen with probability tau exp(-(length + cost to go from there) / keen): what a step
    costs more than the best one weighs, not how long it is.

    Args:
        ground: the lattice.
        rng: source of randomness.
        ahead: (m + 1, b, n) of `cost_to_go`.
        keen: [m].
        tau_offset: (m, b, b) pheromone of each change of the base offset.
        tau_posture: (m, n, k) pheromone of each posture step.
        offsets: (m + 1,) the path, filled in.
        postures: (m + 1,) the path, filled in.
    """
    m, steps, count = len(ground.turns), ground.successors.shape[1], len(ground.across)
    wheel = np.empty(steps * count)
    offsets[0], postures[0] = ground.origin[0], ground.origin[1]
    for i in range(m):
        b, p = offsets[i], postures[i]
        least = ahead[i, b, p]
        total = 0.0
        for step in range(steps):
            on = ground.successors[p, step]
            for b_on in range(count):
                weight = 0.0
                if on >= 0 and ahead[i + 1, b_on, on] < np.inf:
                    cost = edge_length(ground, i, b, p, b_on, step) + ahead[i + 1, b_on, on]
                    weight = math.exp(-min(max(cost - least, 0.0) / keen, 500.0))
                    weight *= tau_offset[i, b, b_on] * tau_posture[i, p, step]
                total += weight
                wheel[step * count + b_on] = total
        if total <= 0.0:
            return False
        chosen = int(np.searchsorted(wheel, rng.random() * total, side="right"))
        chosen = min(chosen, len(wheel) - 1)
        offsets[i + 1], postures[i + 1] = chosen % count, ground.successors[p, chosen // count]
    return True


@njit(cache=True, nogil=True)
def deposit(
    amount: float, offsets: IntArray, steps: IntArray, postures: IntArray, tau: Array, tau_p: Array
) -> None:
    """Lay pheromone along a path whose posture steps are `steps` (m,)."""
    for i in range(len(steps)):
        tau[i, offsets[i], offsets[i + 1]] += amount
        tau_p[i, postures[i], steps[i]] += amount


@njit(cache=True, nogil=True)
def anneal(
    ground: Ground,
    rng: np.random.Generator,
    offsets: IntArray,
    postures: IntArray,
    iterations: int,
    hot: float,
    cold: float,
    weights: Array,
    best_offsets: IntArray,
    best_postures: IntArray,
) -> float:
    """Shift whole segments of a path by one, along an axis or in time, as the temperature falls.

    Args:
        ground: the lattice.
        rng: source of randomness.
        offsets: (m + 1,) the path, updated.
        postures: (m + 1,) the path, updated.
        iterations: shifts to try.
        hot: temperature at the beginning [m].
        cold: at the end [m].
        weights: (2,) of a radian by which the goal attitude is missed [m]: at the beginning, and
            from half of the iterations on, by which the best path is judged.
        best_offsets: (m + 1,) the best path, filled in.
        best_postures: (m + 1,) the best path, filled in.

    Returns:
        The cost of the best path [m].
    """
    m, axes, beside = len(offsets) - 1, ground.indices.shape[1], ground.neighbours.shape[1]
    middle = 0
    for _ in range(axes):
        middle = 3 * middle + 1
    quats, costs = np.empty((m + 1, 4)), np.zeros(m + 1)
    quats[0] = ground.start
    trial_quats, trial_costs = quats.copy(), costs.copy()
    new_offsets, new_postures = offsets.copy(), postures.copy()
    weight = weights[0]
    now = path_cost(ground, offsets, postures, 0, quats, costs, weight, np.inf)
    best = path_cost(ground, offsets, postures, 0, quats, costs, weights[1], np.inf)
    best_offsets[:], best_postures[:] = offsets, postures
    for n in range(iterations):
        done = n / iterations
        heat = hot * (cold / hot) ** done
        if n % 64 == 0:
            weight = weights[0] * (weights[1] / weights[0]) ** min(1.0, 2.0 * done)
            now = path_cost(ground, offsets, postures, 0, quats, costs, weight, np.inf)
        length = int(math.exp(rng.random() * math.log(m)))
        first = 1 + int(rng.random() * (m - 1))
        last = min(first + length, m)
        kind = int(rng.random() * (2 * axes + beside + 2))
        new_offsets[:], new_postures[:] = offsets, postures
        possible = True
        if kind < 2 * axes:
            power = 1
            for _ in range(kind // 2):
                power *= 3
            step = middle + power if kind % 2 else middle - power
            for i in range(first, last):
                new_postures[i] = ground.successors[postures[i], step]
                possible &= new_postures[i] >= 0
        elif kind < 2 * axes + beside:
            for i in range(first, last):
                new_offsets[i] = ground.neighbours[offsets[i], kind - 2 * axes]
                possible &= new_offsets[i] >= 0
        else:  # a layer later or earlier: room for a step here is taken from there
            when = -1 if kind == 2 * axes + beside else 1
            for i in range(first, last):
                new_offsets[i], new_postures[i] = offsets[i + when], postures[i + when]
        if not possible:
            continue
        limit = now - heat * math.log(1.0 - rng.random())
        trial_quats[first - 1], trial_costs[first - 1] = quats[first - 1], costs[first - 1]
        cost = path_cost(
            ground, new_offsets, new_postures, first - 1, trial_quats, trial_costs, weight, limit
        )
        if cost < np.inf:
            now = cost
            offsets[:], postures[:] = new_offsets, new_postures
            quats[first:], costs[first:] = trial_quats[first:], trial_costs[first:]
            if done >= 0.5 and cost < best:
                best = cost
                best_offsets[:], best_postures[:] = offsets, postures
    return best

"""Compiled shortest path through random states around a path, of which edges are flown when needed.

Layers lie across the path at equal steps of its length; lane 0 holds the path itself, the others
are displaced smoothly along it, by more or less, with some scatter. The shortest path through all
layers is flown from the start at the true attitudes; an edge that is not clear is barred, until the
shortest path is clear or no better than the one that is known.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.flight import distance, fly
from ffsr_plan.tree_search.kernels.path_cost import STATIONS, clearance_at, path_cost
from ffsr_plan.tree_search.kernels.path_moves import (
    PathMemory,
    edge_at,
    measure,
    point_at,
    take_over,
)
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, normal, uniform
from ffsr_plan.tree_search.kernels.search_arrays import SearchArrays

LAYERS, LANES = 16, 24
NONE, GOING_ON = -1, -2
"""What `search_layers` returns without a path: there is none, or it may go on."""
_LEAST, _LARGEST = 0.03, 0.8  # displacement of a lane
_SCATTER = 0.3  # share of it that is drawn for each state
_LEAST_WEIGHT = 0.2
_GAIN = 1e-9  # [m] by which a path has to be better
_NEAREST = 1e-9  # [m] that a clearance counts at least
_ATTEMPTS = 400  # paths that are flown


class Layers(NamedTuple):
    """Layers around a path, and what is known of the edges between them.

    Attributes:
        states: (LAYERS + 2, LANES, D), lane 0 on the path.
        steps: (LAYERS + 1, LANES, LANES) cost of each edge [m].
        barred: of the same shape: edges that are not clear.
        lanes: (LAYERS + 2,) the shortest path.
        flown: (LAYERS + 2,) lanes of the path as far as it has been flown, -1 behind.
        attempts: (1,) paths flown so far.
    """

    states: Array
    steps: Array
    barred: Flags
    lanes: IntArray
    flown: IntArray
    attempts: IntArray


@kernel
def lay_out(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, layers: Layers
) -> None:
    """Lay layers of random states around a path.

    Args:
        space: robot, scene and settings.
        memory: the path, with room for LAYERS + 2 corners of a changed one.
        last: its last corner.
        random: (1,) state of the random numbers.
        layers: filled in.
    """
    fill_layers(space, memory, last, random, layers.states)
    layers.steps[:] = edge_costs(space, memory, last, layers.states)
    layers.barred[:] = False
    layers.flown[:] = -1
    layers.attempts[0] = 0
    memory.states[1, 0] = layers.states[0, 0]
    memory.attitudes[1, 0] = memory.attitudes[0, 0]


@kernel
def search_layers(
    space: SearchArrays, memory: PathMemory, layers: Layers, cost: float, checks: int
) -> int:
    """Replace the path by a better one through the layers around it, if one is found.

    Args:
        space: robot, scene and settings.
        memory: the path, which may be changed; nothing else has been done with it since the layers
            were laid out.
        layers: the layers.
        cost: cost that the new path has to fall below [m]; infinite where the path is not clear.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The last corner of the new path, or NONE or GOING_ON.
    """
    states, steps, barred, lanes, flown, attempts = layers
    corners, attitudes = memory.states[1], memory.attitudes[1]
    while attempts[0] < _ATTEMPTS:
        if space.setup[0].checks >= checks:
            return GOING_ON
        if shortest(steps, barred, lanes) >= cost - _GAIN:
            return NONE
        attempts[0] += 1
        layer = 0
        while layer <= LAYERS and flown[layer + 1] == lanes[layer + 1]:
            layer += 1
        while layer <= LAYERS:
            corners[layer + 1] = states[layer + 1, lanes[layer + 1]]
            share = fly(
                space, corners[layer], attitudes[layer], corners[layer + 1], attitudes[layer + 1],
                True,
            )  # fmt: skip
            if share < 1.0:
                barred[layer, lanes[layer], lanes[layer + 1]] = True
                flown[layer + 1 :] = -1
                break
            flown[layer + 1] = lanes[layer + 1]
            layer += 1
        if layer > LAYERS:
            if path_cost(space, corners, attitudes, LAYERS + 1) >= cost - _GAIN:
                return NONE
            return take_over(space, memory, LAYERS + 1)
    return NONE


@kernel
def fill_layers(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, states: Array
) -> None:
    """States (LAYERS + 2, LANES, D) around the path; the first and the last layer are its ends."""
    whole, count = measure(space, memory, last), states.shape[2]
    for layer in range(LAYERS + 2):
        place = whole * layer / (LAYERS + 1)
        point_at(memory, edge_at(memory.passed, last, place), place, states[layer, 0])
    states[0, 0] = memory.states[0, 0]
    states[LAYERS + 1, 0] = memory.states[0, last]
    waves = np.empty((2, count))
    for lane in range(1, LANES):
        size = _LEAST * math.exp(math.log(_LARGEST / _LEAST) * uniform(random))
        for k in range(count):
            waves[0, k], waves[1, k] = normal(random), normal(random)
        for layer in range(LAYERS + 2):
            states[layer, lane] = states[layer, 0]
            angle = math.pi * layer / (LAYERS + 1)
            if layer in (0, LAYERS + 1):
                continue
            for k in range(count):
                low, high = space.box[0, k], space.box[1, k]
                if low >= high:
                    continue
                wave = waves[0, k] * math.sin(angle) + waves[1, k] * math.sin(2.0 * angle)
                step = size * (wave + _SCATTER * normal(random))
                step /= max(space.weights[0, k], _LEAST_WEIGHT) * math.sqrt(count)
                states[layer, lane, k] = min(max(states[layer, 0, k] + step, low), high)


@kernel
def edge_costs(space: SearchArrays, memory: PathMemory, last: int, states: Array) -> Array:
    """(LAYERS + 1, LANES, LANES) cost of each edge: its length, and the nearness of its end.

    The clearance at a state is taken at the attitude of the nearest corner before it on the path.
    """
    weights, setup = space.weights, space.setup[0]
    steps = np.empty((LAYERS + 1, LANES, LANES))
    counts = setup.nearness_weight > 0.0 and len(space.tree.order) > 0
    share = setup.nearness_weight * STATIONS / LAYERS
    for layer in range(LAYERS + 1):
        tails = 1 if layer == 0 else LANES
        heads = 1 if layer == LAYERS else LANES
        for head in range(heads):
            near = 0.0
            if counts and layer < LAYERS:
                place = memory.passed[last] * (layer + 1) / (LAYERS + 1)
                corner = edge_at(memory.passed, last, place)
                state = states[layer + 1, head]
                near = share / max(
                    clearance_at(space, state, memory.attitudes[0, corner]), _NEAREST
                )
            for tail in range(tails):
                length = distance(weights, 1, states[layer, tail], states[layer + 1, head])
                steps[layer, tail, head] = length + near
    return steps


@kernel
def shortest(steps: Array, barred: Flags, lanes: IntArray) -> float:
    """Cost of the shortest path through all layers, by dynamic programming; infinite without one.

    Args:
        steps: (LAYERS + 1, LANES, LANES) cost of each edge.
        barred: of the same shape.
        lanes: (LAYERS + 2,) filled in: the lane on each layer.
    """
    rest = np.zeros((LAYERS + 2, LANES))
    on = np.zeros((LAYERS + 1, LANES), np.int64)
    for layer in range(LAYERS, -1, -1):
        tails = 1 if layer == 0 else LANES
        heads = 1 if layer == LAYERS else LANES
        for tail in range(tails):
            best = math.inf
            for head in range(heads):
                cost = steps[layer, tail, head] + rest[layer + 1, head]
                if cost < best and not barred[layer, tail, head]:
                    best = cost
                    on[layer, tail] = head
            rest[layer, tail] = best
    lanes[0] = 0
    for layer in range(LAYERS + 1):
        lanes[layer + 1] = on[layer, lanes[layer]]
    return rest[0, 0]

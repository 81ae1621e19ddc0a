"""Compiled closed loops of the joints, which turn a base that reacts and change nothing else.

A loop leaves a corner of the path by two joint displacements and comes back: a, a + b, b, 0.
It turns the base by about the area between them. Of random loops those are kept that lower the cost
of the path, in which the angle by which it misses the attitude to arrive at weighs much.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.quaternions import angle_of
from ffsr_plan.tree_search.kernels.flight import fly, fly_path, path_length
from ffsr_plan.tree_search.kernels.path_cost import SLACK, path_cost
from ffsr_plan.tree_search.kernels.path_moves import PathMemory, take_over
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, below, normal, uniform
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, SearchArrays

ENOUGH = 0.01
"""Error of the attitude that no loop has to correct: small changes of all joints do [rad]."""
LOOP_CORNERS = 5
"""Corners that a path needs room for before a loop is inserted."""
_TRIES = 24  # loops of which the best is kept
_LEAST, _LARGEST = 0.2, 1.5  # [rad or m] of a displacement
_GAIN = 1e-9  # [m] by which a path has to be better


@kernel
def insert_loops(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, checks: int
) -> int:
    """Insert the best of some loops again and again, until the attitude is nearly met.

    Args:
        space: robot, scene and settings, with the attitude to arrive at.
        memory: the path, flown, which is changed.
        last: its last corner.
        random: (1,) state of the random numbers.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The last corner of the new path.
    """
    setup, count = space.setup[0], memory.states.shape[2]
    cost = path_cost(space, memory.states[0], memory.attitudes[0], last)
    sides, best = np.zeros((2, count)), np.zeros((2, count))
    while setup.checks < checks and last + LOOP_CORNERS < memory.states.shape[1]:
        if angle_of(memory.attitudes[0, last], setup.goal) < ENOUGH:
            break
        least, place = cost - _GAIN, -1
        for _ in range(_TRIES):
            corner = below(random, last + 1)
            draw_sides(sides, random)
            new = loop_cost(space, memory, last, corner, sides, least)
            if new < least:
                least, place = new, corner
                best[:] = sides
        if place >= 0:
            lay_loop(space, memory, last, place, best)
            fly_path(space, memory.states[1], memory.attitudes[1], place, last + 4)
            last = take_over(space, memory, last + 4)
            cost = path_cost(space, memory.states[0], memory.attitudes[0], last)
    return last


@kernel
def draw_sides(sides: Array, random: RandomState) -> None:
    """Two random displacements (2, D) of some joints."""
    for side in range(2):
        size = _LEAST + (_LARGEST - _LEAST) * uniform(random)
        for k in range(JOINTS, sides.shape[1]):
            moves = uniform(random) < 0.5
            sides[side, k] = size * normal(random) if moves else 0.0


@kernel
def lay_loop(space: SearchArrays, memory: PathMemory, last: int, corner: int, sides: Array) -> None:
    """The path with a loop at a corner becomes the changed path, not flown behind the corner."""
    old, new = memory.states
    new[: corner + 1] = old[: corner + 1]
    new[corner + 4 : last + 5] = old[corner : last + 1]
    memory.attitudes[1, : corner + 1] = memory.attitudes[0, : corner + 1]
    for k in range(old.shape[1]):
        low, high, begin = space.box[0, k], space.box[1, k], old[corner, k]
        first, second = sides[0, k], sides[1, k]
        if k < JOINTS:
            low, high = begin, begin
        new[corner + 1, k] = min(max(begin + first, low), high)
        new[corner + 2, k] = min(max(begin + first + second, low), high)
        new[corner + 3, k] = min(max(begin + second, low), high)


@kernel
def loop_cost(
    space: SearchArrays, memory: PathMemory, last: int, corner: int, sides: Array, least: float
) -> float:
    """Cost of the path with a loop at a corner if it is clear and below `least`, else infinity.

    The attitude is worked out first without looking at obstacles, which takes less time.
    """
    lay_loop(space, memory, last, corner, sides)
    setup, states, attitudes = space.setup[0], memory.states[1], memory.attitudes[1]
    setup.checks += 1
    length = path_length(space.weights, states, last + 4)
    if length >= least:
        return math.inf
    for k in range(corner, last + 4):
        fly(space, states[k], attitudes[k], states[k + 1], attitudes[k + 1], False)
        setup.checks += 1
    missed = max(0.0, angle_of(attitudes[last + 4], setup.goal) - SLACK)
    if length + setup.missed_weight * missed >= least:
        return math.inf
    if fly_path(space, states, attitudes, corner, last + 4) < last + 4:
        return math.inf
    return path_cost(space, states, attitudes, last + 4)

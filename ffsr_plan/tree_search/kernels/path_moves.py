"""Compiled improvement of a path by random moves; whatever comes behind a move is flown again.

Shortcuts join two points of the path, in all coordinates or in some of them; corners are moved,
left out, and put into long edges. A move is kept if the path is still clear and costs less.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.flight import distance, fly_path, path_length
from ffsr_plan.tree_search.kernels.path_cost import path_cost
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, below, normal, uniform
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, SearchArrays

_SHORTCUTS, _CORNERS, _DROPS = 0.35, 0.80, 0.95  # cumulated shares of the kinds of moves
_WHOLE, _OF_BASE, _OF_ONE_JOINT = 0.4, 0.55, 0.8  # cumulated shares of coordinates of a shortcut
_MOST_SPLIT = 40  # corners up to which edges are split
_GAIN = 1e-9  # [m] by which a path has to be better
_SAME = 1e-9  # distance of corners that are one
_SAME_ATTITUDE = 1e-7  # difference of quaternions behind which the way has been flown already
_LEAST_WEIGHT = 0.2  # by which steps of a corner are divided at least


class PathMemory(NamedTuple):
    """A path and room for a changed one.

    Attributes:
        states: (2, N, D) corners of the path, and of the changed one.
        attitudes: (2, N, 4) there.
        passed: (N,) length up to each corner of the path.
    """

    states: Array
    attitudes: Array
    passed: Array


class Change(NamedTuple):
    """What a move has changed.

    Attributes:
        last: the last corner of the changed path; -1 if there is no change.
        first: corner of both paths up to which nothing has changed.
        tail: corner of the changed path from which on nothing has changed.
    """

    last: int
    first: int
    tail: int


@kernel
def improve(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, spread: float,
    checks: int,
) -> int:  # fmt: skip
    """Try moves until so many configurations have been checked.

    Args:
        space: robot, scene and settings.
        memory: the path, flown, which is changed.
        last: its last corner.
        random: (1,) state of the random numbers.
        spread: size of the largest moves of a corner.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The last corner of the new path.
    """
    setup = space.setup[0]
    cost = path_cost(space, memory.states[0], memory.attitudes[0], last)
    while setup.checks < checks and last > 0:
        setup.checks += 1
        kind = uniform(random)
        if kind < _SHORTCUTS:
            change = shortcut(space, memory, last, random)
        elif kind < _CORNERS:
            change = move_corner(space, memory, last, random, spread)
        elif kind < _DROPS:
            change = drop_corner(memory, last, random)
        else:
            last = split_longest(space, memory, last)
            continue
        if change.last < 0:
            continue
        new = try_change(space, memory, change, last, cost)
        if new < cost:
            cost = new
            last = take_over(space, memory, change.last)
    return last


@kernel
def try_change(
    space: SearchArrays, memory: PathMemory, change: Change, last: int, cost: float
) -> float:
    """The cost of the changed path if it is clear and costs less, otherwise infinity."""
    setup, states, attitudes = space.setup[0], memory.states[1], memory.attitudes[1]
    length = path_length(space.weights, states, change.last)
    if setup.missed_weight == 0.0 and length >= cost - _GAIN:
        return math.inf
    attitudes[: change.first + 1] = memory.attitudes[0, : change.first + 1]
    if fly_path(space, states, attitudes, change.first, change.tail) < change.tail:
        return math.inf
    behind = last - (change.last - change.tail)
    same = True
    for a in range(4):
        apart = abs(attitudes[change.tail, a] - memory.attitudes[0, behind, a])
        same = same and apart < _SAME_ATTITUDE
    if same:
        attitudes[change.tail + 1 : change.last + 1] = memory.attitudes[0, behind + 1 : last + 1]
    elif fly_path(space, states, attitudes, change.tail, change.last) < change.last:
        return math.inf
    new = path_cost(space, states, attitudes, change.last)
    return new if new < cost - _GAIN else math.inf


@kernel
def take_over(space: SearchArrays, memory: PathMemory, last: int) -> int:
    """The changed path becomes the path, without doubled corners; its last corner."""
    kept = 0
    states, attitudes = memory.states, memory.attitudes
    for k in range(last + 1):
        doubled = k > 0 and distance(space.weights, 0, states[1, k], states[0, kept - 1]) < _SAME
        if doubled and k < last:
            continue
        states[0, kept] = states[1, k]
        attitudes[0, kept] = attitudes[1, k]
        kept += 1
    return kept - 1


@kernel
def measure(space: SearchArrays, memory: PathMemory, last: int) -> float:
    """Fill in the length up to each corner, by distances of the search; the whole."""
    memory.passed[0] = 0.0
    for k in range(last):
        step = distance(space.weights, 0, memory.states[0, k], memory.states[0, k + 1])
        memory.passed[k + 1] = memory.passed[k] + step
    return memory.passed[last]


@kernel
def edge_at(passed: Array, last: int, place: float) -> int:
    """The edge that holds a place on the path."""
    edge = 0
    while edge < last - 1 and passed[edge + 1] < place:
        edge += 1
    return edge


@kernel
def point_at(memory: PathMemory, edge: int, place: float, point: Array) -> None:
    """The state at a place of the path on an edge; `point` (D,) is filled in."""
    passed, states = memory.passed, memory.states[0]
    length = passed[edge + 1] - passed[edge]
    share = 0.0 if length == 0.0 else (place - passed[edge]) / length
    for k in range(len(point)):
        point[k] = states[edge, k] + share * (states[edge + 1, k] - states[edge, k])


@kernel
def shortcut(space: SearchArrays, memory: PathMemory, last: int, random: RandomState) -> Change:
    """Go straight between two points of the path, in all or in some of the coordinates."""
    whole = measure(space, memory, last)
    one, two = uniform(random) * whole, uniform(random) * whole
    begin, end = min(one, two), max(one, two)
    i, j = edge_at(memory.passed, last, begin), edge_at(memory.passed, last, end)
    if i == j or last + 4 > memory.states.shape[1]:
        return Change(-1, 0, 0)
    old, new = memory.states
    new[: i + 1] = old[: i + 1]
    first = i + 1
    point_at(memory, i, begin, new[first])
    kind, joint = uniform(random), JOINTS + below(random, max(old.shape[1] - JOINTS, 1))
    if kind < _WHOLE or old.shape[1] == JOINTS:
        second = first + 1
        point_at(memory, j, end, new[second])
    else:
        second = first + 1 + j - i
        point_at(memory, j, end, new[second])
        new[first + 1 : second] = old[i + 1 : j + 1]
        for k in range(old.shape[1]):
            straight = k < JOINTS if kind < _OF_BASE else k == joint
            if kind >= _OF_ONE_JOINT:
                straight = uniform(random) < 0.5
            if straight:
                for row in range(first + 1, second):
                    share = (memory.passed[i + row - first] - begin) / max(end - begin, _SAME)
                    new[row, k] = new[first, k] + share * (new[second, k] - new[first, k])
    tail = second + 1
    new[tail : tail + last - j] = old[j + 1 : last + 1]
    return Change(tail + last - j - 1, i, tail)


@kernel
def move_corner(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, spread: float
) -> Change:
    """Move a corner at random, as a rule towards the line between its neighbours as well."""
    if last < 2:
        return Change(-1, 0, 0)
    old, new = memory.states
    corner = 1 + below(random, last - 1)
    new[: last + 1] = old[: last + 1]
    all_of_them, pulled = uniform(random) < 0.5, uniform(random) < 0.7
    pull = 0.7 * uniform(random) if pulled else 0.0
    size = spread * math.exp(-4.0 * uniform(random))
    before = distance(space.weights, 0, old[corner], old[corner - 1])
    behind = distance(space.weights, 0, old[corner], old[corner + 1])
    share = before / max(before + behind, _SAME)
    for k in range(old.shape[1]):
        low, high = space.box[0, k], space.box[1, k]
        if low < high and (all_of_them or uniform(random) < 0.4):
            line = old[corner - 1, k] + share * (old[corner + 1, k] - old[corner - 1, k])
            weight = max(space.weights[0, k], _LEAST_WEIGHT)
            value = old[corner, k] + pull * (line - old[corner, k])
            new[corner, k] = min(max(value + size * normal(random) / weight, low), high)
    return Change(last, corner - 1, corner + 1)


@kernel
def drop_corner(memory: PathMemory, last: int, random: RandomState) -> Change:
    """Leave out a corner."""
    if last < 2:
        return Change(-1, 0, 0)
    return without_corner(memory, last, 1 + below(random, last - 1))


@kernel
def without_corner(memory: PathMemory, last: int, corner: int) -> Change:
    """Leave out one corner, which is neither the first nor the last."""
    old, new = memory.states
    new[:corner] = old[:corner]
    new[corner:last] = old[corner + 1 : last + 1]
    return Change(last - 1, corner - 1, corner)


@kernel
def split_longest(space: SearchArrays, memory: PathMemory, last: int) -> int:
    """Put a corner into the middle of the longest edge, if there are few; the new last corner."""
    if last + 2 > min(memory.states.shape[1], _MOST_SPLIT):
        return last
    measure(space, memory, last)
    states, attitudes = memory.states[0], memory.attitudes[0]
    edge = int(np.argmax(np.diff(memory.passed[: last + 1])))
    for k in range(last, edge, -1):
        states[k + 1] = states[k]
        attitudes[k + 1] = attitudes[k]
    for k in range(states.shape[1]):
        states[edge + 1, k] = 0.5 * (states[edge, k] + states[edge + 2, k])
    fly_path(space, states, attitudes, edge, edge + 1)
    return last + 1


@kernel
def thin(space: SearchArrays, memory: PathMemory, last: int, tried: IntArray, checks: int) -> int:
    """Leave out corners, those nearest to the line between their neighbours first.

    The path stays clear and costs no more.

    Args:
        space: robot, scene and settings.
        memory: the path, flown, which is changed.
        last: its last corner.
        tried: (1,) corners that cannot be left out, counted in their order; 0 for a path that has
            changed, changed, and -1 when all have been tried.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The last corner of the new path.
    """
    cost = path_cost(space, memory.states[0], memory.attitudes[0], last) + 2.0 * _GAIN
    detours = np.empty(memory.states.shape[1])
    while last > 1:
        count = 0
        states = memory.states[0]
        for k in range(1, last):
            detours[k] = (
                distance(space.weights, 0, states[k - 1], states[k])
                + distance(space.weights, 0, states[k], states[k + 1])
                - distance(space.weights, 0, states[k - 1], states[k + 1])
            )
        order = np.argsort(detours[1:last])
        for row in range(tried[0], len(order)):
            if space.setup[0].checks >= checks:
                tried[0] = row
                return last
            change = without_corner(memory, last, 1 + order[row])
            new = try_change(space, memory, change, last, cost)
            if new < cost:
                last = take_over(space, memory, change.last)
                tried[0] = 0
                count += 1
                break
        if count == 0:
            break
    tried[0] = -1
    return last

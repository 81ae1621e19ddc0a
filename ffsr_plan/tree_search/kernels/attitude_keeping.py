"""Compiled straightening of a path that has to arrive at an attitude.

Among all corners of a part of the path, with its ends held, the sum of squared steps, each divided
by its present length, is least on the straight line. The attitude on arrival depends on the corners
too, by a linear map J about the path at hand. The corners that are moved towards the straight line,
but not at the cost of the attitude, solve

    minimise  1/2 dx' A dx - a b' dx   subject to   J dx = e,

with A the matrix of that sum, b its slope and e the rotation that is missed: dx = a (line - x) +
A^-1 J' l with (J A^-1 J') l = e - a J (line - x). A loop of the joints so becomes as short as its
surroundings allow. What is kept is clear and costs less, as with all other changes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.quaternions import angle_of, fill_rotation_vector
from ffsr_plan.tree_search.kernels.flight import distance, fly, fly_path, path_length
from ffsr_plan.tree_search.kernels.path_cost import SLACK, path_cost
from ffsr_plan.tree_search.kernels.path_moves import PathMemory, split_longest, take_over
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, below, normal, uniform
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, SearchArrays

_DIFFERENCE = 1e-4  # of the finite differences [rad or m]
_WHOLE = 0.3  # share of the parts that are the whole path
_ROUNDS = 4  # of corrections of the attitude in a step
_TRIES = 10  # steps for each J
_BENT = 0.5  # share of the steps that are displaced at random
_LARGEST = 0.3  # of these displacements
_LEAST_EDGE = 1e-3  # length that an edge counts at least
_LEAST_WEIGHT = 1e-3  # of a coordinate without length
_REGULAR = 1e-9  # of the largest entry of J A^-1 J', added to its diagonal
_NOTHING = 1e-30  # added as well, for a part whose corners are all held
_GAIN = 1e-9  # [m] by which a path has to be better


class Part(NamedTuple):
    """A part of a path about which everything is linear.

    Attributes:
        first: its first corner.
        last: its last corner.
        held: (N,) corners that stay where they are: both ends, and those at obstacles.
        slopes: (N, D, 3) J: rotation on arrival, world axes, for each unit of a coordinate.
        answers: (N, D, 3) A^-1 J'.
        line: (N, D) from the corners to the straight lines between corners that are held.
        inner: (3, 3) J A^-1 J'.
    """

    first: int
    last: int
    held: Flags
    slopes: Array
    answers: Array
    line: Array
    inner: Array


class Change(NamedTuple):
    """What came of a change.

    Attributes:
        cost: of the changed path if it is clear and costs less, otherwise infinity [m].
        hit: corner before the edge that is not clear, or -1.
    """

    cost: float
    hit: int


@kernel
def straighten(
    space: SearchArrays, memory: PathMemory, last: int, random: RandomState, checks: int
) -> int:
    """Straighten parts of the path, until so many configurations have been checked.

    Args:
        space: robot, scene and settings, with the attitude to arrive at.
        memory: the path, flown, which is changed.
        last: its last corner.
        random: (1,) state of the random numbers.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The last corner of the new path.
    """
    setup, shape = space.setup[0], memory.states.shape
    split = split_longest(space, memory, last)
    while split > last:
        last = split
        split = split_longest(space, memory, last)
    slopes, answers = np.empty((shape[1], shape[2], 3)), np.empty((shape[1], shape[2], 3))
    line, inner, bend = np.empty(shape[1:]), np.empty((3, 3)), np.empty(shape[1:])
    held = np.empty(shape[1], dtype=np.bool_)
    cost = path_cost(space, memory.states[0], memory.attitudes[0], last)
    while setup.checks < checks and last > 1:
        first, end = 0, last
        if uniform(random) > _WHOLE:
            size = 2 + below(random, last - 1)
            first = below(random, last - size + 1)
            end = first + size
        part = Part(first, end, held, slopes, answers, line, inner)
        held[first : end + 1] = False
        held[first] = held[end] = True
        fill_slopes(space, memory, part)
        solve(space, memory, part)
        share = math.exp(-3.0 * uniform(random))
        for _ in range(_TRIES):
            draw_bend(space, part, random, uniform(random) < _BENT, bend)
            change = try_part(space, memory, last, part, share, bend, cost)
            if change.cost < cost - _GAIN:
                cost = change.cost
                last = take_over(space, memory, last)
                break
            if change.hit < first or change.hit >= end:
                share *= 0.5
                continue
            held[change.hit] = held[change.hit + 1] = True
            solve(space, memory, part)
    return last


@kernel
def fill_slopes(space: SearchArrays, memory: PathMemory, part: Part) -> None:
    """Fill in the slopes of all corners inside a part of the path, by differences.

    Both flights that are compared are flown without checks, in steps of the same length.
    """
    states, attitudes = memory.states[0], memory.attitudes[0]
    moved, turn = np.empty(states.shape[1]), np.empty(3)
    between, before, arrival = np.empty(4), np.empty(4), np.empty(4)
    for c in range(part.first + 1, part.last):
        fly(space, states[c - 1], attitudes[c - 1], states[c], between, False)
        fly(space, states[c], between, states[c + 1], before, False)
        for k in range(states.shape[1]):
            part.slopes[c, k] = 0.0
            if k < JOINTS or space.box[0, k] >= space.box[1, k]:
                continue
            moved[:] = states[c]
            moved[k] += _DIFFERENCE
            fly(space, states[c - 1], attitudes[c - 1], moved, between, False)
            fly(space, moved, between, states[c + 1], arrival, False)
            space.setup[0].checks += 1
            fill_rotation_vector(before, arrival, turn)
            for a in range(3):
                part.slopes[c, k, a] = turn[a] / _DIFFERENCE


@kernel
def solve(space: SearchArrays, memory: PathMemory, part: Part) -> None:
    """Fill in line, A^-1 J' and J A^-1 J', between one corner that is held and the next."""
    part.inner[:] = 0.0
    begin = part.first
    for end in range(part.first + 1, part.last + 1):
        if part.held[end]:
            fill_line(space, memory, part, begin, end)
            solve_between(space, memory.passed, part, begin, end)
            begin = end
    for c in range(part.first + 1, part.last):
        for k in range(JOINTS, part.slopes.shape[1]):
            for a in range(3):
                for b in range(3):
                    part.inner[a, b] += part.slopes[c, k, a] * part.answers[c, k, b]
    most = max(part.inner[0, 0], part.inner[1, 1], part.inner[2, 2])
    for a in range(3):
        part.inner[a, a] += _REGULAR * most + _NOTHING


@kernel
def fill_line(space: SearchArrays, memory: PathMemory, part: Part, begin: int, end: int) -> None:
    """Ways of the corners `begin` to `end` to the straight line, at equal shares of length."""
    states, passed = memory.states[0], memory.passed
    passed[begin] = 0.0
    for c in range(begin, end):
        step = distance(space.weights, 1, states[c], states[c + 1])
        passed[c + 1] = passed[c] + max(step, _LEAST_EDGE)
    for c in range(begin, end + 1):
        share = passed[c] / passed[end]
        for k in range(states.shape[1]):
            way = states[begin, k] + share * (states[end, k] - states[begin, k]) - states[c, k]
            part.line[c, k] = way if space.box[0, k] < space.box[1, k] else 0.0


@kernel
def solve_between(space: SearchArrays, passed: Array, part: Part, begin: int, end: int) -> None:
    """A^-1 J' of the corners between two that are held, by elimination: A is tridiagonal."""
    part.answers[begin] = part.answers[end] = 0.0
    ratios = np.zeros(end - begin)
    for c in range(begin + 1, end):
        before, behind = 1.0 / (passed[c] - passed[c - 1]), 1.0 / (passed[c + 1] - passed[c])
        diagonal = before + behind - before * ratios[c - 1 - begin]
        ratios[c - begin] = behind / diagonal
        for k in range(JOINTS, part.slopes.shape[1]):
            weight = max(space.weights[1, k], _LEAST_WEIGHT) ** 2
            for a in range(3):
                value = part.slopes[c, k, a] / weight + before * part.answers[c - 1, k, a]
                part.answers[c, k, a] = value / diagonal
    for c in range(end - 2, begin, -1):
        for k in range(JOINTS, part.slopes.shape[1]):
            for a in range(3):
                part.answers[c, k, a] += ratios[c - begin] * part.answers[c + 1, k, a]


@kernel
def draw_bend(
    space: SearchArrays, part: Part, random: RandomState, bends: bool, bend: Array
) -> None:
    """A smooth random displacement of the corners, or none; `bend` (N, D) is filled in."""
    size = _LARGEST * math.exp(-4.0 * uniform(random))
    for k in range(bend.shape[1]):
        one, two = size * normal(random), size * normal(random)
        moves = bends and space.box[0, k] < space.box[1, k] and uniform(random) < 0.5
        for c in range(part.first + 1, part.last):
            angle = math.pi * (c - part.first) / (part.last - part.first)
            wave = one * math.sin(angle) + two * math.sin(2.0 * angle)
            bend[c, k] = wave if moves and not part.held[c] else 0.0


@kernel
def try_part(
    space: SearchArrays,
    memory: PathMemory,
    last: int,
    part: Part,
    share: float,
    bend: Array,
    cost: float,
) -> Change:
    """Change the path.

    Args:
        space: robot, scene and settings.
        memory: the path; the changed one is filled in.
        last: the last corner of both.
        part: what is straightened.
        share: of the way to the straight line.
        bend: (N, D) displacements besides; used up.
        cost: of the path [m].
    """
    setup, (old, new) = space.setup[0], memory.states
    attitudes, error = memory.attitudes[1], np.empty(3)
    new[: last + 1] = old[: last + 1]
    attitudes[: last + 1] = memory.attitudes[0, : last + 1]
    for c in range(part.first + 1, part.last):
        if not part.held[c]:
            for k in range(new.shape[1]):
                bend[c, k] += share * part.line[c, k]
    for _ in range(_ROUNDS):
        fill_rotation_vector(attitudes[last], setup.goal, error)
        displace(space, part, bend, error, new)
        bend[part.first : part.last] = 0.0
        for c in range(part.first, last):
            fly(space, new[c], attitudes[c], new[c + 1], attitudes[c + 1], False)
            setup.checks += 1
        if angle_of(attitudes[last], setup.goal) < 0.5 * SLACK:
            break
    length = path_length(space.weights, new, last)
    missed = angle_of(attitudes[last], setup.goal)
    if length + setup.missed_weight * max(0.0, missed - SLACK) >= cost - _GAIN:
        return Change(math.inf, -1)
    hit = fly_path(space, new, attitudes, part.first, last)
    if hit < last:
        return Change(math.inf, hit)
    return Change(path_cost(space, new, attitudes, last), -1)


@kernel
def displace(space: SearchArrays, part: Part, bend: Array, error: Array, states: Array) -> None:
    """Displace corners by `bend` and by what else closes the error on arrival, within limits."""
    left = error.copy()
    for c in range(part.first + 1, part.last):
        for k in range(JOINTS, states.shape[1]):
            for a in range(3):
                left[a] -= part.slopes[c, k, a] * bend[c, k]
    factors = solved(part.inner, left)
    for c in range(part.first + 1, part.last):
        for k in range(states.shape[1]):
            value = states[c, k] + bend[c, k]
            if k >= JOINTS:
                for a in range(3):
                    value += part.answers[c, k, a] * factors[a]
            states[c, k] = min(max(value, space.box[0, k]), space.box[1, k])


@kernel
def solved(matrix: Array, right: Array) -> Array:
    """The solution (3,) of a symmetric positive definite system (3, 3), by elimination."""
    rows, result = matrix.copy(), right.copy()
    for a in range(3):
        for b in range(a + 1, 3):
            share = rows[b, a] / rows[a, a]
            for c in range(a, 3):
                rows[b, c] -= share * rows[a, c]
            result[b] -= share * result[a]
    for a in range(2, -1, -1):
        for b in range(a + 1, 3):
            result[a] -= rows[a, b] * result[b]
        result[a] /= rows[a, a]
    return result

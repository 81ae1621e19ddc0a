"""Compiled build of the tree over many spheres."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel

_STACK_SIZE = 64  # a tree of halves has fewer levels than that
_MULTIPLIER, _INCREMENT, _MODULUS = 1_103_515_245, 12_345, 2**31  # of a sequence of pivots


@kernel
def fill_tree(
    spheres: Array,
    order: IntArray,
    nodes: Array,
    children: NDArray[np.int32],
    most: int,
) -> int:
    """Halve the spheres along the longest side of their centres, again and again.

    Args:
        spheres: (N, 4) centre and radius [m], N >= 1; put into the order of the leaves.
        order: (N,) a number for each sphere; reordered likewise.
        nodes: (N, 4) centre and radius of the sphere around each node [m], filled in.
        children: (N, 2) as of `SphereTree`, filled in.
        most: spheres of a leaf at most, >= 2: then there are at most N nodes.

    Returns:
        The number of nodes; a parent comes before its children.
    """
    stack = np.empty((_STACK_SIZE, 3), np.int64)  # a node's parent with its side, begin and end
    stack[0, 0], stack[0, 1], stack[0, 2] = -1, 0, len(order)
    top, count = 1, 0
    while top > 0:
        top -= 1
        parent, begin, end = stack[top, 0], stack[top, 1], stack[top, 2]
        node = count
        count += 1
        if parent >= 0:
            children[parent // 2, parent % 2] = node
        axis = bound_spheres(spheres, begin, end, nodes[node])
        if end - begin <= most:
            children[node, 0], children[node, 1] = -1 - begin, end
            continue
        middle = begin + (end - begin) // 2
        put_least_first(spheres, order, begin, middle, end, axis)
        stack[top, 0], stack[top, 1], stack[top, 2] = 2 * node + 1, middle, end
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = 2 * node, begin, middle
        top += 2
    return count


@kernel
def bound_spheres(spheres: Array, begin: int, end: int, node: Array) -> int:
    """Put a sphere around the spheres begin .. end - 1.

    Args:
        spheres: (N, 4) centre and radius [m].
        begin: the first of them.
        end: the one after the last.
        node: (4,) centre and radius of the sphere around them [m], filled in.

    Returns:
        The axis along which their centres extend farthest.
    """
    axis, longest = 0, -1.0
    for c in range(3):
        low, high, first, last = np.inf, -np.inf, np.inf, -np.inf
        for k in range(begin, end):
            x, radius = spheres[k, c], spheres[k, 3]
            low, high = min(low, x - radius), max(high, x + radius)
            first, last = min(first, x), max(last, x)
        node[c] = 0.5 * (low + high)
        if last - first > longest:
            axis, longest = c, last - first
    around = 0.0
    for k in range(begin, end):
        x, y, z = spheres[k, 0] - node[0], spheres[k, 1] - node[1], spheres[k, 2] - node[2]
        around = max(around, math.sqrt(x * x + y * y + z * z) + spheres[k, 3])
    node[3] = around
    return axis


@kernel
def put_least_first(
    spheres: Array, order: IntArray, begin: int, middle: int, end: int, axis: int
) -> None:
    """Reorder the spheres begin .. end - 1: none before `middle` is beyond one from there on.

    Hoare's selection. The pivots are drawn, by a sequence that is always the same, so that no usual
    order of the spheres makes it slow; equal spheres are halved too.

    Args:
        spheres: (N, 4) centre and radius [m].
        order: (N,) reordered likewise.
        begin: the first of them.
        middle: how many come first, counted from sphere 0.
        end: the one after the last.
        axis: the coordinate that is compared.
    """
    low, high, drawn = begin, end - 1, 1
    while low < high:
        drawn = (drawn * _MULTIPLIER + _INCREMENT) % _MODULUS
        pivot = spheres[low + drawn % (high - low + 1), axis]
        i, j = low, high
        while i <= j:
            while spheres[i, axis] < pivot:
                i += 1
            while spheres[j, axis] > pivot:
                j -= 1
            if i <= j:
                for c in range(4):
                    spheres[i, c], spheres[j, c] = spheres[j, c], spheres[i, c]
                order[i], order[j] = order[j], order[i]
                i += 1
                j -= 1
        if middle <= j:
            high = j
        elif middle >= i:
            low = i
        else:
            return

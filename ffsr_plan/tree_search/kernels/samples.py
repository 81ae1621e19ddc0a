"""Compiled samples that trees grow towards.

Samples change the base alone, the arms alone, lie near the way between the postures at start and
goal, or anywhere in a box. Where a path is known, they lie so near the straight way that a path
through them is not much longer: in an ellipsoid about start and goal (informed sampling, Gammell
et al. 2014), which they are drawn into along lines to points of that way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.flight import distance
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, below, normal, uniform
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, SearchArrays, Trees

_BASE_ONLY, _ARMS_ONLY, _BETWEEN = 0.25, 0.40, 0.60  # cumulated shares of the kinds of samples
_SPREAD = 0.3  # [rad or m] of samples about the way from start to goal
_GOAL_SHARE = 0.1  # of the samples of a tree that grows alone
_NEARER = 0.9  # factor by which a sample comes nearer to the straight way
_MOST_NEARER = 60  # such steps


class Sampling(NamedTuple):
    """Where samples lie, and how a tree grows towards them.

    Attributes:
        box: (2, D) least and greatest coordinates.
        reach: greatest length of an edge from a node towards a sample.
        most: length that a path through a sample may have [m].
    """

    box: Array
    reach: float
    most: float


@kernel
def draw(
    space: SearchArrays, trees: Trees, random: RandomState, sampling: Sampling, side: int,
    twin: bool, sample: Array,
) -> int:  # fmt: skip
    """Draw a state to grow towards, and choose the node to grow from.

    Args:
        space: robot, scene and settings.
        trees: the trees.
        random: (1,) state of the random numbers.
        sampling: where samples lie.
        side: the tree that grows.
        twin: whether both grow; a tree that grows alone is drawn to the goals.
        sample: (D,) filled in.

    Returns:
        The node.
    """
    states, count, box = trees.states[side], trees.counts[side], sampling.box
    for k in range(len(sample)):
        sample[k] = box[0, k] + (box[1, k] - box[0, k]) * uniform(random)
    draw_nearer(space, trees, random, sampling.most, sample)
    kind = uniform(random)
    if not twin and uniform(random) < _GOAL_SHARE:
        sample[:] = trees.states[1, trees.roots[below(random, trees.counts[2])]]
    elif kind < _BASE_ONLY:
        node = below(random, count)
        if uniform(random) < 0.5:
            node = nearest(space.weights, states, count, sample, JOINTS)
        sample[JOINTS:] = states[node, JOINTS:]
        return node
    elif kind < _ARMS_ONLY:
        node = below(random, count)
        sample[:JOINTS] = states[node, :JOINTS]
    elif kind < _BETWEEN:
        share, goal = uniform(random), trees.roots[below(random, trees.counts[2])]
        for k in range(JOINTS, len(sample)):
            begin, end = trees.states[0, 0, k], trees.states[1, goal, k]
            value = begin + share * (end - begin) + _SPREAD * normal(random)
            sample[k] = min(max(value, box[0, k]), box[1, k])
    return nearest(space.weights, states, count, sample, len(sample))


@kernel
def draw_nearer(
    space: SearchArrays, trees: Trees, random: RandomState, most: float, sample: Array
) -> None:
    """Move a sample towards the straight way until a path through it is short enough, if any is."""
    if most == np.inf:
        return
    start, goal = trees.states[0, 0], trees.states[1, trees.roots[below(random, trees.counts[2])]]
    if distance(space.weights, 1, start, goal) >= most:
        return
    share = uniform(random)
    for _ in range(_MOST_NEARER):
        way = distance(space.weights, 1, start, sample) + distance(space.weights, 1, sample, goal)
        if way <= most:
            return
        for k in range(len(sample)):
            line = start[k] + share * (goal[k] - start[k])
            sample[k] = line + _NEARER * (sample[k] - line)


@kernel
def nearest(weights: Array, states: Array, count: int, sample: Array, columns: int) -> int:
    """The node nearest to a state by its first `columns` coordinates."""
    best, found = np.inf, 0
    for i in range(count):
        squared = 0.0
        for k in range(columns):
            step = (states[i, k] - sample[k]) * weights[0, k]
            squared += step * step
            if squared >= best:
                break
        if squared < best:
            best, found = squared, i
    return found

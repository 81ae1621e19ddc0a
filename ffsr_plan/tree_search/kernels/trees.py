"""Compiled twin trees whose nodes carry the attitude that the way to them brings about.

Tree 0 grows from the start; its attitudes are true. Tree 1 grows backwards from the goals; each of
its roots assumes an attitude on arrival, given which its attitudes are true. Where the two meet,
the branch of tree 1 is flown from the node of tree 0 at the true attitude: that decides.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.quaternions import angle_of, turned_back
from ffsr_plan.tree_search.kernels.flight import distance, fly
from ffsr_plan.tree_search.kernels.random_numbers import RandomState, below, uniform
from ffsr_plan.tree_search.kernels.samples import Sampling, draw
from ffsr_plan.tree_search.kernels.search_arrays import SearchArrays, Trees

GROWING, FULL = -1, -2
"""What `grow` returns without a path: it may go on, or there is no memory for more nodes."""
_SHORTEST = 0.02  # length of an edge that is worth a node
_SHORTEST_JOIN = 0.05  # of one that did not reach the other tree
_SAME = 1e-6  # distance of two states that are one
_GOAL_SHARE = 0.1  # of the nodes of a tree that grows alone
_SAME_ATTITUDE = 0.02  # [rad] between roots of one goal
_ROOM = 4  # nodes that one round may add, besides a branch
_NODES_A_CHECK = 400  # whose distances take as long as a check of a configuration


@kernel
def grow(
    space: SearchArrays, trees: Trees, random: RandomState, sampling: Sampling, twin: bool,
    checks: int,
) -> int:  # fmt: skip
    """Grow until a path is found or so many configurations have been checked.

    Args:
        space: robot, scene and settings.
        trees: changed.
        random: (1,) state of the random numbers.
        sampling: where samples lie, and how far an edge goes towards them.
        twin: whether tree 1 grows as well; otherwise nodes of tree 0 are flown to a goal.
        checks: value of `setup.checks` at which to stop.

    Returns:
        The node of tree 0 at a goal, or GROWING or FULL.
    """
    dimensions = trees.states.shape[2]
    memory = np.empty(2 * dimensions + 8)
    sample, target = memory[:dimensions], memory[dimensions : 2 * dimensions]
    arrival = memory[2 * dimensions : 2 * dimensions + 4]
    counts, side, reach = trees.counts, 1, sampling.reach
    while space.setup[0].checks < checks:
        if max(counts[0], counts[1]) + _ROOM >= trees.states.shape[1]:
            return FULL
        side = 1 - side if twin else 0
        space.setup[0].checks += 1 + (counts[0] + counts[1]) // _NODES_A_CHECK
        node = draw(space, trees, random, sampling, side, twin, sample)
        node = extend(space, trees, side, node, sample, reach, target, arrival)
        if node < 0:
            continue
        if not twin:
            found = try_goal(space, trees, random, node, reach, arrival)
        else:
            found = join(space, trees, side, node, memory)
        if found >= 0:
            return found
    return GROWING


@kernel
def nearest_with_attitude(
    weights: Array, states: Array, attitudes: Array, count: int, state: Array, attitude: Array
) -> int:
    """The node nearest to a state in which a radian of the base's attitude counts as a metre.

    Without the attitude most meetings of the trees fail.
    """
    best, found = np.inf, 0
    for i in range(count):
        squared = 0.0
        for k in range(len(state)):
            step = (states[i, k] - state[k]) * weights[0, k]
            squared += step * step
            if squared >= best:
                break
        if squared < best:
            squared += angle_of(attitudes[i], attitude) ** 2
        if squared < best:
            best, found = squared, i
    return found


@kernel
def add(trees: Trees, side: int, parent: int, end: Array, share: float, arrival: Array) -> int:
    """Add a node on the way from a node to a state.

    Args:
        trees: changed.
        side: the tree.
        parent: the node.
        end: (D,) the state.
        share: of the way.
        arrival: (4,) attitude there.
    """
    node = trees.counts[side]
    states = trees.states[side]
    for k in range(len(end)):
        states[node, k] = states[parent, k] + share * (end[k] - states[parent, k])
    if share >= 1.0:
        states[node] = end
    trees.attitudes[side, node] = arrival
    trees.parents[side, node] = parent
    trees.counts[side] += 1
    return node


@kernel
def extend(
    space: SearchArrays, trees: Trees, side: int, node: int, sample: Array, reach: float,
    target: Array, arrival: Array,
) -> int:  # fmt: skip
    """Fly from a node towards a sample by at most `reach`; the new node, -1 if too near."""
    begin = trees.states[side, node]
    far = distance(space.weights, 0, begin, sample)
    if far < _SAME:
        return -1
    share = min(1.0, reach / far)
    for k in range(len(sample)):
        target[k] = begin[k] + share * (sample[k] - begin[k])
    flown = fly(space, begin, trees.attitudes[side, node], target, arrival, True)
    if flown * share * far < _SHORTEST:
        return -1
    return add(trees, side, node, target, flown, arrival)


@kernel
def try_goal(
    space: SearchArrays, trees: Trees, random: RandomState, node: int, reach: float, arrival: Array
) -> int:
    """Fly from a node of tree 0 to a goal, if one is near or now and then; the node there or -1."""
    goal = trees.roots[below(random, trees.counts[2])]
    begin, end = trees.states[0, node], trees.states[1, goal]
    far = distance(space.weights, 0, begin, end)
    if far > 2.0 * reach and uniform(random) >= _GOAL_SHARE:
        return -1
    if fly(space, begin, trees.attitudes[0, node], end, arrival, True) < 1.0:
        return -1
    return add(trees, 0, node, end, 1.0, arrival)


@kernel
def join(space: SearchArrays, trees: Trees, side: int, node: int, memory: Array) -> int:
    """Connect the other tree to a new node, and if they meet, follow tree 1 to its goal.

    Args:
        space: robot, scene and settings.
        trees: changed.
        side: the tree of the node.
        node: the node.
        memory: (2 D + 8,).

    Returns:
        The node of tree 0 at a goal, or -1.
    """
    other, dimensions = 1 - side, trees.states.shape[2]
    arrival = memory[2 * dimensions : 2 * dimensions + 4]
    state, attitude = trees.states[side, node], trees.attitudes[side, node]
    states, attitudes = trees.states[other], trees.attitudes[other]
    count = trees.counts[other]
    near = nearest_with_attitude(space.weights, states, attitudes, count, state, attitude)
    flown = fly(space, states[near], attitudes[near], state, arrival, True)
    if flown < 1.0:
        if flown * distance(space.weights, 0, states[near], state) > _SHORTEST_JOIN:
            add(trees, other, near, state, flown, arrival)
        return -1
    met = add(trees, other, near, state, 1.0, arrival)
    trees.counts[3] += 1
    true, branch = (node, met) if side == 0 else (met, node)
    found = follow(space, trees, true, branch, arrival)
    if found < 0:
        trees.counts[4] += 1
        add_root(space, trees, true, branch, memory)
    return found


@kernel
def follow(space: SearchArrays, trees: Trees, node: int, branch: int, arrival: Array) -> int:
    """Fly along a branch of tree 1 from a node of tree 0; what is flown becomes part of tree 0.

    Args:
        space: robot, scene and settings.
        trees: changed.
        node: of tree 0.
        branch: node of tree 1 at the same state.
        arrival: (4,) memory.

    Returns:
        The node of tree 0 at a goal, or -1.
    """
    states, attitudes = trees.states[0], trees.attitudes[0]
    on = trees.parents[1, branch]
    while on >= 0:
        if trees.counts[0] + 1 >= trees.states.shape[1]:
            return -1
        end = trees.states[1, on]
        flown = fly(space, states[node], attitudes[node], end, arrival, True)
        far = flown * distance(space.weights, 0, states[node], end)
        if flown >= 1.0 or far > _SHORTEST:
            node = add(trees, 0, node, end, flown, arrival)
        if flown < 1.0:
            return -1
        on = trees.parents[1, on]
    return node


@kernel
def add_root(space: SearchArrays, trees: Trees, node: int, branch: int, memory: Array) -> None:
    """A root of tree 1 with the attitude at which the branch would have arrived, if that is clear.

    Args:
        space: robot, scene and settings.
        trees: changed.
        node: of tree 0, from which the branch could not be flown to its end.
        branch: node of tree 1 at the same state.
        memory: (2 D + 8,).
    """
    dimensions, known = trees.states.shape[2], trees.counts[2]
    arrival, spare = memory[2 * dimensions : 2 * dimensions + 4], memory[2 * dimensions + 4 :]
    if known >= len(trees.roots) or trees.counts[1] + 1 >= trees.states.shape[1]:
        return
    root = branch
    while trees.parents[1, root] >= 0:
        root = trees.parents[1, root]
    states, attitudes = trees.states[1], trees.attitudes[1]
    turned_back(trees.attitudes[0, node], attitudes[branch], attitudes[root], arrival)
    for k in range(known):
        other = trees.roots[k]
        apart = distance(space.weights, 0, states[other], states[root])
        if apart < _SAME and angle_of(arrival, attitudes[other]) < _SAME_ATTITUDE:
            return
    if fly(space, states[root], arrival, states[root], spare, True) == 1.0:
        plant(trees, states[root], arrival)


@kernel
def plant(trees: Trees, goal: Array, arrival: Array) -> None:
    """Add a root to tree 1, which has room for it.

    Args:
        trees: changed.
        goal: (D,) state.
        arrival: (4,) attitude that is assumed there.
    """
    node = trees.counts[1]
    trees.states[1, node] = goal
    trees.attitudes[1, node] = arrival
    trees.parents[1, node] = -1
    trees.roots[trees.counts[2]] = node
    trees.counts[1] += 1
    trees.counts[2] += 1

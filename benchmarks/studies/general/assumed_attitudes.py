"""Checkers for planners whose states do not carry the attitude of the base.

A state is a base position, where thrusters move it, and the joint values. Two attitudes can be
assumed: that of the start (`HELD`), or that at which a straight flight from the start would arrive
(`STRAIGHT`). Neither is the attitude at which the base arrives along a path with corners.
"""

import math

import numpy as np
from numba import njit

import ffsr_plan as fp
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.search_space import SearchSpace

HELD, STRAIGHT = "attitude held", "straight way's reaction"


@njit
def _clear(search, begin, attitude, state, assumed, arrival):
    """Whether a state is clear at the assumed attitude, filled in."""
    still, straight = search
    fly(straight if assumed else still, begin, attitude, state, arrival, False)
    return fly(still, state, arrival, state, arrival, True) >= 1.0


@njit
def _way_is_clear(search, ends, attitude, assumed, step):
    """Whether states at most `step` apart on the way between two of them are clear."""
    start, begin, end = ends
    arrival, state = np.empty(4), np.empty(len(begin))
    count = max(1, math.ceil(np.sqrt(np.sum((end - begin) ** 2)) / step))
    for k in range(count + 1):
        state[:] = begin + k / count * (end - begin)
        if not _clear(search, start, attitude, state, assumed, arrival):
            return False
    return True


class Checker:
    """Whether ways are clear at an assumed attitude.

    Attributes:
        space: the planner's own configuration space, whose distances are used.
        free: coordinates of a state of D that are searched.
        bounds: (2, d) least and greatest values of these.
    """

    def __init__(self, problem: fp.Problem, assumed: str, margin: float = 1e-3) -> None:
        """Check ways of a problem at least so far [m] from obstacles and between links."""
        self.space = SearchSpace(problem, margin)
        self.assumed, self._attitude = assumed == STRAIGHT, np.array(problem.start[3:7])
        arrays = self.space.arrays
        setup = arrays.setup.copy()
        setup["reacts"] = False
        self._search = (arrays._replace(setup=setup), arrays)
        box = arrays.box
        self.free = np.flatnonzero(box[1] > box[0])
        if problem.mode.floats:
            self.free = self.free[self.free > 3]
        self.bounds = box[:, self.free]

    def state(self, values) -> np.ndarray:
        """(D,) of searched coordinates."""
        state = self.space.start.copy()
        for k, value in zip(self.free, values, strict=True):
            state[k] = value
        return state

    def clear(self, begin: np.ndarray, end: np.ndarray, step: float) -> bool:
        """Whether the way between two states (D,) is clear, checked every `step` [m or rad]."""
        ends = (self.space.start, begin, end)
        return bool(_way_is_clear(self._search, ends, self._attitude, self.assumed, step))

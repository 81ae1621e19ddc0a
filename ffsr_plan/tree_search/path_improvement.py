"""A path that is made better: moves, shortest paths around it, and fewer corners."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.tree_search.kernels.attitude_keeping import straighten
from ffsr_plan.tree_search.kernels.closed_loops import ENOUGH, LOOP_CORNERS, insert_loops
from ffsr_plan.tree_search.kernels.flight import fly_path
from ffsr_plan.tree_search.kernels.layered_search import (
    GOING_ON,
    LANES,
    LAYERS,
    Layers,
    lay_out,
    search_layers,
)
from ffsr_plan.tree_search.kernels.path_cost import path_cost
from ffsr_plan.tree_search.kernels.path_moves import PathMemory, improve, thin
from ffsr_plan.tree_search.kernels.random_numbers import RandomState
from ffsr_plan.tree_search.kernels.search_arrays import SearchArrays
from ffsr_plan.tree_search.restarts import CHUNK
from ffsr_plan.tree_search.search_space import SearchSpace

_ROOM, _ROOM_FOR_LOOPS = 64, 400  # corners that may be added to a path
_SPREAD = 0.3  # of the largest moves of a corner
_STATIONS = 12  # at which two paths are compared
_AS_ONE = 0.5  # distance up to which two paths go one way round


class ImprovedPath:
    """A path through the configuration space, flown, and what it costs.

    Attributes:
        problem: the problem with the goal that the path leads to.
        last: its last corner.
        cost: see `path_cost` [m].
    """

    def __init__(
        self,
        space: SearchSpace,
        states: Array,
        attitudes: Array,
        expired: Callable[[], bool] = bool,
    ) -> None:
        """A path that has been flown.

        Args:
            space: the configuration space.
            states: (k, D) corners.
            attitudes: (k, 4) of the base there.
            expired: asked every few milliseconds; whether to end all work early.
        """
        self._expired = expired
        self._space, self.last = space, len(states) - 1
        self._goal = space.goal_at(states[-1])
        self.problem = space.problems[self._goal]
        room = max(len(states), LAYERS + 2) + _ROOM
        if space.problem.reach_attitude:
            room += _ROOM_FOR_LOOPS
        self._memory = PathMemory(
            np.zeros((2, room, states.shape[1])), np.zeros((2, room, 4)), np.zeros(room)
        )
        self._memory.states[0, : len(states)] = states
        self._memory.attitudes[0, : len(states)] = attitudes
        self.cost = 0.0
        self._weigh()

    @property
    def _arrays(self) -> SearchArrays:
        """Those of the space, with the attitude to arrive at that belongs to the path's goal."""
        self._space.aim_at(self._goal)
        return self._space.arrays

    @property
    def states(self) -> Array:
        """(k, D) corners."""
        return self._memory.states[0, : self.last + 1].copy()

    def thin(self, checks: int) -> None:
        """Leave out corners; at most so many configurations are checked."""
        end, tried = self._until(checks), np.zeros(1, dtype=np.int64)
        while tried[0] >= 0 and self._goes_on(end):
            stop = min(self._until(CHUNK), end)
            self.last = thin(self._arrays, self._memory, self.last, tried, stop)
        self._weigh()

    def move(self, random: RandomState, checks: int) -> None:
        """Try random moves until so many configurations have been checked.

        Args:
            random: (1,) state of the random numbers.
            checks: number of configurations.
        """
        end = self._until(checks)
        while self._goes_on(end):
            stop = min(self._until(CHUNK), end)
            self.last = improve(self._arrays, self._memory, self.last, random, _SPREAD, stop)
        self._weigh()

    @property
    def missed(self) -> float:
        """Angle by which it misses the attitude that is demanded [rad], or 0."""
        setup = self._arrays.setup[0]
        if setup["missed_weight"] == 0.0:
            return 0.0
        return float(angle_between(self._memory.attitudes[0, self.last], setup["goal"]))

    def turn(self, random: RandomState, checks: int) -> None:
        """Insert closed loops of the joints that bring the base to the attitude demanded."""
        end = self._until(checks)
        while self.missed >= ENOUGH and self._goes_on(end):
            if self.last + LOOP_CORNERS >= self._memory.states.shape[1]:
                break
            stop = min(self._until(CHUNK), end)
            self.last = insert_loops(self._arrays, self._memory, self.last, random, stop)
        self._weigh()

    def straighten(self, random: RandomState, checks: int) -> None:
        """Straighten parts of a path without losing the attitude that is demanded."""
        end = self._until(checks)
        while self._goes_on(end):
            stop = min(self._until(CHUNK), end)
            self.last = straighten(self._arrays, self._memory, self.last, random, stop)
        self._weigh()

    def search_around(self, random: RandomState, checks: int) -> bool:
        """Look for a better path through random states around this one; whether there was one."""
        return self._search(random, self.cost, checks)

    def repair(self, random: RandomState, checks: int) -> bool:
        """Whether the path is clear, after a search around it if it was not.

        What has to be kept away from may have changed since the path was flown.
        """
        space, memory = self._arrays, self._memory
        reached = fly_path(space, memory.states[0], memory.attitudes[0], 0, self.last)
        if reached == self.last:
            self._weigh()
            return True
        return self._search(random, np.inf, checks)

    def goes_with(self, other: ImprovedPath) -> bool:
        """Whether another path goes the same way round, as far as some of its states tell."""
        weights = self._space.arrays.weights[0]
        first, second = (_stations(path.states * weights) for path in (self, other))
        return bool(np.max(np.linalg.norm(first - second, axis=1)) < _AS_ONE)

    def _search(self, random: RandomState, cost: float, checks: int) -> bool:
        arrays, memory = self._arrays, self._memory
        layers, last, end = _layers(memory.states.shape[2]), GOING_ON, self._until(checks)
        lay_out(arrays, memory, self.last, random, layers)
        while last == GOING_ON and self._goes_on(end):
            last = search_layers(arrays, memory, layers, cost, min(self._until(CHUNK), end))
        if last < 0:
            return False
        self.last = last
        self._weigh()
        return True

    def _goes_on(self, end: int) -> bool:
        return self._until(0) < end and not self._expired()

    def _until(self, checks: int) -> int:
        return int(self._space.arrays.setup[0]["checks"]) + checks

    def _weigh(self) -> None:
        memory = self._memory
        arrays = self._arrays
        self.cost = float(path_cost(arrays, memory.states[0], memory.attitudes[0], self.last))


def _layers(dimensions: int) -> Layers:
    shape, rows = (LAYERS + 1, LANES, LANES), LAYERS + 2
    return Layers(
        np.zeros((rows, LANES, dimensions)),
        np.zeros(shape),
        np.zeros(shape, dtype=np.bool_),
        np.zeros(rows, dtype=np.int64),
        np.zeros(rows, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


def _stations(states: Array) -> Array:
    """(_STATIONS, D) states at equal steps of length along corners (k, D)."""
    steps = np.linalg.norm(np.diff(states, axis=0), axis=1)
    passed = np.append(0.0, np.cumsum(steps))
    places = np.linspace(0.0, passed[-1], _STATIONS)
    return np.stack([np.interp(places, passed, column) for column in states.T], axis=1)

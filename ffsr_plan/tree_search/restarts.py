"""Searches by trees, one after another, with other random numbers, lengths of edges and samples."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.tree_search.kernels.flight import distance, fly
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.kernels.samples import Sampling
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, Trees
from ffsr_plan.tree_search.kernels.trees import FULL, grow, plant
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings

CHUNK = 500
"""Configurations checked between two looks at the clock: a few milliseconds."""
_MOST_PAIRS = 200_000  # of nodes whose distances are computed for an error
_FIRST_NODES = 20_000  # of each tree of a first try; longer ones have more
_CHECKS_A_NODE = 4  # at least
_DETOUR = 1.3  # length of paths that are looked for, as a multiple of one that is known
_MOST_NODES, _MOST_CHECKS = 500_000, 10**10  # of a try, however many there were before


class FoundPath(NamedTuple):
    """A path that the trees have found.

    Attributes:
        states: (k, D) corners.
        attitudes: (k, 4) of the base there.
    """

    states: Array
    attitudes: Array


class Meetings(NamedTuple):
    """What the trees of all tries did.

    Attributes:
        tries: number of searches.
        nodes: of all trees.
        meetings: how often two trees met.
        failed: how often the way from there to the goal was not clear at the true attitude.
        spread: greatest distance of a node from the root of its tree, of the trees from the start
            and of those from the goals [m].
    """

    tries: int = 0
    nodes: int = 0
    meetings: int = 0
    failed: int = 0
    spread: tuple[float, float] = (0.0, 0.0)


class Restarts:
    """Searches by trees. A try is ended after some work, and the next ones may take longer.

    Short tries find what is easy quickly; those that double in length find what is hard too.

    Attributes:
        trees: those of the last try.
        meetings: what the trees of all tries did.
    """

    def __init__(
        self, space: SearchSpace, rng: np.random.Generator, settings: TreeSettings
    ) -> None:
        """Prepare the searches.

        Args:
            space: the configuration space.
            rng: source of randomness.
            settings: of the trees.
        """
        self._space, self._random, self._settings = space, random_state(rng), settings
        self._ends = (space.start[None], space.goals)
        self._boxes = (_box_about(space, settings.joint_range), space.arrays.box)
        self._left = 0  # checks that remain of the try at hand
        self.trees: Trees = self._planted()
        self.meetings = Meetings()

    def find(
        self, checks: int, expired: Callable[[], bool] = bool, known: float = np.inf
    ) -> FoundPath | None:
        """Search until a path is found or the work is done.

        Args:
            checks: configurations that may be checked.
            expired: asked every few milliseconds; whether to stop.
            known: cost of the best path that is known [m].

        Returns:
            A path, or None.
        """
        setup, space = self._space.arrays.setup[0], self._space
        end = int(setup["checks"]) + checks
        while int(setup["checks"]) < end and not expired():
            if self._left <= 0:
                self._begin()
            sampling, twin = self._sampling(known)
            now = int(setup["checks"])
            stop = min(now + min(self._left, CHUNK), end)
            found = grow(space.arrays, self.trees, self._random, sampling, twin, stop)
            self._left -= int(setup["checks"]) - now
            if found == FULL:
                self._left = 0
            if found >= 0:
                self._left = 0
                return self._path_to(found)
        return None

    def tally(self) -> Meetings:
        """What the trees of all tries did, with those of the last one."""
        counts, known = self.trees.counts.tolist(), self.meetings
        spread = (self._spread(0), self._spread(1))
        return Meetings(
            known.tries,
            known.nodes + counts[0] + counts[1],
            known.meetings + counts[3],
            known.failed + counts[4],
            (max(spread[0], known.spread[0]), max(spread[1], known.spread[1])),
        )

    def _spread(self, side: int) -> float:
        """Greatest distance of a node of a tree from the nearest start or goal."""
        nodes = self.trees.states[side, : self.trees.counts[side]]
        weights, ends = self._space.arrays.weights[0], self._ends[side]
        apart = [np.sum(((nodes - end) * weights) ** 2, axis=1) for end in ends]
        return float(np.sqrt(np.max(np.min(apart, axis=0))))

    def nearest(self) -> tuple[Array, Array, Array]:
        """Where the trees of the last try came nearest to each other.

        Returns:
            (D,) state and (4,) attitude of a node of the tree from the start, and (D,) state of one
            of the tree from the goals.
        """
        first, second = (self.trees.states[side, : self.trees.counts[side]] for side in (0, 1))
        weights, best = self._space.arrays.weights, (np.inf, 0, 0)
        stride = max(1, len(first) * len(second) // _MOST_PAIRS)
        for j, goal in enumerate(second[::stride]):
            apart = np.sum(((first - goal) * weights[0]) ** 2, axis=1)
            i = int(np.argmin(apart))
            best = min(best, (float(apart[i]), i, j * stride))
        _, i, j = best
        return first[i], self.trees.attitudes[0, i], second[j]

    def _sampling(self, known: float) -> tuple[Sampling, bool]:
        """Samples of the try at hand, and whether both trees grow.

        Of two rounds of tries, each length of edges has samples from either box in one.
        """
        reaches, number = self._settings.reaches, self.meetings.tries - 1
        turn, place = divmod(number, len(reaches))
        box = self._boxes[(turn + place) % 2]
        return Sampling(box, abs(reaches[place]), _DETOUR * known), reaches[place] > 0.0

    def _begin(self) -> None:
        """A new try."""
        self.meetings = self.tally()
        tries = self.meetings.tries
        self._left = self._settings.first_checks * 2 ** (tries // len(self._settings.reaches))
        self._left = min(self._left, _MOST_CHECKS)
        self.trees = self._planted()
        self.meetings = self.meetings._replace(tries=tries + 1)

    def _planted(self) -> Trees:
        """Trees that consist of their roots."""
        space, start = self._space, self._space.start
        capacity = min(max(_FIRST_NODES, self._left // _CHECKS_A_NODE), _MOST_NODES)
        roots = max(self._settings.roots + len(space.problem.alternatives), len(space.goals))
        trees = Trees(
            np.zeros((2, capacity, len(start))),
            np.zeros((2, capacity, 4)),
            np.full((2, capacity), -1, dtype=np.int64),
            np.zeros(roots, dtype=np.int64),
            np.zeros(5, dtype=np.int64),
        )
        trees.states[0, 0], trees.attitudes[0, 0] = start, space.problem.start[3:7]
        trees.counts[0] = 1
        arrival = np.zeros(4)
        for goal, problem in zip(space.goals, space.problems, strict=True):
            fly(space.arrays, start, trees.attitudes[0, 0], goal, arrival, False)
            if problem.reach_attitude:
                arrival[:] = problem.goal[3:7]
            plant(trees, goal, arrival)
        return trees

    def _path_to(self, node: int) -> FoundPath:
        nodes = [node]
        while (parent := int(self.trees.parents[0, nodes[-1]])) >= 0:
            nodes.append(parent)
        return FoundPath(
            self.trees.states[0, nodes[::-1]].copy(), self.trees.attitudes[0, nodes[::-1]].copy()
        )


def _box_about(space: SearchSpace, joint_range: float | None) -> Array:
    """(2, D) the box of the space, joints no farther from those of start and goals than a range."""
    box = space.arrays.box.copy()
    if joint_range is not None:
        ends = np.vstack([space.start, space.goals])[:, JOINTS:]
        box[0, JOINTS:] = np.maximum(box[0, JOINTS:], ends.min(axis=0) - joint_range)
        box[1, JOINTS:] = np.minimum(box[1, JOINTS:], ends.max(axis=0) + joint_range)
    return box


def far_apart(space: SearchSpace, first: Array, second: Array) -> float:
    """Distance of two states (D,) in the search."""
    return float(distance(space.arrays.weights, 0, first, second))

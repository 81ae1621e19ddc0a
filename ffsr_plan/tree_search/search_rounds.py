"""Rounds of searching, improving and proving, each with twice the work of the one before."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Branches, SearchMonitor, Solution, TreeCycle
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.end_checks import check_ends
from ffsr_plan.tree_search.kernels.closed_loops import ENOUGH
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.not_found import path_not_found
from ffsr_plan.tree_search.path_improvement import ImprovedPath
from ffsr_plan.tree_search.proven_paths import ProvenPaths
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings

_FIRST_ROUND = 60_000  # configurations checked
_SEARCHING = 0.5  # share of a round that is spent on new paths
_AT_FIRST = 4_000  # configurations checked to straighten a path that was just found
_TURNING = 30_000  # at most, for loops that turn the base
_THINNING = 20_000  # at most, to leave out corners
_FOR_NEW = 16_000  # to improve a path before it is compared with others
_AROUND = 30_000  # at most, for a search around a path
_ATTEMPTS = 4  # repairs of a path whose proof fails


class SearchRounds:
    """A search that can be ended at any time and then has the best path that it has proven.

    Attributes:
        space: the configuration space.
        proven: proofs so far.
    """

    def __init__(
        self,
        problem: Problem,
        settings: TreeSettings,
        rng: np.random.Generator,
        monitor: SearchMonitor,
    ) -> None:
        """Check the ends and prepare the search.

        Args:
            problem: a problem without a lattice.
            settings: of the search.
            rng: source of randomness.
            monitor: callback and stopping condition.

        Raises:
            StartInCollision, GoalInCollision: see `TreePlanner.solve`.
        """
        self.space = SearchSpace(check_ends(problem), settings.margin)
        self._deadline, self._ways = monitor.deadline or Deadline(), settings.ways
        searching, self._random = rng.spawn(1)[0], random_state(rng)
        self._restarts = Restarts(self.space, searching, settings)
        self._paths: list[ImprovedPath] = []
        self._missed: float | None = None  # [rad], by paths to the goal at another attitude
        self.proven = ProvenPaths(self.space, self._deadline)
        self._monitor = monitor._replace(reserve=self.proven.reserve)

    def begin_with(self, motion: Motion) -> None:
        """Improve a known motion too, if it keeps the margin or can be made to.

        Args:
            motion: one that is free.
        """
        path = self._path(self.space.states_along(motion), motion.attitudes)
        if path.repair(self._random, _AROUND) and path.missed <= ENOUGH:
            self._keep(path)

    def run(self, checks: int, first: bool) -> bool:
        """Search until so many configurations have been checked.

        Args:
            checks: number of configurations.
            first: whether to end with the first path that is proven free.

        Returns:
            Whether the monitor ended it before.

        Raises:
            OutOfTime: by the deadline, in the proof of the first path.
        """
        if self._try_straight() or (first and self.proven.best is not None):
            return False
        size, number = _FIRST_ROUND, 0
        while self.checks < checks and not self._monitor.expired():
            end = min(self.checks + size, checks)
            new = self._search(end, first)
            if first and self.proven.best is not None:
                return False
            if self._paths:
                self._improve(end)
            number, size = number + 1, 2 * size
            self._report(number, checks, new)
        return self._monitor.expired()

    def solution(self, interrupted: bool, seconds: float) -> Solution:
        """The best path that is proven free.

        Args:
            interrupted: whether time limit or Ctrl-C ended the search.
            seconds: time that it took [s].

        Raises:
            PathNotFound: there is none.
        """
        if self.proven.best is None:
            raise path_not_found(
                self.space, self._restarts, self.proven, interrupted, seconds, self._missed
            )
        return self.proven.solution(self._restarts.trees, interrupted)

    def branches(self) -> Branches:
        """Edges of the trees of the last search, for pictures."""
        return self.proven.branches(self._restarts.trees)

    @property
    def checks(self) -> int:
        """Configurations checked so far."""
        return int(self.space.arrays.setup[0]["checks"])

    @property
    def nodes(self) -> int:
        """Nodes of all trees so far."""
        return self._restarts.tally().nodes

    def _try_straight(self) -> bool:
        """Whether the straight way is proven free and no path can cost less."""
        space, arrival = self.space, np.zeros((2, 4))
        arrival[0] = space.problem.start[3:7]
        for k, goal in enumerate(space.goals):
            if fly(space.arrays, space.start, arrival[0], goal, arrival[1], True) == 1.0:
                path = self._path(np.stack([space.start, goal]), arrival)
                if path.missed > ENOUGH:
                    continue
                self._paths.append(path)
                return self._prove(path) and k == 0 and space.problem.delta == 0.0
        return False

    def _search(self, end: int, first: bool) -> float:
        """New paths, for the part of a round that is meant for it; without one, for all of it.

        Args:
            end: number of configurations checked at which the round ends.
            first: whether to end with the first path that is proven free.

        Returns:
            The least cost of a new path [m].
        """
        least, part = np.inf, self.checks + int(_SEARCHING * (end - self.checks))
        while self.checks < (part if self._paths else end) and not self._monitor.expired():
            limit = part if self._paths else end
            known = min((path.cost for path in self._paths), default=np.inf)
            found = self._restarts.find(limit - self.checks, self._monitor.expired, known)
            if found is None:
                continue
            path = self._path(*found)
            path.move(self._random, _AT_FIRST)
            path.thin(_THINNING)
            path.turn(self._random, _TURNING)
            if path.missed > ENOUGH:
                path.straighten(self._random, _TURNING)
                path.turn(self._random, _TURNING)
            if path.missed > ENOUGH:
                self._missed = min(self._missed or np.inf, path.missed)
                continue
            if self.proven.best is None:
                if not self._prove(path):
                    continue
                if first:
                    break
            path.move(self._random, _FOR_NEW)
            if self.space.problem.reach_attitude:
                path.straighten(self._random, _FOR_NEW)
            path.thin(_THINNING)
            least = min(least, path.cost)
            self._keep(path)
        return least

    def _path(self, states: Array, attitudes: Array) -> ImprovedPath:
        return ImprovedPath(self.space, states, attitudes, self._monitor.expired)

    def _keep(self, path: ImprovedPath) -> None:
        """Keep a path if it is among the best; of those that go one way round, the better one."""
        for k, other in enumerate(self._paths):
            if path.goes_with(other):
                if path.cost < other.cost:
                    self._paths[k] = path
                break
        else:
            self._paths.append(path)
        self._paths.sort(key=lambda each: each.cost)
        del self._paths[self._ways :]

    def _improve(self, until: int) -> None:
        """Improve all paths that are kept, then the best of them, and prove it."""
        share = max((until - self.checks) // (2 * len(self._paths)), 1)
        for path in self._paths:
            self._work_on(path, self.checks + share)
        self._paths.sort(key=lambda each: each.cost)
        self._work_on(self._paths[0], until)
        best = self._paths[0]
        if self.proven.is_worth_proving(best.cost) and not self._prove(best):
            self._paths.remove(best)

    def _work_on(self, path: ImprovedPath, until: int) -> None:
        """Improve one path until so many configurations have been checked."""
        stop = self._monitor.expired
        while (left := until - self.checks) > 0 and not stop():
            if self.space.problem.reach_attitude:
                path.straighten(self._random, max(2 * left // 3, 1))
                path.move(self._random, max(left // 6, 1))
                path.thin(min(_THINNING, max(left // 3, 1)))
                continue
            path.move(self._random, max(left // 3, 1))
            path.search_around(self._random, min(_AROUND, max(left // 3, 1)))
            path.thin(min(_THINNING, max(left // 3, 1)))

    def _prove(self, path: ImprovedPath) -> bool:
        """Whether a path is proven free, after repairs where the proof of some edges fails."""
        for _ in range(_ATTEMPTS):
            try:
                if self.proven.take(path):
                    return True
            except OutOfTime as error:
                if self.proven.best is None:
                    advice = ("a longer time_limit",)
                    raise OutOfTime(error.time_limit, error.stage, advice) from None
                return False
            if not path.repair(self._random, _AROUND):
                break
        return False

    def _report(self, number: int, checks: int, new: float) -> None:
        """Note the round in the history, and tell the callback."""
        rounds = max(number, int(np.ceil(np.log2(1.0 + checks / _FIRST_ROUND))))
        unit = self.space.problem.length_unit
        self.proven.note(new / unit, len(self._paths))
        if self._monitor.on_cycle is None:
            return
        best = self.proven.best
        path, arrival = np.zeros((0, 3)), np.zeros(0)
        if best is not None:
            path, arrival = best.motion.positions, best.motion.configurations()[-1]
        objective = np.inf if best is None else best.objective
        self._monitor.on_cycle(
            TreeCycle(
                number, rounds, objective, new / unit, self.checks,
                self._restarts.meetings.nodes, path, arrival,
                self.branches(),
            )
        )  # fmt: skip

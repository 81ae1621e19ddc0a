"""A search by trees among bodies that move: many paths, of which the best run in time is taken.

The trees do not know the time. They find paths among what is at rest, in turn without the bodies
and beside the bodies held still where they are at some instant, so that paths go round them on all
sides. Each path is run in time as well as it can be; see `TimedRuns`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.errors import GoalInCollision, OutOfTime, PathNotFound, StartInCollision
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import ObstacleShape
from ffsr_plan.search.records import Branches, SearchMonitor, Solution, TreeCycle
from ffsr_plan.search.timed_runs import TimedRuns
from ffsr_plan.tree_search.end_checks import check_ends
from ffsr_plan.tree_search.search_rounds import SearchRounds
from ffsr_plan.tree_search.tree_settings import TreeSettings

_FIRST_WORK = 60_000  # configurations checked for each of the first paths
_LEAST_SHARE = 10  # of its work that a path counts for at least, so that the search ends
_GIVING_WAY = 4  # of so many paths without a run, one is run with steps aside, which take long
_PATHS = 6  # after so many, twice the work for each
_ADVICE = (
    "a longer duration",
    "more time_steps of the TreePlanner, or a larger base_speed and joint_speed",
    "more checks of the TreePlanner",
    "a lattice with progress, on which the base gives way to the side too",
)


class SearchInTime:
    """A search that can be ended at any time and then has the best run that it has proven.

    Attributes:
        runs: paths run in time so far.
    """

    def __init__(
        self,
        problem: Problem,
        settings: TreeSettings,
        rng: np.random.Generator,
        monitor: SearchMonitor,
        runs: TimedRuns,
    ) -> None:
        """Check the ends and prepare the search.

        Args:
            problem: a problem without a lattice, among bodies that move.
            settings: of the trees.
            rng: source of randomness.
            monitor: callback and stopping condition.
            runs: takes the paths.

        Raises:
            StartInCollision, GoalInCollision: see `TreePlanner.solve`.
        """
        self._problem = check_ends(problem)
        self._settings, self._rng, self._monitor, self.runs = settings, rng, monitor, runs
        self._branches, self._checks, self._nodes, self._paths = Branches.none(), 0, 0, 0
        self._nothing: PathNotFound | None = None

    def begin_with(self, motion: Motion) -> None:
        """Run a known motion in time too.

        Args:
            motion: one that is free.

        Raises:
            OutOfTime: by the deadline.
        """
        self._paths += 1
        self.runs.take(motion, False)

    def run(self, checks: int, first: bool) -> bool:
        """Search until so many configurations have been checked.

        Args:
            checks: number of configurations.
            first: whether to end with the first run that is proven free.

        Returns:
            Whether the monitor ended it before.

        Raises:
            OutOfTime: by the deadline, before there is a run.
        """
        number = 0
        while self._checks < checks and not self._monitor.expired():
            work = min(_FIRST_WORK * 2 ** (number // _PATHS), checks - self._checks)
            try:
                value = self._try(number, work, first)
            except OutOfTime:
                if self.runs.best is None:
                    raise
                return True
            number += 1
            self._report(number, checks, value)
            if first and self.runs.best is not None:
                return False
        return self._monitor.expired()

    def solution(self, interrupted: bool) -> Solution:
        """The best run that is proven free.

        Args:
            interrupted: whether time limit or Ctrl-C ended the search.

        Raises:
            PathNotFound: there is none.
        """
        if self.runs.best is None:
            raise self._no_run(interrupted)
        return self.runs.solution(self._branches, interrupted)

    def _still(self, number: int) -> Problem:
        """The problem among bodies at rest: none at first, then where they are at some instants.

        In turn that is one instant for all, when the last path was closed, and one for each.
        """
        problem, bodies = self._problem, self._problem.scene.bodies
        duration, closed = problem.duration or 0.0, self.runs.closed_at
        times = np.full(len(bodies), duration * _share(number))
        if number % 3 == 1 and closed is not None:
            times[:] = closed
        elif number % 3 == 2:
            times = duration * self._rng.random(len(bodies))
        shapes = list(problem.scene.shapes)
        for body, time in zip(bodies, times.tolist(), strict=True):
            shapes += self._apart(body, time) if number else ()
        debris = problem.scene.debris if number else ()
        scene = replace(problem.scene, shapes=tuple(shapes), bodies=(), debris=debris)
        if debris:
            scene = scene.at(float(times[0]) if len(times) else duration * _share(number))
        return replace(problem, scene=scene, duration=None, ramp=0.0)

    def _apart(self, body: MovingBody, time: float) -> tuple[ObstacleShape, ...]:
        """The shapes of a body at a time if they touch neither start nor goal."""
        problem, shapes = self._problem, body.shapes_at(time)
        ends = np.vstack([problem.start, problem.goals])
        there = Scene(shapes=shapes, growth=problem.obstacles.growth)
        near = ObstacleQuery(problem.robot, there).distances(ends).min() <= 0.0
        return () if near else shapes

    def _try(self, number: int, work: int, first: bool) -> float:
        """F of the best run of a path past bodies at rest; infinite without."""
        monitor, still = self._monitor._replace(on_cycle=None), self._still(number)
        try:
            rounds = SearchRounds(still, self._settings, self._rng.spawn(1)[0], monitor)
        except (StartInCollision, GoalInCollision):  # beside bodies at rest there
            self._checks += max(work // _LEAST_SHARE, 1)
            return np.inf
        rounds.run(work, first)
        self._checks += max(rounds.checks, work // _LEAST_SHARE, 1)
        self._nodes += rounds.nodes
        found = rounds.proven.best
        if found is None:
            try:
                rounds.solution(False, self._seconds())
            except PathNotFound as error:
                self._nothing = error
            return np.inf
        self._paths += 1
        before = self.runs.best
        aside = before is None and number % _GIVING_WAY == _GIVING_WAY - 1
        value = self.runs.take(found.motion, aside)
        if self.runs.best is not before:
            self._branches = rounds.branches()
        return value

    def _seconds(self) -> float:
        deadline = self._monitor.deadline
        return 0.0 if deadline is None else deadline.elapsed()

    def _no_run(self, interrupted: bool) -> PathNotFound:
        """The error: no path, or none that can be run in time."""
        error, advice = self._nothing, list(_ADVICE)
        if interrupted:
            advice.insert(0, "a longer time_limit")
        if error is None:
            error = PathNotFound(self._seconds(), 0, 0, 0, 0, 0.0)
        elif not self._paths:
            return replace(error, seconds=self._seconds())
        return replace(
            error, seconds=self._seconds(), paths=self._paths, closed_at=self.runs.closed_at,
            advice=tuple(advice),
        )  # fmt: skip

    def _report(self, number: int, checks: int, value: float) -> None:
        """Tell the callback of a path."""
        if self._monitor.on_cycle is None:
            return
        best, path, arrival = self.runs.best, np.zeros((0, 3)), np.zeros(0)
        if best is not None:
            path, arrival = best.motion.positions, best.motion.configurations()[-1]
        expected = max(number, int(np.ceil(number * checks / max(self._checks, 1))))
        objective = np.inf if best is None else best.objective
        self._monitor.on_cycle(
            TreeCycle(
                number, expected, objective, value, self._checks, self._nodes, path, arrival,
                self._branches,
            )
        )  # fmt: skip


def _share(number: int) -> float:
    """The number of the sequence of van der Corput to base two: 1/2, 1/4, 3/4, 1/8, ..."""
    share, part = 0.0, 0.5
    while number:
        number, bit = divmod(number, 2)
        share += bit * part
        part *= 0.5
    return share

"""Paths without a lattice, run in time among bodies that move.

Along a path the best run in time is found exactly: at every step of time the robot goes on to the
next place of the path, waits, or goes back to the one before, its joints and attitude being
functions of the place. So a run is a shortest path over time and places, proven free like others.
Where there is none and thrusters move the base, it may give way to the sides too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.errors import GoalInCollision, InternalError
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate, Counts, proven_clearance
from ffsr_plan.problem.free_objective import (
    STATIONS,
    edge_lengths,
    least_objective,
    stations_objective,
)
from ffsr_plan.problem.problem import Problem
from ffsr_plan.progress_lattice.progress_roadmap import ProgressRoadmap
from ffsr_plan.progress_lattice.progress_search import ProgressSearch
from ffsr_plan.progress_lattice.side_steps import SideSteps
from ffsr_plan.progress_lattice.ways import LargestStep, PathWay
from ffsr_plan.proof.prover import Prover
from ffsr_plan.search.records import Branches, History, Solution
from ffsr_plan.time_limit.deadline import Deadline

_ASIDE = (0, 6, 4, 2)  # nodes to either side along one, two and three axes
_FASTER = 2.0  # than a steady run that ends in time, so that half of the time is left for waiting


class TimeSteps(NamedTuple):
    """The steps of time of a run, and what limits its speed.

    Attributes:
        number: of the steps, a multiple of 40, at each fortieth of which F counts the clearance.
        base_speed: of the base origin, at most [m/s]; None for twice that of a steady run.
        joint_speed: of any joint, at most [rad/s or m/s]; None for twice that of a steady run.
    """

    number: int
    base_speed: float | None
    joint_speed: float | None

    def largest(self, problem: Problem, path: Motion) -> LargestStep:
        """What one step of time may change.

        Args:
            problem: gives duration and ramp.
            path: the path that is run.
        """
        fastest = (problem.duration or 0.0) * (1.0 - problem.ramp) / self.number  # [s] a step takes
        length = float(edge_lengths(problem, path).sum())
        base = float(np.linalg.norm(path.base_steps(), axis=1).sum())
        turned = np.abs(np.diff(path.joint_values, axis=0)).max(axis=1, initial=0.0)
        share = _FASTER / self.number
        return LargestStep(
            share * length or np.inf,
            share * base or np.inf if self.base_speed is None else self.base_speed * fastest,
            share * float(turned.sum()) or np.inf
            if self.joint_speed is None
            else self.joint_speed * fastest,
        )


class TimedRun(NamedTuple):
    """A path run in time, proven free.

    Attributes:
        problem: the problem with the goal that it leads to.
        motion: through its places, one edge for each step of time.
        length: L of what is run, to and fro [m].
        objective: F [length units].
    """

    problem: Problem
    motion: Motion
    length: float
    objective: float


class TimedRuns:
    """The best run of several paths.

    Attributes:
        best: the best run, or None.
        closed_at: when the last path without a run was closed for good [s]; None before.
    """

    def __init__(self, problem: Problem, steps: TimeSteps, deadline: Deadline) -> None:
        """No runs yet.

        Args:
            problem: a problem without a lattice, among bodies that move.
            steps: the steps of time.
            deadline: of the searches and proofs.
        """
        self._problem, self._steps, self._deadline = problem, steps, deadline
        self.best: TimedRun | None = None
        self.closed_at: float | None = None
        self._counts = Counts(0, 0, 0, 0)
        self._rows: list[tuple[float, float, float, float]] = []

    def take(self, path: Motion, aside: bool) -> float:
        """Run a path in time, and keep the run if it is the best.

        Args:
            path: free of what is at rest, from the start to a goal.
            aside: whether the base may give way to the sides where there is no run else.

        Returns:
            F of its best run [length units]; infinite where there is none.

        Raises:
            OutOfTime: at the deadline.
        """
        problem = self._problem.ending_at(path.configurations()[-1])
        largest = self._steps.largest(problem, path)
        way, motion = PathWay(problem, path, largest), None
        if len(way.values) > self._steps.number + 1:
            return self._refused(None)
        try:
            motion, closed = self._along(problem, way, SideSteps.none(), largest.base)
            if motion is None and aside and largest.base < np.inf and problem.mode.has_thrusters:
                axes = np.flatnonzero(np.ptp(problem.base_window, axis=0) > 0.0)
                sides = SideSteps.around(axes, _ASIDE[len(axes)], largest.base)
                motion, closed = self._along(problem, way, sides, largest.base)
        except GoalInCollision:  # at the attitude to which this path leads
            return self._refused(None)
        if motion is None:
            return self._refused(closed)
        length, value = stations_objective(problem, motion)
        if self.best is None or value < self.best.objective:
            self.best = TimedRun(problem, motion, length, value)
        self._note(value)
        return value

    def _along(
        self, problem: Problem, way: PathWay, sides: SideSteps, fastest: float
    ) -> tuple[Motion | None, int]:
        """The best run along a way, or the layer that cannot be reached."""
        steps = self._steps.number
        roadmap = ProgressRoadmap(
            problem, way, sides, steps, self._deadline, steps // (STATIONS + 1), fastest
        )
        search = ProgressSearch(roadmap, self._deadline)
        nodes = search.path()
        self._counts = self._counts.plus(roadmap.counts())
        if nodes is None:
            return None, search.closed_layer
        if not roadmap.is_proven(nodes):
            raise InternalError("a run whose edges are not all proven free")
        return way.motion(nodes[:, 0], roadmap.offsets[nodes[:, 1]]), steps

    def solution(self, branches: Branches, interrupted: bool) -> Solution:
        """The solution along the best run, of which there is one.

        Args:
            branches: of the trees, for pictures.
            interrupted: whether time limit or Ctrl-C ended the search.
        """
        best = self.best
        assert best is not None
        problem, motion, m = best.problem, best.motion, best.motion.edges
        self._deadline.close()
        still, pace = np.zeros((m + 1, 3)), problem.pace(m)
        prover = Prover(motion, problem.obstacles, problem.tolerance, self._deadline, pace)
        clearances = prover.clearances(np.arange(m + 1), still)
        least, cut = proven_clearance(prover, still, clearances)
        return Solution(
            lattice=None,
            motion=motion,
            nodes=frozen(np.zeros(0, dtype=np.int64)),
            length=best.length,
            objective=best.objective,
            lattice_objective=best.objective,
            optimum=min(least_objective(problem), best.objective),
            optimum_is_exact=False,
            clearances=frozen(clearances),
            history=History.of_rows(np.array(self._rows)),
            trails=branches,
            certificate=Certificate(*self._counts, least, problem.robot.unchecked_links),
            interrupted=interrupted or cut,
        )

    def _note(self, value: float) -> None:
        assert self.best is not None
        best = self.best.objective
        self._rows.append((best, value, value, len(self._rows) + 1.0))

    def _refused(self, layer: int | None) -> float:
        """No run: the time is kept at which the path was closed."""
        pace = self._problem.pace(self._steps.number)
        if layer is not None and pace is not None:
            self.closed_at = float(pace.instants(np.array(float(layer))))
        return np.inf

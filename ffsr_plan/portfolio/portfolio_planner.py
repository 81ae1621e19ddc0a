"""`Portfolio`: a planner on the lattice and a search by trees, and the better of their paths."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np

from ffsr_plan.core.errors import (
    InvalidInput,
    PathNotFound,
    PlanningError,
    StartInCollision,
    WorkerDied,
)
from ffsr_plan.core.setting_rules import Number
from ffsr_plan.core.settings import settings
from ffsr_plan.portfolio.lattice_left_out import without_lattice
from ffsr_plan.portfolio.lattice_planners import ByName, OnLattice, default_on_lattice
from ffsr_plan.problem.free_objective import stations_objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import SearchRequest, Solution
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.tree_planner import TreePlanner


@settings
class Portfolio:
    """A planner on the lattice, then a search by trees that begins with its path.

    The trees search the same problem without its lattice; the window is the default one, or wider,
    so that all nodes of the lattice lie in it. They improve the path of the lattice as well as
    those that they find themselves. The plan is the one with the lower F, and of two that are alike
    that of the lattice. F is the same measure for both: that of a problem without a lattice, which
    counts the clearance at 39 stations along the path and not at nodes.

    The problem of the plan tells which it is: it has the lattice and its `optimum`, or none.
    History, trails and certificate are those of the one search. If only one finds a path, it is
    taken. Without a lattice this is the search by trees alone.

    Attributes:
        lattice: the planner on the lattice; by default `PostureAnnealing()` on one with posture
            axes, `MaxMinAntSystem()` on others.
        trees: the search by trees; by default `TreePlanner()`.
        lattice_share: of the time limit, at most spent on the lattice; what it leaves is for the
            trees.
    """

    name: ClassVar[str] = "portfolio"
    exact: ClassVar[bool] = False

    lattice: Annotated[OnLattice, ByName()] | None = None
    trees: TreePlanner | None = None
    lattice_share: Annotated[float, Number(above=0.0, below=1.0)] = 0.5

    def part(self, problem: Problem) -> OnLattice | TreePlanner:
        """The planner of a problem: on its lattice, or the trees where it has none."""
        if problem.lattice is None:
            return self.trees or TreePlanner()
        return self.lattice or default_on_lattice(problem.lattice)

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the planner on the lattice cannot solve the problem."""
        if problem.lattice is not None and problem.lattice.progress is not None:
            raise InvalidInput("planner", self.name, "lattice-optimum on a lattice with progress")
        self.part(problem).refuse(problem)

    def solve(self, problem: Problem, rng: np.random.Generator, request: SearchRequest) -> Solution:
        """Search the lattice, then the whole space.

        Each of the two draws the random numbers that it would draw alone.

        Args:
            problem: the problem.
            rng: source of randomness.
            request: colonies, workers and refinement on the lattice; callback and stopping
                condition of both.

        Raises:
            InvalidInput: what either of the two refuses.
            StartInCollision: with all links and obstacles that touch.
            GoalInCollision: as for `TreePlanner`.
            PathNotFound: neither found a path; with what the planner on the lattice said.
            OutOfTime: by the deadline, in the proof of the first path of the trees.
            WorkerDied: a worker process ended without a result.
        """
        if problem.lattice is None:
            return self.part(problem).solve(problem, rng, request)
        deadline = request.deadline or Deadline()
        request, twin = request._replace(deadline=deadline), copy.deepcopy(rng)
        on_lattice, said = self._on_lattice(problem, rng, request)
        if on_lattice is not None and deadline.stopped():
            return on_lattice
        free = without_lattice(problem)
        try:
            by_trees = self.part(free).solve(
                free,
                twin,
                SearchRequest(
                    on_cycle=request.on_cycle,
                    deadline=deadline,
                    incumbent=None if on_lattice is None else on_lattice.motion,
                ),
            )
        except PlanningError as error:
            if on_lattice is not None:
                return on_lattice._replace(interrupted=on_lattice.interrupted or deadline.passed())
            if isinstance(error, PathNotFound):
                raise replace(error, on_lattice=said) from None
            raise
        if on_lattice is None:
            return by_trees
        _, value = stations_objective(free, on_lattice.motion)
        best = on_lattice if value <= by_trees.objective else by_trees
        return best._replace(interrupted=on_lattice.interrupted or by_trees.interrupted)

    def _on_lattice(
        self, problem: Problem, rng: np.random.Generator, request: SearchRequest
    ) -> tuple[Solution | None, str]:
        """What the planner on the lattice finds, or why it finds nothing."""
        planner, deadline = self.part(problem), request.deadline or Deadline()
        if planner.exact and request.colonies > 1:
            allowed = f"1 with {planner.name}: it has one result"
            raise InvalidInput("colonies", request.colonies, allowed)
        request = request._replace(deadline=deadline.part(self.lattice_share))
        try:
            return planner.solve(problem.ending_at(problem.goal), rng, request), ""
        except (StartInCollision, WorkerDied):
            raise
        except PlanningError as error:
            return None, str(error)

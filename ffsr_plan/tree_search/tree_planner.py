"""`TreePlanner`: the planner for problems without a lattice."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import settings
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import SearchRequest, Solution
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.tree_settings import MOST_CHECKS, TreeSettings

_DEFAULT_CHECKS = 1_200_000  # about five seconds


@settings
class TreePlanner(TreeSettings):
    """Trees through the whole space of base position and joints; the default without a lattice.

    Twin trees from start and goal carry the attitude that the reaction brings about. Searches start
    again and again with other lengths of edges; paths are improved by random moves and by shortest
    paths around them, and the best are proven free edge by edge. The plan is the best of those that
    are proven. See the page on the tree search.

    Work is counted in configurations checked against obstacles and links, so that a seed gives the
    same plan on any machine; a million of them take some five seconds.

    Among bodies that move, many paths are found past what is at rest, and each is run in time as
    well as it can be, with waits and ways back; the best run is the plan.

    The settings are those of `TreeSettings`.
    """

    __doc__ += "\n" + (TreeSettings.__doc__ or "").partition("\n\n")[2]
    name: ClassVar[str] = "tree-planner"
    exact: ClassVar[bool] = False

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the problem has a lattice, naming planners for it."""
        if problem.lattice is not None:
            allowed = "max-min-ant-system, ant-system or lattice-optimum on a lattice, and "
            allowed += "posture-annealing on one with posture axes; portfolio runs the trees too"
            raise InvalidInput("planner", self.name, allowed)

    def solve(self, problem: Problem, rng: np.random.Generator, request: SearchRequest) -> Solution:
        """Search the configuration space and prove the best path.

        Args:
            problem: a problem without a lattice.
            rng: source of randomness.
            request: callback and stopping condition; one search by one process.

        Raises:
            InvalidInput: the problem has a lattice, or the request is for several colonies or for
                refinement, which is part of the search.
            StartInCollision: with all links and obstacles that touch.
            GoalInCollision: the same for the goal, where its attitude does not matter or is held.
            PathNotFound: with what was tried, and what is in the way.
            OutOfTime: by the deadline, in the proof of the first path.
        """
        from ffsr_plan.search.timed_runs import TimedRuns, TimeSteps
        from ffsr_plan.tree_search.search_in_time import SearchInTime
        from ffsr_plan.tree_search.search_rounds import SearchRounds

        self.refuse(problem)
        if request.refine:
            raise InvalidInput("refine", True, "False or None without a lattice")
        if request.colonies > 1:
            raise InvalidInput("colonies", request.colonies, "1 without a lattice")
        deadline = request.deadline or Deadline()
        deadline.stage = "the proof of the first path"
        request = request._replace(deadline=deadline)
        checks = self.checks or (MOST_CHECKS if deadline.is_limited else _DEFAULT_CHECKS)
        if problem.scene.moves:
            steps = TimeSteps(self.time_steps, self.base_speed, self.joint_speed)
            runs = TimedRuns(problem, steps, deadline)
            search = SearchInTime(problem, self, rng, request.monitor(), runs)
            if request.incumbent is not None:
                search.begin_with(request.incumbent)
            return search.solution(search.run(checks, request.first))
        rounds = SearchRounds(problem, self, rng, request.monitor())
        if request.incumbent is not None:
            rounds.begin_with(request.incumbent)
        interrupted = rounds.run(checks, request.first)
        return rounds.solution(interrupted, deadline.elapsed())

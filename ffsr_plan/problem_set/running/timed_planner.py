"""A planner of this package as the problem set runs it: its costs over time, its plan judged."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from typing import Any

from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.planning.plan_and_refine import plan
from ffsr_plan.plans.planner_registry import planner_of
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.judging.judgement import judged
from ffsr_plan.trajectory.trajectory import Trajectory

DURATION = 100.0  # [s] of trajectories where nothing moves


@dataclass(frozen=True)
class TimedPlanner:
    """A planner with a clock.

    Attributes:
        planner: its name; None for the default of each problem.
    """

    planner: str | None = None

    @property
    def name(self) -> str:
        """The planner's name."""
        return self.planner or "default"

    def plan(
        self, problem: Problem, seed: int, time_limit: float | None = None
    ) -> tuple[Trajectory, dict[str, Any]]:
        """The trajectory of a plan, and its figures: seconds, curve and judgement.

        Args:
            problem: what to plan.
            seed: of the random numbers.
            time_limit: [s].

        Raises:
            FfsrPlanError: see `ffsr_plan.plan`.
        """
        curve = list[tuple[float, float]]()
        begin = time.perf_counter()

        def look(cycle: Any) -> None:  # noqa: ANN401 - a Cycle or a TreeCycle
            best = float(cycle.best)
            if math.isfinite(best) and (not curve or best < curve[-1][1]):
                curve.append((round(time.perf_counter() - begin, 4), best))

        watched = None if planner_of(self.planner, problem).exact else look
        made = plan(
            problem,
            self.planner,
            seed,
            time_limit=time_limit,
            on_cycle=watched,
            on_interrupt="raise",
        )
        trajectory = trajectory_of(made, duration=problem.duration or DURATION)
        cost = made.objective
        if not curve or cost < curve[-1][1]:
            curve.append((round(made.seconds, 4), float(cost)))
        kept = [pair for pair in curve if pair[0] <= made.seconds] or [(made.seconds, cost)]
        figures = {
            "planning_seconds": made.seconds,
            "curve": kept,
            "judgement": asdict(judged("", problem, trajectory)),
        }
        return trajectory, figures

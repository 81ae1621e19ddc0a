"""The best plans known, improved: planned again, verified, judged, and kept where better.

    python -m ffsr_plan.problem_set.making.best_known --time 10 [--family NAME] [--rounds 1]

Problems on which least time was spent come first, so that it can be cut and called again.
"""

from __future__ import annotations

import argparse
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from ffsr_plan.core.errors import FfsrPlanError, GoalPoseIgnored
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.trajectory_files import read_trajectory
from ffsr_plan.planning.certified_plan import Plan
from ffsr_plan.planning.plan_and_refine import plan
from ffsr_plan.plans.planner_registry import default_planner
from ffsr_plan.problem.free_objective import STATIONS
from ffsr_plan.problem.objective import motion_objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.bench_problem import BenchProblem
from ffsr_plan.problem_set.best_plans import BestPlan, BestPlans
from ffsr_plan.problem_set.judging.judgement import judge
from ffsr_plan.problem_set.judging.result_files import read_results
from ffsr_plan.problem_set.making.rebuilt_plans import verification_faults
from ffsr_plan.problem_set.set_index import DATA, ProblemSet
from ffsr_plan.studies.tasks.row import package_version

DURATION = 100.0  # [s] of trajectories where nothing moves


def bound_of(problem: Problem) -> tuple[float, str]:
    """F that no motion falls below, and how it was made.

    Args:
        problem: the problem.
    """
    cap = np.inf if problem.clearance_cap is None else problem.clearance_cap
    pieces = np.full(STATIONS + 1, cap)
    least = motion_objective(problem, _straight_length(problem), pieces)
    far = "" if problem.clearance_cap is None else ", obstacles as far as counts"
    return least, f"straight way{far}"


def _straight_length(problem: Problem) -> float:
    """Length that no path falls below [m].

    It is that of the straight way to the nearest of all goals that are whole turns of revolute
    joints away, as a posture is the same there.
    """
    robot, change = problem.robot, problem.joint_displacement.copy()
    begin = robot.joint_values(problem.start)
    for k in np.flatnonzero(~robot.prismatic):
        turns = change[k] + 2.0 * np.pi * np.arange(-3, 4)
        inside = (begin[k] + turns >= robot.lower[k]) & (begin[k] + turns <= robot.upper[k])
        change[k] = min([change[k], *turns[inside].tolist()], key=abs)
    slide = robot.prismatic
    metres = np.concatenate([problem.base_displacement, change[slide]]) * problem.position_weight
    radians = np.append(change[~slide], problem.held_rotation) * problem.rotation_weight
    return float(np.sqrt(np.sum(metres**2) + np.sum(radians**2)))


def with_bounds(problems: ProblemSet, known: BestPlans) -> None:
    """Work out all bounds again, and put them beside the best plans.

    Args:
        problems: the set.
        known: the best plans.
    """
    for name in problems.names():
        row = known.get(name)
        if row is not None:
            bound, how = bound_of(problems[name].problem)
            known.put(replace(row, bound=bound, bound_by=how), None)


def improved(given: BenchProblem, known: BestPlans, seconds: float) -> str:
    """Plan a problem once more, and keep what is better.

    Args:
        given: the problem.
        known: the best plans; what was found is put there.
        seconds: time limit of the planner [s].

    Returns:
        What came of it, in a few words.
    """
    problem = given.problem
    old = known.get(given.name) or BestPlan(given.name, *bound_of(problem))
    seed = 0 if not old.tried else int(old.tried * 1000) % 100_000
    begin = time.perf_counter()
    unsolved = old.tried > 0.0 and old.objective is None
    lattice = problem.lattice
    off_lattice = unsolved and lattice is not None and lattice.progress is None
    planner = "portfolio" if off_lattice else None  # trees find what a lattice does not hold
    try:
        made = plan(problem, planner, seed, time_limit=seconds, on_interrupt="raise")
    except FfsrPlanError as error:
        spent = time.perf_counter() - begin
        known.put(replace(old, tried=round(old.tried + spent, 3)), None)
        return f"{type(error).__name__}: {str(error)[:90]}"
    spent = round(old.tried + time.perf_counter() - begin, 3)
    if not made.verify().ok:
        known.put(replace(old, tried=spent), None)
        return "NOT VERIFIED"
    trajectory = trajectory_of(made, duration=problem.duration or DURATION)
    verdict = judge(given, trajectory)
    if not verdict.accepted:
        known.put(replace(old, tried=spent), None)
        return f"REFUSED: {verdict.reason}"
    row = replace(
        old,
        length=verdict.length,
        objective=verdict.objective,
        delta_v=verdict.delta_v,
        clearance=verdict.clearance,
        planner=made.planner.name,
        seed=seed,
        seconds=round(made.seconds, 3),
        version=package_version(),
        tried=spent,
        lattice_objective=float(made.lattice_objective) if problem.lattice else None,
        lattice_optimum=_lattice_optimum(made),
        verified=True,
    )
    if old.objective is not None and row.objective is not None and old.objective <= row.objective:
        known.put(replace(old, tried=spent), None)
        return f"F {row.objective:.4f}, {old.objective:.4f} stays"
    known.put(row, trajectory)
    return f"F {row.objective:.4f}, L {row.length:.3f} m, {made.seconds:.1f} s"


def _lattice_optimum(made: Plan) -> float | None:
    """F of Eq. 8 of the exact optimum of the lattice; None where it is not known."""
    exact = made.problem.lattice is not None and made.optimum_is_exact
    return float(made.optimum) if exact else None


def adopted(folder: Path, problems: ProblemSet, known: BestPlans) -> list[str]:
    """Keep what is better in a folder of results, judged once more.

    Args:
        folder: with `results.json`.
        problems: the set.
        known: the best plans; what is better is put there.

    Returns:
        Names of the problems with a better plan.

    Raises:
        InvalidInput: see `read_results`.
    """
    results, better = read_results(folder), []
    for result in results.rows:
        if result.trajectory is None:
            continue
        given = problems[result.problem]
        old = known.get(given.name) or BestPlan(given.name, *bound_of(given.problem))
        trajectory = read_trajectory(folder / result.trajectory)
        verdict = judge(given, trajectory)
        if verdict.objective is None or verdict.objective >= (old.objective or np.inf):
            continue
        own = default_planner(given.problem.lattice).name
        row = replace(
            old,
            length=verdict.length,
            objective=verdict.objective,
            delta_v=verdict.delta_v,
            clearance=verdict.clearance,
            planner=own if results.planner == "default" else results.planner,
            seed=result.seed,
            seconds=round(result.seconds, 3),
            version=package_version(),
            lattice_objective=None,
            verified=not verification_faults(given, trajectory),
        )
        known.put(row, trajectory)
        better.append(given.name)
    return better


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--time", type=float, help="limit of a plan [s]; that of the problem without"
    )
    parser.add_argument("--family", help="only this one")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--missing", action="store_true", help="only problems without a plan")
    parser.add_argument("--bounds", action="store_true", help="only work out the bounds again")
    parser.add_argument("--results", type=Path, help="only keep what is better in this folder")
    parser.add_argument("--data", type=Path, default=DATA)
    given = parser.parse_args()
    warnings.simplefilter("ignore", GoalPoseIgnored)
    problems, known = ProblemSet(given.data), BestPlans(given.data)
    if given.results is not None:
        print("better:", ", ".join(adopted(given.results, problems, known)) or "none")
        return
    if given.bounds:
        with_bounds(problems, known)
        return
    for _ in range(given.rounds):
        names = problems.names(given.family)

        def spent(name: str) -> tuple[float, str]:
            row = known.get(name)
            return 0.0 if row is None else row.tried, name.partition("/")[2]

        for name in sorted(names, key=spent):
            row = known.get(name)
            if given.missing and row is not None and row.objective is not None:
                continue
            problem = problems[name]
            said = improved(problem, known, given.time or problem.time_limit)
            print(f"{name} ({problem.title}): {said}", flush=True)


if __name__ == "__main__":
    main()

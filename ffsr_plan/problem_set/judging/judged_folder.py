"""A folder of results judged: every trajectory, whatever its file says of itself."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ffsr_plan.core.errors import FfsrPlanError, InvalidInput
from ffsr_plan.formats.trajectory_files import read_trajectory
from ffsr_plan.problem_set.judging.judgement import Judgement, judge
from ffsr_plan.problem_set.judging.result_files import (
    Judged,
    JudgedRow,
    Result,
    read_results,
    write_judged,
)
from ffsr_plan.problem_set.set_index import ProblemSet


def judge_folder(
    folder: Path, problems: ProblemSet, on_row: Callable[[JudgedRow], object] | None = None
) -> Judged:
    """Judge all results of a folder, and write `judged.json` there.

    Args:
        folder: with `results.json`.
        problems: the set.
        on_row: called with each row.

    Raises:
        InvalidInput: a file of another format, results for another version of the set, or an
            unknown problem. A trajectory that cannot be read is refused, and its row says why.
    """
    results = read_results(folder)
    if results.set_version != problems.version:
        what = f"set_version in '{folder}'"
        raise InvalidInput(what, results.set_version, f"version {problems.version} of the set")
    if not results.rows:
        raise InvalidInput(f"results in '{folder}'", [], "at least one")
    rows = []
    for result in results.rows:
        rows.append(row_of(result, problems, _judgement(folder, result, problems)))
        if on_row is not None:
            on_row(rows[-1])
    judged = Judged(results.planner, results.set_version, tuple(rows))
    write_judged(folder, judged)
    return judged


def _judgement(folder: Path, result: Result, problems: ProblemSet) -> Judgement:
    problem = problems[result.problem]
    if result.trajectory is None:
        return Judgement(result.problem, False, result.reason or "no trajectory")
    try:
        given = read_trajectory(folder / result.trajectory)
    except FfsrPlanError as error:
        return Judgement(result.problem, False, str(error))
    return judge(problem, given)


def row_of(result: Result, problems: ProblemSet, judgement: Judgement) -> JudgedRow:
    """The row of a result.

    Args:
        result: what the planner says.
        problems: the set.
        judgement: what was judged.
    """
    entry = problems.entry(result.problem)
    return JudgedRow(
        result.problem,
        entry["family"],
        result.seed,
        judgement.accepted,
        judgement.reason,
        result.seconds,
        entry["time_limit"],
        judgement.length,
        judgement.objective,
        judgement.delta_v,
        judgement.clearance,
        scaled(result, judgement.objective),
    )


def scaled(result: Result, objective: float | None) -> tuple[tuple[float, float], ...]:
    """The cost over time, scaled so that its last value is F as judged.

    A planner's own cost may count clearances at other places; where it has no curve, its only
    path comes at its end.

    Args:
        result: what the planner says.
        objective: F as judged; None where it was refused.
    """
    if objective is None:
        return ()
    curve = result.curve or ((result.seconds, 1.0),)
    last = curve[-1][1]
    factor = objective / last if last > 0.0 else 0.0
    return tuple((seconds, cost * factor) for seconds, cost in curve)

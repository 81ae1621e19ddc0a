"""`run`: a planner on problems of the set, as a study that can be cut and goes on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import number, unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.plans.planner_registry import PLANNERS
from ffsr_plan.problem_set.judging.judged_folder import row_of
from ffsr_plan.problem_set.judging.judgement import Judgement
from ffsr_plan.problem_set.judging.result_files import (
    RESULTS,
    Judged,
    JudgedRow,
    Result,
    Results,
    read_results,
    write_judged,
    write_results,
)
from ffsr_plan.problem_set.running import ompl_peers
from ffsr_plan.problem_set.running.bench_sources import BenchSource
from ffsr_plan.problem_set.running.timed_planner import TimedPlanner
from ffsr_plan.problem_set.set_index import ProblemSet
from ffsr_plan.studies.study import Study
from ffsr_plan.studies.tasks.given_values import given_planners, given_seeds
from ffsr_plan.studies.tasks.grid import Grid

STUDY = "study"
"""Name of the study's folder in that of the results."""


def planner_named(name: str | None) -> Any:  # noqa: ANN401 - any planner of a study
    """A planner by its name.

    Args:
        name: None for the default of each problem, or the name of a planner.

    Raises:
        InvalidInput: an unknown name.
    """
    if name is None or name == "default" or name in PLANNERS:
        return TimedPlanner(None if name == "default" else name)
    if name in ompl_peers.PLANNERS:
        return ompl_peers.OmplPlanner(*ompl_peers.PLANNERS[name])
    raise unknown_name("planner", name, ["default", *PLANNERS, *ompl_peers.PLANNERS])


def run(
    problems: ProblemSet,
    folder: Path,
    names: Sequence[str],
    *,
    planner: str | None = None,
    seeds: int | Sequence[int] = 1,
    time_limit: float | None = None,
    workers: int = 1,
    progress: bool = True,
) -> Judged:
    """Run a planner on problems, and write its results and what was judged of them.

    What has a row in the folder's study is not planned again, and results of other problems that
    the same planner has left there stay among the results.

    Args:
        problems: the set.
        folder: for study, results and judgements; with results of this planner, or none.
        names: of the problems.
        planner: see `planner_named`.
        seeds: see `Study`.
        time_limit: for all problems [s]; None for that of each problem.
        workers: processes.
        progress: whether to show progress.

    Raises:
        InvalidInput: an argument that is not allowed, or a folder with other results.
    """
    limits = {name: problems.entry(name)["time_limit"] for name in names}
    if time_limit is not None:
        limits = dict.fromkeys(names, number("time", time_limit, above=0.0))
    made = planner_named(planner)
    _refuse_other_results(folder, made.name)
    study = Study.__new__(Study)
    study.title = f"problem set {problems.version}, {made.name}"
    study.grid = Grid(
        [_source(problems, name) for name in names],
        given_planners({made.name: made}, None),
        given_seeds(seeds),
        limits,
    )
    result = study.run(folder / STUDY, workers=workers, progress=progress)
    latest: dict[tuple[str, int], dict[str, Any]] = {}  # of several times, the one that ended last
    for row in sorted(result.rows(), key=lambda row: str(row["finished"])):
        if row["planner"] == made.name and row["seed"] is not None:
            latest[row["problem"], row["seed"]] = row
    order = {name: place for place, name in enumerate(problems.names())}
    rows = sorted(latest.values(), key=lambda row: (order[row["problem"]], row["seed"]))
    return _written(problems, folder, made.name, rows)


def _refuse_other_results(folder: Path, planner: str) -> None:
    """Raise `InvalidInput` where results of another planner, or by hand, would be replaced."""
    if not (folder / RESULTS).exists():
        return
    there = read_results(folder).planner
    if there != planner or not (folder / STUDY).exists():
        allowed = f"a folder without results of anybody but '{planner}'; it has those of '{there}'"
        raise InvalidInput("out", str(folder), allowed)


def _source(problems: ProblemSet, name: str) -> BenchSource:
    entry = problems.entry(name)
    return BenchSource(name, entry["family"], entry["sha256"], str(problems.folder))


def _written(
    problems: ProblemSet, folder: Path, planner: str, rows: Sequence[dict[str, Any]]
) -> Judged:
    """Results and judgements of the rows of a study, written."""
    results, found = list[Result](), list[JudgedRow]()
    for row in rows:
        result, judgement = _result(row)
        results.append(result)
        found.append(row_of(result, problems, judgement))
    write_results(folder, Results(planner, problems.version, tuple(results)))
    made = Judged(planner, problems.version, tuple(found))
    write_judged(folder, made)
    return made


def _result(row: dict[str, Any]) -> tuple[Result, Judgement]:
    figures, name = row["figures"], row["problem"]
    if "judgement" not in figures:
        reason = f"{row['error']}: {row['message']}"
        spent = row["seconds"] or row["wall"] or 0.0
        return Result(name, None, spent, row["seed"], (), reason), Judgement(name, False, reason)
    path = None if row["plan"] is None else f"{STUDY}/{row['plan']}"
    curve = tuple((float(t), float(cost)) for t, cost in figures["curve"])
    seconds = float(figures["planning_seconds"])
    judgement = Judgement(**figures["judgement"] | {"problem": name})
    return Result(name, path, seconds, row["seed"], curve), judgement

"""The page of judged results: tables and pictures in one file that needs no network."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_text
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.judging.result_files import Judged
from ffsr_plan.problem_set.report.figures import bench_figures
from ffsr_plan.problem_set.report.summary import by_key, compared, family_table, in_common, reasons
from ffsr_plan.problem_set.set_index import ProblemSet
from ffsr_plan.studies.report.page import page


def write_page(path: Path, judged: Sequence[Judged], problems: ProblemSet) -> None:
    """Write the page.

    Args:
        path: of the file, replaced if it exists.
        judged: rows of planners; two of one name are told apart by their places.
        problems: the set.

    Raises:
        InvalidInput: no rows, or a file that cannot be written.
    """
    if not any(each.rows for each in judged):
        raise InvalidInput("results", len(judged), "results with at least one row")
    named = _told_apart(judged)
    best = BestPlans(problems.folder)
    tables = [family_table(each, problems, best) for each in named]
    tables += [compared(named[0], other, problems) for other in named[1:]]
    if any(not row.accepted for each in named for row in each.rows):
        tables.append(reasons(named))
    shared = in_common(named)
    alike = len({frozenset(by_key(each)) for each in shared}) == 1
    figures = bench_figures(shared, problems.families, best)
    known = sum(row.objective is not None for name in problems.names() if (row := best.get(name)))
    sentences = [
        f"Problem set {problems.version}: {len(problems)} problems in {len(problems.families)} "
        f"families, {known} of them with a known plan. Every trajectory is judged by certify.",
        "Success and cost over time: until the first path that is proven free, and F of the best "
        "one by then; tasks without a path count as infinite. Profiles: Dolan and More (2002).",
        f"Pictures are of the tasks that {'all planners have' if alike else 'each has'}: "
        + ", ".join(f"{len(each.rows)} of {each.planner}" for each in shared)
        + ". A task is a problem with a seed.",
        "F is that of the whole motion at 40 pieces of equal length, the same for every planner.",
    ]
    write_text("page", path, page("ffsr-plan bench", sentences, tables, figures))


def _told_apart(judged: Sequence[Judged]) -> list[Judged]:
    names = [each.planner for each in judged]
    return [
        Judged(f"{each.planner} ({k + 1})", each.set_version, each.rows)
        if names.count(each.planner) > 1
        else each
        for k, each in enumerate(judged)
    ]

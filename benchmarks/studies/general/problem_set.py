"""The problem set: the default planner, and OMPL's for a base at rest or with a guess of it.

    python -m benchmarks.studies.general.problem_set --count 10 --ompl 5

runs the first problems of each family within their times, and OMPL's RRTConnect on fewer of them
(needs `pip install ompl`). Runs that are there already are not repeated.
"""

import argparse
from pathlib import Path

from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.problem_set.report.bench_page import write_page
from ffsr_plan.problem_set.report.summary import compared, family_table, reasons
from ffsr_plan.problem_set.running.bench_run import run
from ffsr_plan.problem_set.set_index import ProblemSet

OMPL = ("ompl-rrtconnect-at-rest", "ompl-rrtconnect-straight")


def chosen(problems, count):
    """Names of the first problems of each family."""
    return [name for each in problems.families for name in problems.names(each)[:count]]


def markdown(made):
    """A table of the package as Markdown."""
    cells = ([cell.replace("|", "/") for cell in row] for row in made.rows)
    return table(made.headings, cells)


def report(problems, judged, options):
    """The page."""
    best = problems.best
    known = [row for name in problems.names() if (row := best.get(name)) and row.objective]
    ours, *others = judged
    parts = [
        "# The problem set",
        f"`python -m benchmarks.studies.general.problem_set {options}`",
        f"The default planner of each problem on {len(ours.rows)} of the {len(problems)} problems "
        "of [the problem set](../howto/problem_set.md), within their times, on one of two slow "
        f"cores that other work used too. A plan is known of {len(known)} problems.",
        markdown(family_table(ours, problems, best)),
        "*Refused* are trajectories that the judge does not accept, *no path* tasks that ended "
        "without one. Times include what other work took of the machine. The best plans known "
        "include those of this run, so that F is compared with more runs of the same planner.",
    ]
    for each in others:
        parts += [
            f"## {each.planner}",
            markdown(family_table(each, problems, best)),
            markdown(compared(ours, each, problems)),
        ]
    parts += ["## Not solved", markdown(reasons(judged, 20))]
    parts += [
        "- `at-rest` plans as if the base stood still. What collides does so with the base "
        "turning as its arms turn it; where an attitude is demanded it is missed.\n"
        "- `straight` assumes the attitude to which a straight motion from the start leads. It is "
        "exact on the first edge alone.\n"
        "- OMPL's planners have 5 s for each problem, leave lattices out, and refuse bodies "
        "that move and attitudes that wheels turn. Times are not comparable: OMPL's checks "
        "are called one by one from Python.\n"
    ]
    return "\n\n".join(parts)


def main():
    """Run what is missing, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10, help="problems of each family")
    parser.add_argument("--ompl", type=int, default=5, help="problems of each family for OMPL")
    parser.add_argument("--work", type=Path, default=Path("problem-set"), help="for results")
    parser.add_argument("--out", type=Path, default=RESULTS / "problem_set.md")
    given = parser.parse_args()
    problems = ProblemSet()
    names = chosen(problems, given.count)
    judged = [run(problems, given.work / "default", names)]
    for planner in OMPL:
        folder = given.work / planner
        few = chosen(problems, given.ompl)
        judged.append(run(problems, folder, few, planner=planner, time_limit=5.0))
    write_page(given.work / "bench.html", judged, problems)
    publish(report(problems, judged, f"--count {given.count} --ompl {given.ompl}"), given.out)


if __name__ == "__main__":
    main()

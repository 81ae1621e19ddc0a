"""Commands `ffsr-plan bench list | run | judge | compare | report | schema`."""

from __future__ import annotations

from typing import Annotated

import typer

from ffsr_plan.cli.console.terminal import errors_on_stderr

bench_app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="The problem set: run planners on it, judge results of anybody, compare them.",
)

Folder = Annotated[str, typer.Argument(metavar="DIRECTORY", help="Of results.")]
Family = Annotated[
    list[str] | None, typer.Option(help="Only this family; may be given several times.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]


@bench_app.command("list")
def show_list(family: Family = None, quiet: Quiet = False, as_json: Json = False) -> None:
    """List the families, or the problems of some, with the best plans known."""
    with errors_on_stderr():
        from ffsr_plan.cli.bench.tables import list_problems
        from ffsr_plan.cli.console.output import Output

        list_problems(family, Output(quiet, as_json))


@bench_app.command()
def run(
    family: Family = None,
    problem: Annotated[
        list[str] | None, typer.Option(help="Only this problem; may be given several times.")
    ] = None,
    planner: Annotated[
        str | None,
        typer.Option(help="Name of a planner, or ompl-... ; by default that of each problem."),
    ] = None,
    time: Annotated[
        float | None, typer.Option(help="Seconds of a plan; by default those of the problem.")
    ] = None,
    seed: Annotated[int, typer.Option(help="The first seed.")] = 0,
    seeds: Annotated[int, typer.Option(help="Number of seeds.")] = 1,
    workers: Annotated[int, typer.Option(help="Processes on this computer.")] = 1,
    out: Annotated[
        str, typer.Option(metavar="DIRECTORY", help="For results; a run that was cut goes on.")
    ] = "bench-results",
    force: Annotated[  # of no account, as in `study`: nothing that is there is replaced
        bool, typer.Option("--force", hidden=True)
    ] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Run a planner on the problems, and judge what it finds; exit status 1 if any is unsolved."""
    with errors_on_stderr():
        from ffsr_plan.cli.bench.running import Wanted, run_and_report
        from ffsr_plan.cli.console.output import Output

        wanted = Wanted(family, problem, planner, time, seed, seeds, workers, out)
        if not run_and_report(wanted, Output(quiet, as_json)):
            raise typer.Exit(1)


@bench_app.command()
def judge(directory: Folder, quiet: Quiet = False, as_json: Json = False) -> None:
    """Judge a directory of results by `certify`; exit status 1 if any is refused."""
    with errors_on_stderr():
        from ffsr_plan.cli.bench.running import judge_and_report
        from ffsr_plan.cli.console.output import Output

        if not judge_and_report(directory, Output(quiet, as_json)):
            raise typer.Exit(1)


@bench_app.command()
def compare(
    first: Folder,
    second: Annotated[str, typer.Argument(metavar="OTHER", help="Of other results.")],
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Two results side by side, by family, on the problems that both have."""
    with errors_on_stderr():
        from ffsr_plan.cli.bench.running import compare_and_report
        from ffsr_plan.cli.console.output import Output

        compare_and_report(first, second, Output(quiet, as_json))


@bench_app.command()
def report(
    directories: Annotated[
        list[str], typer.Argument(metavar="DIRECTORY...", help="Of judged results.")
    ],
    out: Annotated[str, typer.Option(metavar="PATH.html", help="The page.")] = "bench.html",
    force: Annotated[bool, typer.Option("--force", help="Replace an existing page.")] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Write one page: success and cost over time, profiles, gap and clearance by family."""
    with errors_on_stderr():
        from ffsr_plan.cli.bench.running import report_page
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.console.result_files import check_replacement

        check_replacement("--out", out, force)
        report_page(directories, out, Output(quiet, as_json))


@bench_app.command()
def schema(
    kind: Annotated[str, typer.Argument(help="problem, index or results.")] = "results",
) -> None:
    """Print the JSON Schema of the set's files."""
    with errors_on_stderr():
        import json

        from ffsr_plan.core.checks import one_of
        from ffsr_plan.problem_set.judging.schemas import SCHEMAS

        typer.echo(json.dumps(SCHEMAS[one_of("kind", kind, list(SCHEMAS))](), indent=2))

"""Commands `ffsr-plan study FILE.toml | report | schema`."""

from __future__ import annotations

import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from ffsr_plan.cli.console.terminal import errors_on_stderr

_COMMANDS = ("run", "report", "schema", "--help")


class RunByDefault(TyperGroup):
    """A group whose command `run` need not be named: `study FILE.toml`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:  # noqa: ANN401 - of Typer
        """Put `run` before what is no command."""
        if args and args[0] not in _COMMANDS:
            args = ["run", *args]
        return super().parse_args(ctx, args)


study_app = typer.Typer(
    cls=RunByDefault,
    no_args_is_help=True,
    add_completion=False,
    help="Studies of many plans: `study FILE.toml` runs one, or goes on with it.",
)

Directory = Annotated[str, typer.Argument(metavar="DIRECTORY", help="Of a study.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]


@study_app.command()
def run(
    file: Annotated[str, typer.Argument(metavar="FILE.toml", help="A study file.")],
    out: Annotated[
        str | None,
        typer.Option(metavar="DIRECTORY", help="For rows and plans; by default FILE-study."),
    ] = None,
    workers: Annotated[int, typer.Option(help="Processes on this computer.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler, tcp://HOST:PORT.")
    ] = None,
    retry_failed: Annotated[
        bool, typer.Option("--retry-failed", help="Repeat tasks that ended without a plan.")
    ] = False,
    force: Annotated[  # of no account, as in `plan`: nothing that is there is replaced
        bool, typer.Option("--force", hidden=True)
    ] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Plan each point of a study's grid that has no row yet; exit status 1 after a fault."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.study.running import run_and_report

        output = Output(quiet, as_json)
        command = ["ffsr-plan", *sys.argv[1:]]
        if run_and_report(file, out, workers, scheduler, retry_failed, output, command):
            raise typer.Exit(1)


@study_app.command()
def report(
    directory: Directory,
    out: Annotated[
        str | None,
        typer.Option(
            metavar="DIRECTORY",
            help="For the page and the pictures; by default report/ in the study's.",
        ),
    ] = None,
    csv: Annotated[
        str | None, typer.Option("--csv", metavar="PATH", help="Write the rows as CSV.")
    ] = None,
    parquet: Annotated[
        str | None, typer.Option("--parquet", metavar="PATH", help="Write the rows as Parquet.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace existing tables.")] = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Show the tables of a study, complete or not, and write its page and pictures."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.console.result_files import check_replacement
        from ffsr_plan.cli.study.running import report_study

        tables: dict[str, Any] = {"--csv": csv, "--parquet": parquet}
        for option, path in tables.items():
            if path is not None:
                check_replacement(option, path, force)
        report_study(directory, out, csv, parquet, Output(quiet, as_json))


@study_app.command()
def schema() -> None:
    """Print the JSON Schema of study files, for editors that complete and check TOML."""
    with errors_on_stderr():
        import json

        from ffsr_plan.studies.study_files.study_schema import study_schema

        typer.echo(json.dumps(study_schema(), indent=2))

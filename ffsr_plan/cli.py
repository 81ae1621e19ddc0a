"""The command line: `ffsr-plan demo | plan | verify | robots`.

Exit status: 0 done, 1 no plan or a plan that does not verify, 2 bad input.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer
from rich.console import Console
from rich.table import Table

from ffsr_plan.errors import FfsrPlanError, InvalidInput, PlanningError

if TYPE_CHECKING:
    from ffsr_plan.colony.records import Cycle
    from ffsr_plan.result import Plan
    from ffsr_plan.scenario import Scenario
    from ffsr_plan.verify import Report

T = TypeVar("T")
RESULTS = ("plan.json", "plan.html", "path.png", "clearance.png", "convergence.png")

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Collision-free motions of free-flying space robots, base reaction included.",
)
out_console = Console(highlight=False)
err_console = Console(stderr=True, highlight=False)

Out = Annotated[
    Path | None, typer.Option(help="Directory for plan.json, plan.html and the figures.")
]
Force = Annotated[bool, typer.Option("--force", help="Replace results that are there already.")]


@app.command()
def demo(out: Out = None, force: Force = False) -> None:
    """Plan, verify and show the paper's experiment (the bundled scenario fig2a)."""
    with _errors_on_stderr():
        target = _prepared(out, force) if out is not None else _unused(Path("ffsr-demo"))
        _plan_and_report("fig2a", None, None, target, check=True)


@app.command()
def plan(
    scenario: Annotated[str, typer.Argument(help="A TOML file, or a bundled name such as fig2b.")],
    planner: Annotated[
        str | None, typer.Option(help="Use this planner, at its defaults, not the scenario's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed, instead of the scenario's.")] = None,
    out: Out = None,
    force: Force = False,
    check: Annotated[
        bool, typer.Option("--verify/--no-verify", help="Re-check the plan independently.")
    ] = True,
) -> None:
    """Plan a scenario, verify the plan, and write it where --out says."""
    with _errors_on_stderr():
        target = _prepared(out, force) if out is not None else None
        _plan_and_report(scenario, planner, seed, target, check)


@app.command()
def verify(
    plan_file: Annotated[Path, typer.Argument(metavar="PLAN.json")],
    samples: Annotated[int, typer.Option(help="Distance checks per edge.")] = 2000,
) -> None:
    """Check a saved plan again, densely and independently of the planner."""
    with _errors_on_stderr():
        from ffsr_plan.result import Plan

        loaded = Plan.load(plan_file)
        report = _with_spinner("verifying", lambda: loaded.verify(samples))
        out_console.print(_report_table(report))
        if not report.ok:
            raise PlanningError("the plan does not verify: " + "; ".join(report.problems))


@app.command()
def robots() -> None:
    """List the bundled robots."""
    from ffsr_plan.robot import load_robot, robot_names

    table = Table("robot", "mass [kg]", "joints")
    for name in robot_names():
        robot = load_robot(name)
        mass = sum(body.mass for body in robot.model.inertias)
        table.add_row(name, f"{mass:g}", ", ".join(robot.joint_names) or "none")
    out_console.print(table)


def main() -> None:
    """Entry point of the `ffsr-plan` command."""
    app()


def _plan_and_report(
    source: str, planner_name: str | None, seed: int | None, target: Path | None, check: bool
) -> None:
    from ffsr_plan.inputs import one_of, whole_number
    from ffsr_plan.planner import PLANNERS
    from ffsr_plan.scenario import read_scenario

    scenario = read_scenario(source)
    if planner_name is not None:
        settings = PLANNERS[one_of("--planner", planner_name, list(PLANNERS))]()
        scenario = scenario._replace(planner=settings)
    if seed is not None:
        scenario = scenario._replace(seed=whole_number("--seed", seed, at_least=0))
    found = _planned(scenario)
    if target is not None:
        _write_results(found, scenario.title, target)
    report = _with_spinner("verifying", found.verify) if check else None
    out_console.print(_plan_table(scenario.title, found, report))
    if target is not None:
        out_console.print(f"Written to {target}: open {target / 'plan.html'} in a browser.")
    if report is not None and not report.ok:
        raise PlanningError("the plan does not verify: " + "; ".join(report.problems))


def _planned(scenario: Scenario) -> Plan:
    """Plan with a progress bar on a terminal, once it has taken a second."""
    from rich.progress import Progress

    from ffsr_plan.planner import plan as make_plan

    begin = time.monotonic()
    with Progress(console=err_console, transient=True, auto_refresh=False) as progress:
        task = progress.add_task("ants", visible=False)

        def show(cycle: Cycle) -> None:
            if err_console.is_terminal and time.monotonic() - begin > 1.0:
                progress.update(
                    task,
                    visible=True,
                    total=cycle.cycles,
                    completed=cycle.number,
                    description=f"ants, best F {cycle.best:.2f}",
                )
                progress.refresh()

        return make_plan(scenario.problem, scenario.planner, scenario.seed, on_cycle=show)


def _with_spinner(label: str, work: Callable[[], T]) -> T:
    with err_console.status(label):
        return work()


def _write_results(found: Plan, title: str, target: Path) -> None:
    from ffsr_plan.figures import write_figures

    try:
        target.mkdir(parents=True, exist_ok=True)
        found.save(target / "plan.json")  # first: whatever fails later, the plan is kept
        found.write_html(target / "plan.html", title)
        write_figures(found, target)
    except OSError as error:
        raise InvalidInput("--out", str(target), f"a writable directory ({error})") from None


def _prepared(target: Path, force: bool) -> Path:
    """Refuse before planning, not after, to overwrite results."""
    if target.exists() and not target.is_dir():
        raise InvalidInput("--out", str(target), "a directory")
    present = [name for name in RESULTS if (target / name).exists()]
    if present and not force:
        raise InvalidInput(
            "--out",
            str(target),
            f"a directory without {', '.join(present)}; --force replaces them",
        )
    return target


def _unused(base: Path) -> Path:
    candidate, number = base, 2
    while candidate.exists():
        candidate, number = base.with_name(f"{base.name}-{number}"), number + 1
    return candidate


def _plan_table(title: str, found: Plan, report: Report | None) -> Table:
    import numpy as np

    clearances, proof = found.clearances, found.certificate
    angles = np.degrees(found.arrival_attitude)
    table = Table(title=title or None, show_header=False, title_justify="left")
    table.add_row("length L", f"{found.length:.4f} m")
    table.add_row("objective F", f"{found.objective:.4f}")
    table.add_row(
        "clearance at nodes", f"least {clearances.min():.4f} m, mean {clearances.mean():.4f} m"
    )
    table.add_row("proven along the motion", f"at least {proof.least_clearance:.6f} m")
    table.add_row(
        "attitude on arrival",
        "alpha {:.3f}°, beta {:.3f}°, gamma {:.3f}°".format(*angles),
    )
    table.add_row(
        "certified",
        f"{proof.edges_free} edges free, {proof.edges_refused} refused, "
        f"{proof.node_queries} + {proof.edge_queries} distance queries (nodes + edges)",
    )
    cycles = len(found.history.best)
    table.add_row("planner", f"{found.planner.name}, seed {found.seed}, {cycles} cycles")
    table.add_row("time", f"{found.seconds:.2f} s")
    if report is not None:
        for name, value in _report_rows(report):
            table.add_row(name, value)
    return table


def _report_table(report: Report) -> Table:
    table = Table(show_header=False)
    for name, value in _report_rows(report):
        table.add_row(name, value)
    return table


def _report_rows(report: Report) -> Iterator[tuple[str, str]]:
    yield "verified", "yes" if report.ok else "NO: " + "; ".join(report.problems)
    yield "  samples", f"{report.samples}, at most {1e3 * report.largest_step:.2f} mm apart"
    yield "  least clearance", f"{report.least_clearance:.6f} m"
    yield "  least link-to-link", f"{report.least_self_separation:.6f} m"
    if report.momentum_residual is not None:
        yield "  momentum residual", f"{report.momentum_residual:.1e} relative"


@contextmanager
def _errors_on_stderr() -> Iterator[None]:
    try:
        yield
    except FfsrPlanError as error:
        err_console.print("ffsr-plan: ", error, sep="", style="red", markup=False)
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None

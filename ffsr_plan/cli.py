"""The command line: `ffsr-plan demo | plan | verify | view | export | timed | robots | schema`.

Exit status: 0 done (also with the best plan so far, after Ctrl-C during the search), 1 no plan or a
plan that does not verify, 2 bad input, 130 interrupted without a plan.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple, TypeVar

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

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
PlanFile = Annotated[Path, typer.Argument(metavar="PLAN.json")]
Port = Annotated[int, typer.Option(help="Port of the page on 127.0.0.1; 0 for any that is free.")]
Browser = Annotated[
    bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
]
Force = Annotated[bool, typer.Option("--force", help="Replace results that are there already.")]


def _print_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        out_console.print(f"ffsr-plan {version('ffsr-plan')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Say the version and stop."
        ),
    ] = False,
) -> None:
    """Options that stand before a command."""


@app.command()
def demo(out: Out = None, force: Force = False) -> None:
    """Plan, verify and show the scene of the paper's Fig. 2(a) with the default planner."""
    with _errors_on_stderr():
        target = _prepared(out, force) if out is not None else _unused(Path("ffsr-demo"))
        options = Options(planner="max-min-ant-system", refine=True)
        _plan_and_report("fig2a", options, target, check=True)


@app.command()
def plan(
    scenario: Annotated[str, typer.Argument(help="A TOML file, or a bundled name such as fig2b.")],
    planner: Annotated[
        str | None, typer.Option(help="Use this planner, at its defaults, not the scenario's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed, instead of the scenario's.")] = None,
    refine: Annotated[
        bool | None,
        typer.Option("--refine/--no-refine", help="Move the path off the lattice in the end."),
    ] = None,
    colonies: Annotated[int, typer.Option(help="Independent colonies; the best counts.")] = 1,
    workers: Annotated[int, typer.Option(help="Processes for them.")] = 1,
    time_limit: Annotated[
        float | None,
        typer.Option(help="Stop searching after so many seconds; refinement comes on top."),
    ] = None,
    out: Out = None,
    force: Force = False,
    duration: Annotated[
        float,
        typer.Option(
            help="Seconds that the motion takes, for the peak momentum of the wheels "
            "(attitude-held plans only; it goes as 1 / duration)."
        ),
    ] = 600.0,
    check: Annotated[
        bool, typer.Option("--verify/--no-verify", help="Re-check the plan independently.")
    ] = True,
    watch: Annotated[
        bool, typer.Option("--watch", help="Show the colony at work, then the plan.")
    ] = False,
    pace: Annotated[float, typer.Option(help="Least seconds a cycle takes while watched.")] = 0.0,
    port: Port = 0,
    browser: Browser = True,
) -> None:
    """Plan a scenario, verify the plan, and write it where --out says."""
    with _errors_on_stderr():
        target = _prepared(out, force) if out is not None else None
        if not watch and (port or pace):
            raise InvalidInput("--watch", False, "--watch together with --port or --pace")
        watched = Watched(port, browser, pace) if watch else None
        options = Options(planner, seed, refine, colonies, workers, time_limit, duration, watched)
        _plan_and_report(scenario, options, target, check)


@app.command()
def verify(
    plan_file: PlanFile,
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
def export(
    plan_file: PlanFile,
    table: Annotated[Path, typer.Argument(metavar="PATH.csv")],
    samples: Annotated[
        int | None, typer.Option(help="Rows, evenly spaced; without, one for each node.")
    ] = None,
    force: Force = False,
) -> None:
    """Write the path of a saved plan as a table, units in its header."""
    with _errors_on_stderr():
        from ffsr_plan.result import Plan

        _refuse_to_replace("PATH.csv", table, force)
        Plan.load(plan_file).to_csv(table, samples)


@app.command()
def timed(
    plan_file: PlanFile,
    joint_acceleration: Annotated[float | None, typer.Option(help="rad/s^2 or m/s^2")] = None,
    thruster_acceleration: Annotated[float | None, typer.Option(help="m/s^2")] = None,
    joint_velocity: Annotated[float | None, typer.Option(help="rad/s or m/s; the URDF's")] = None,
    base_velocity: Annotated[float | None, typer.Option(help="m/s")] = None,
    joint_torque: Annotated[float | None, typer.Option(help="N m or N")] = None,
    joint_jerk: Annotated[float | None, typer.Option(help="rad/s^3 or m/s^3")] = None,
    thruster_jerk: Annotated[float | None, typer.Option(help="m/s^3")] = None,
    turn_velocity: Annotated[float | None, typer.Option(help="rad/s")] = None,
    turn_acceleration: Annotated[float | None, typer.Option(help="rad/s^2")] = None,
    velocity_jump: Annotated[
        float, typer.Option(help="Pass corners of the base's path by pulses of so many m/s.")
    ] = 0.0,
    csv: Annotated[Path | None, typer.Option(help="Write the trajectory to this table.")] = None,
    rate: Annotated[float, typer.Option(help="Instants a second.")] = 10.0,
    force: Force = False,
) -> None:
    """Fly a saved plan as fast as limits allow: duration, delta-v, thrust, torques."""
    given = {k: v for k, v in locals().items() if k not in ("plan_file", "csv", "rate", "force")}
    with _errors_on_stderr():
        from ffsr_plan.cli_timed import flight_rows
        from ffsr_plan.result import Plan

        if csv is not None:
            _refuse_to_replace("--csv", csv, force)
        flown = Plan.load(plan_file).timed(**given)
        summary = Table(show_header=False)
        for name, value in flight_rows(flown, rate):
            summary.add_row(name, value)
        out_console.print(summary)
        if csv is not None:
            flown.to_csv(csv, rate)


@app.command()
def view(
    plan_file: PlanFile,
    port: Port = 0,
    browser: Browser = True,
) -> None:
    """Show a saved plan in the browser, served on 127.0.0.1 until Ctrl-C."""
    with _errors_on_stderr():
        from ffsr_plan.result import Plan

        Plan.load(plan_file).show(port, block=True, open_browser=browser)


@app.command()
def robots() -> None:
    """List the bundled robots, and the arms that `ffsr_plan.compose` mounts on a bus."""
    from ffsr_plan.arms import arm_names
    from ffsr_plan.catalog import robot_summaries

    table = Table("robot", "kg", "reach", "postures", "joints", show_lines=True)
    for robot in robot_summaries():
        count = len(robot.joint_names)
        table.add_row(
            f"{robot.name}\n{count} joint{'' if count == 1 else 's'}",
            f"{robot.mass:.4g}",
            f"{robot.reach:.2f} m",
            "\n".join(robot.postures),
            "\n".join(robot.joint_names),
        )
    out_console.print(table)
    out_console.print(f"Arms for a bus of your own: {', '.join(arm_names())}")


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files, for editors that complete and check TOML."""
    import json

    from ffsr_plan.scenario_tables import schema as scenario_schema

    typer.echo(json.dumps(scenario_schema(), indent=2))


def main() -> None:
    """Entry point of the `ffsr-plan` command."""
    app()


class Watched(NamedTuple):
    """How the colony is shown while it works."""

    port: int
    browser: bool
    pace: float


class Options(NamedTuple):
    """What the command line may say otherwise than the scenario."""

    planner: str | None = None
    seed: int | None = None
    refine: bool | None = None
    colonies: int = 1
    workers: int = 1
    time_limit: float | None = None
    duration: float = 600.0
    watched: Watched | None = None


def _plan_and_report(source: str, options: Options, target: Path | None, check: bool) -> None:
    from ffsr_plan.inputs import number, one_of, whole_number
    from ffsr_plan.planner import PLANNERS
    from ffsr_plan.scenario import read_scenario

    duration = number("--duration", options.duration, above=0.0)
    scenario = read_scenario(source)
    if options.planner is not None:
        settings = PLANNERS[one_of("--planner", options.planner, list(PLANNERS))]()
        scenario = scenario._replace(planner=settings)
    if options.seed is not None:
        scenario = scenario._replace(seed=whole_number("--seed", options.seed, at_least=0))
    if options.refine is not None:
        scenario = scenario._replace(refine=options.refine)
    found = _planned(scenario, options) if options.watched is None else _shown(scenario, options)
    if target is not None:
        _write_results(found, scenario.title, target)
    report = _with_spinner("verifying", found.verify) if check else None
    out_console.print(_plan_table(scenario.title, found, report, duration))
    if target is not None:
        out_console.print(f"Written to {target}: open {target / 'plan.html'} in a browser.")
    if report is not None and not report.ok:
        raise PlanningError("the plan does not verify: " + "; ".join(report.problems))


def _shown(scenario: Scenario, options: Options) -> Plan:
    """Plan while a page shows the colony, and in the end the plan."""
    from ffsr_plan.live import LiveView

    watched = options.watched
    assert watched is not None
    if options.colonies > 1:
        raise InvalidInput("--watch", f"{options.colonies} colonies", "a single colony to look at")
    view = LiveView(
        scenario.problem, watched.port, open_browser=watched.browser, pace=watched.pace,
        title=scenario.title,
    )  # fmt: skip
    with view:
        err_console.print(f"{view.url} shows the colony at work")
        found = _planned(scenario, options, view.on_cycle)
        view.finish(found)
    return found


def _planned(
    scenario: Scenario, options: Options, on_cycle: Callable[[Cycle], None] | None = None
) -> Plan:
    """Plan with a progress bar on a terminal, once it has taken a second."""
    from rich.progress import Progress

    from ffsr_plan.planner import plan as make_plan

    begin, followed = time.monotonic(), err_console.is_terminal
    with Progress(console=err_console, transient=True, auto_refresh=False) as progress:
        task = progress.add_task("ants", visible=False)

        def show(cycle: Cycle) -> None:
            if on_cycle is not None:
                on_cycle(cycle)
            if followed and time.monotonic() - begin > 1.0:
                progress.update(
                    task,
                    visible=True,
                    total=cycle.cycles,
                    completed=cycle.number,
                    description=f"ants, best F {cycle.best:.2f}",
                )
                progress.refresh()

        return make_plan(
            scenario.problem,
            scenario.planner,
            scenario.seed,
            refine=scenario.refine,
            colonies=options.colonies,
            workers=options.workers,
            time_limit=options.time_limit,
            on_cycle=show if options.colonies == 1 and (followed or on_cycle) else None,
        )


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
    existing = next(p for p in (target, *target.absolute().parents) if p.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK):
        raise InvalidInput("--out", str(target), "a directory that can be written")
    present = [name for name in RESULTS if (target / name).exists()]
    if present and not force:
        raise InvalidInput(
            "--out",
            str(target),
            f"a directory without {', '.join(present)}; --force replaces them",
        )
    return target


def _refuse_to_replace(what: str, path: Path, force: bool) -> None:
    if path.exists() and not force:
        raise InvalidInput(what, str(path), "a file that is not there yet; --force replaces it")


def _unused(base: Path) -> Path:
    candidate, number = base, 2
    while candidate.exists():
        candidate, number = base.with_name(f"{base.name}-{number}"), number + 1
    return candidate


def _plan_table(title: str, found: Plan, report: Report | None, duration: float) -> Table:
    import numpy as np

    from ffsr_plan.result import proven

    clearances, proof = found.clearances, found.certificate
    angles = np.degrees(found.arrival_attitude)
    heading = Text(title) if title else None  # not markup: titles may hold brackets
    table = Table(title=heading, show_header=False, title_justify="left")
    table.add_row("length L", f"{found.length:.4f} m")
    table.add_row("objective F", f"{found.objective:.4f}")
    table.add_row(
        "on the lattice",
        f"F {found.lattice_objective:.4f}, "
        + ("optimum" if found.optimum_is_exact else "lower bound")
        + f" {found.optimum:.4f}, gap {found.gap:.3%}",
    )
    table.add_row(
        "clearance at nodes", f"least {clearances.min():.4f} m, mean {clearances.mean():.4f} m"
    )
    table.add_row("proven along the motion", f"at least {proven(proof.least_clearance)}")
    table.add_row(
        "attitude on arrival",
        "alpha {:.3f}°, beta {:.3f}°, gamma {:.3f}°".format(*angles),
    )
    if found.arrival_attitude_error is not None:
        missed = np.degrees(found.arrival_attitude_error)
        table.add_row("goal attitude", f"missed by {missed:.2g}°, brought about by the arms")
    if found.problem.mode == "attitude-held":
        wheels = found.wheel_momentum(duration)
        table.add_row(
            f"wheels, if it takes {duration:g} s",
            "peak x {:.3g}, y {:.3g}, z {:.3g} N m s in base axes".format(*wheels.axis_peaks),
        )
    table.add_row(
        "certified",
        f"{proof.edges_free} edges free, {proof.edges_refused} refused, "
        f"{proof.node_queries} + {proof.edge_queries} distance queries (nodes + edges)",
    )
    cycles = len(found.history.best)
    early = ", interrupted: the best so far" if found.interrupted else ""
    ran = f", seed {found.seed}, {cycles} cycles" if len(found.trails.layer) else ""
    table.add_row("planner", f"{found.planner.name}{ran}{early}")
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
    yield "verified", "yes" if report.ok else "NO, see below"
    yield "  samples", f"{report.samples}, at most {1e3 * report.largest_step:.2f} mm apart"
    yield "  least clearance", f"{report.least_clearance:.6f} m"
    yield "  least link-to-link", f"{report.least_self_separation:.6f} m"
    if report.momentum_residual is not None:
        yield "  momentum residual", f"{report.momentum_residual:.1e} relative"
    if report.center_drift is not None:
        yield "  centre of mass", f"stays put within {report.center_drift:.1e} m"
    if report.wheel_momentum_error is not None:
        yield "  wheel momentum error", f"{report.wheel_momentum_error:.1e} relative"


@contextmanager
def _errors_on_stderr() -> Iterator[None]:
    try:
        yield
    except FfsrPlanError as error:
        err_console.print("ffsr-plan: ", error, sep="", style="red", markup=False)
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except KeyboardInterrupt:
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(130) from None

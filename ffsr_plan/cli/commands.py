"""Commands `ffsr-plan demo | plan | verify | certify | view | export | gif | timed | ...`.

What a command needs is loaded when it runs: `--help` needs none of it.

Exit status: 0 done (also with the best plan so far, after Ctrl-C during the search), 1 no plan or a
plan that does not verify, 2 bad input, 70 an error of the program itself, 130 interrupted: before
there was a plan, or once more.
"""

from __future__ import annotations

import io
import signal
import sys
from pathlib import Path
from typing import Annotated

import typer

from ffsr_plan.cli.console.terminal import errors_on_stderr, out_console
from ffsr_plan.search.interruption import end_command

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Collision-free motions of free-flying space robots, base reaction included.",
)

# Paths are texts here: a `Path` of an empty text is the current folder, into which nobody means to
# write five files.
Out = Annotated[
    str | None,
    typer.Option(metavar="DIRECTORY", help="Directory for plan.json, plan.html and the figures."),
]
PlanFile = Annotated[str, typer.Argument(metavar="PLAN.json")]
Until = Annotated[
    str, typer.Option(help="first: the first proven path is enough, without a lattice.")
]
Port = Annotated[int, typer.Option(help="Port of the page on 127.0.0.1; 0 for any free one.")]
Browser = Annotated[
    bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
]
FigureFile = Annotated[
    str | None,
    typer.Option(metavar="PATH", help="Draw path, speed, thrust and joints: .pdf, .svg or .png."),
]
PageFile = Annotated[
    str | None, typer.Option(metavar="PATH.html", help="Write a page that plays in true time.")
]
MovieFile = Annotated[
    str | None,
    typer.Option(metavar="PATH", help="Write a moving picture: .gif, .png or .mp4 (by ffmpeg)."),
]
MovieSpeed = Annotated[
    float | None,
    typer.Option("--movie-speed", help="Times as fast as the flight; by default 12 s or less."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace existing results.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of tables.")]


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
            "--version", callback=_print_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Options before a command."""


@app.command()
def demo(
    out: Out = None, force: Force = False, quiet: Quiet = False, as_json: Json = False
) -> None:
    """Plan, verify and show the scene of the paper's Fig. 2(a) with the default planner."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.console.result_files import check_target, unused_path
        from ffsr_plan.cli.planning import Options, plan_and_report

        output = Output(quiet, as_json)
        target = check_target(out, force) if out is not None else unused_path(Path("ffsr-demo"))
        options = Options(planner="max-min-ant-system", refine=True)
        plan_and_report("fig2a", options, target, check=True, output=output)


@app.command()
def plan(
    scenario: Annotated[str, typer.Argument(help="A TOML file, or a bundled name such as fig2b.")],
    planner: Annotated[
        str | None, typer.Option(help="Use this planner, at its defaults, not the scenario's.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Seed, instead of the scenario's.")] = None,
    refine: Annotated[
        bool | None,
        typer.Option("--refine/--no-refine", help="Move the path off the lattice at the end."),
    ] = None,
    colonies: Annotated[
        int, typer.Option(help="Independent colonies; the best path is taken.")
    ] = 1,
    workers: Annotated[int, typer.Option(help="Processes for the colonies.")] = 1,
    time_limit: Annotated[
        float | None,
        typer.Option(help="Seconds for the planning; the best proven path is kept."),
    ] = None,
    until: Until = "end",
    out: Out = None,
    force: Force = False,
    duration: Annotated[
        float,
        typer.Option(
            help="Duration of the motion in seconds, for the peak momentum of the wheels "
            "(attitude-held plans only; proportional to 1 / duration)."
        ),
    ] = 600.0,
    check: Annotated[
        bool, typer.Option("--verify/--no-verify", help="Verify the plan independently.")
    ] = True,
    watch: Annotated[
        bool, typer.Option("--watch", help="Show the search in the browser, then the plan.")
    ] = False,
    pace: Annotated[float, typer.Option(help="Least seconds per cycle with --watch.")] = 0.0,
    port: Port = 0,
    browser: Browser = True,
    pictures: Annotated[
        bool, typer.Option("--pictures/--no-pictures", help="Draw the figures of --out.")
    ] = True,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Plan a scenario, verify the plan, and write it to the directory --out."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.console.result_files import check_target
        from ffsr_plan.cli.planning import LiveOptions, Options, plan_and_report
        from ffsr_plan.core.errors import InvalidInput

        output = Output(quiet, as_json)
        target = check_target(out, force) if out is not None else None
        if not watch and (port or pace):
            raise InvalidInput("--watch", False, "--watch together with --port or --pace")
        live = LiveOptions(port, browser, pace) if watch else None
        options = Options(
            planner, seed, refine, colonies, workers, time_limit, until, duration, live, pictures
        )
        plan_and_report(scenario, options, target, check, output)


@app.command()
def verify(
    plan_file: PlanFile,
    samples: Annotated[
        int | None,
        typer.Option(
            help="Least number of steps on each edge, 50 by default; halved where needed."
        ),
    ] = None,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Verify a saved plan all along its motion, independently of the planner."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.saved_plans import verify_and_report

        verify_and_report(plan_file, samples, Output(quiet, as_json))


@app.command()
def export(
    plan_file: PlanFile,
    table: Annotated[str, typer.Argument(metavar="PATH.csv")],
    samples: Annotated[
        int | None, typer.Option(help="Evenly spaced rows; one per node by default.")
    ] = None,
    force: Force = False,
) -> None:
    """Write the path of a saved plan as a CSV table with units in its header."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.result_files import check_replacement
        from ffsr_plan.planning.certified_plan import Plan

        check_replacement("PATH.csv", table, force)
        Plan.load(plan_file).to_csv(table, samples)


@app.command()
def gif(
    plan_file: PlanFile,
    picture: Annotated[str, typer.Argument(metavar="PATH.gif")],
    frames: Annotated[int, typer.Option(help="Number of pictures.")] = 60,
    width: Annotated[int, typer.Option(help="Width in pixels.")] = 720,
    side_view: Annotated[bool, typer.Option("--side", help="Seen from the side.")] = False,
    force: Force = False,
) -> None:
    """Write a saved plan as an animated GIF."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.result_files import check_replacement
        from ffsr_plan.planning.certified_plan import Plan

        check_replacement("PATH.gif", picture, force)
        view = "side" if side_view else "path"
        Plan.load(plan_file).write_gif(picture, frames=frames, width=width, view=view)


@app.command()
def timed(
    plan_file: PlanFile,
    corners: Annotated[
        str, typer.Option(help="smooth: along a proven smooth curve; rest: a rest at each corner.")
    ] = "smooth",
    duration: Annotated[
        float | None,
        typer.Option(help="Seconds that a smooth flight takes; by default the fewest."),
    ] = None,
    joint_acceleration: Annotated[float | None, typer.Option(help="rad/s^2 or m/s^2")] = None,
    thruster_acceleration: Annotated[float | None, typer.Option(help="m/s^2")] = None,
    joint_velocity: Annotated[
        float | None, typer.Option(help="rad/s or m/s; by default the URDF's")
    ] = None,
    base_velocity: Annotated[float | None, typer.Option(help="m/s")] = None,
    joint_torque: Annotated[float | None, typer.Option(help="N m or N")] = None,
    joint_jerk: Annotated[float | None, typer.Option(help="rad/s^3 or m/s^3")] = None,
    thruster_jerk: Annotated[float | None, typer.Option(help="m/s^3")] = None,
    turn_velocity: Annotated[float | None, typer.Option(help="rad/s")] = None,
    turn_acceleration: Annotated[float | None, typer.Option(help="rad/s^2")] = None,
    velocity_jump: Annotated[
        float,
        typer.Option(help="Velocity change in m/s of pulses at corners, with --corners rest."),
    ] = 0.0,
    csv: Annotated[
        str | None, typer.Option(metavar="PATH", help="Write the trajectory to this table.")
    ] = None,
    rate: Annotated[float, typer.Option(help="Rows per second of --csv.")] = 10.0,
    figure: FigureFile = None,
    page: PageFile = None,
    movie: MovieFile = None,
    speed: MovieSpeed = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Time a saved plan within limits: duration, delta-v, thrust, torques."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.saved_plans import FlightFiles, time_and_report

        limits = {
            "corners": corners,
            "duration": duration,
            "joint_acceleration": joint_acceleration,
            "thruster_acceleration": thruster_acceleration,
            "joint_velocity": joint_velocity,
            "base_velocity": base_velocity,
            "joint_torque": joint_torque,
            "joint_jerk": joint_jerk,
            "thruster_jerk": thruster_jerk,
            "turn_velocity": turn_velocity,
            "turn_acceleration": turn_acceleration,
            "velocity_jump": velocity_jump,
        }
        files = FlightFiles(csv, rate, figure, page, movie, speed)
        time_and_report(plan_file, limits, files, force, Output(quiet, as_json))


@app.command()
def view(
    plan_file: PlanFile,
    port: Port = 0,
    browser: Browser = True,
) -> None:
    """Show a saved plan in the browser, served on 127.0.0.1 until Ctrl-C."""
    with errors_on_stderr():
        from ffsr_plan.planning.certified_plan import Plan

        shown = Plan.load(plan_file).show(port, block=False, open_browser=browser)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        shown.wait(f"{shown.url} shows the plan until Ctrl-C")


@app.command()
def certify(
    trajectory: Annotated[str, typer.Argument(help="A table or message of joints over time.")],
    urdf: Annotated[str, typer.Option(help="The robot: a .urdf file, or a bundled name.")],
    scene: Annotated[str | None, typer.Option(help="The obstacles, or a scenario.")] = None,
    mode: Annotated[
        list[str] | None,
        typer.Option(help="free-floating, free-flying or attitude-held; also several times."),
    ] = None,
    base_mass: Annotated[
        float | None, typer.Option(help="kg of a bus that the root link is fixed to.")
    ] = None,
    base_inertia: Annotated[
        str | None, typer.Option(help="Its moments in kg m^2, as 50,50,50; by default kg / 4.")
    ] = None,
    srdf: Annotated[str | None, typer.Option(help="Pairs of links that may touch.")] = None,
    package_dir: Annotated[list[str] | None, typer.Option(help="ROS packages of meshes.")] = None,
    lock: Annotated[list[str] | None, typer.Option(help="A fixed joint, finger=0.04.")] = None,
    visual: Annotated[bool, typer.Option(help="Take visual shapes where others lack.")] = False,
    balance: Annotated[bool, typer.Option(help="Mend inertias that no body has.")] = False,
    interpolation: Annotated[str | None, typer.Option(help="linear or cubic.")] = None,
    topic: Annotated[str | None, typer.Option(help="Of a bag, the only one read.")] = None,
    frame: Annotated[str | None, typer.Option(help="The end effector.")] = None,
    tolerance: Annotated[float, typer.Option(help="Clearance in m that is not proven.")] = 1e-4,
    page: PageFile = None,
    force: Force = False,
    quiet: Quiet = False,
    as_json: Json = False,
) -> None:
    """Judge any trajectory: proven free when the base reacts, or the first contact."""
    with errors_on_stderr():
        from ffsr_plan.certification import certified_files as files
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.console.result_files import check_replacement
        from ffsr_plan.cli.printed_tables import side_by_side

        output = Output(quiet, as_json)
        if page is not None:
            check_replacement("--page", page, force)
        robot = files.RobotFile(
            urdf, srdf, package_dir or (), lock or (), base_mass, base_inertia, visual, balance
        )
        options = {"interpolation": interpolation, "topic": topic, "frame": frame}
        modes = mode or ["free-floating"]
        reports = files.certify_files(trajectory, robot, scene, modes, tolerance, **options)
        if page is not None:
            reports[0].write_html(page)
        output.show(
            lambda: [side_by_side(modes, [files.report_rows(r) for r in reports])],
            lambda: {"reports": [files.report_figures(r) for r in reports]},
        )
        if not all(report.free for report in reports):
            raise typer.Exit(1)


@app.command()
def robots() -> None:
    """List the bundled robots, and the arms that `ffsr_plan.compose` can mount on a bus."""
    with errors_on_stderr():
        from ffsr_plan.cli.printed_tables import robot_table
        from ffsr_plan.robots.summary import robot_summaries
        from ffsr_plan.satellites.arms import arm_names

        out_console.print(robot_table(robot_summaries()))
        out_console.print(f"Arms for your own bus: {', '.join(arm_names())}")


@app.command()
def literature(quiet: Quiet = False, as_json: Json = False) -> None:
    """Recompute numbers from publications; exit status 1 if one is off its tolerance."""
    with errors_on_stderr():
        from ffsr_plan.cli.console.output import Output
        from ffsr_plan.cli.printed_tables import show_numbers

        if not show_numbers(Output(quiet, as_json)):
            raise typer.Exit(1)


@app.command()
def warm_up() -> None:
    """Compile all numerical kernels now, for images of containers and for measurements."""
    with errors_on_stderr():
        from ffsr_plan.cli.kernel_warm_up import warm_up_and_report

        warm_up_and_report()


@app.command()
def schema() -> None:
    """Print the JSON Schema of scenario files, for editors that complete and check TOML."""
    with errors_on_stderr():
        import json

        from ffsr_plan.scenario_files.scenario_schema import schema as scenario_schema

        typer.echo(json.dumps(scenario_schema(), indent=2))


def main() -> None:
    """Run a command of `ffsr-plan`, and exit."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # names of files may hold what it cannot encode
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        signal.signal(signal.SIGINT, end_command)
        app()
    finally:  # the exit status is decided
        signal.signal(signal.SIGINT, signal.SIG_IGN)

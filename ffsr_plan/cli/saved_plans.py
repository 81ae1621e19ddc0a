"""The commands `verify` and `timed`: figures and times of a plan that was saved."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, NamedTuple

from ffsr_plan.cli.console.result_files import check_replacement
from ffsr_plan.cli.console.terminal import with_progress
from ffsr_plan.cli.flight_figures import flight_figures
from ffsr_plan.cli.plan_figures import report_figures
from ffsr_plan.cli.printed_tables import flight_table, report_table
from ffsr_plan.cli.step_times import StepTimes
from ffsr_plan.core.errors import PlanNotVerified

if TYPE_CHECKING:
    from ffsr_plan.cli.console.output import Output
    from ffsr_plan.planning.certified_plan import Plan
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan


def verify_and_report(plan_file: str, samples: int | None, output: Output) -> None:
    """Verify a saved plan and show the report.

    Args:
        plan_file: path of the plan.
        samples: least number of steps on each edge; None for the default.
        output: where the report is shown.

    Raises:
        PlanNotVerified: it does not verify; the report is shown before.
        InvalidInput: no such plan, or samples that are not allowed.
    """
    times = StepTimes()
    plan = _loaded(plan_file, times)
    with times.step("verification", "verification"):
        report = with_progress(
            "verifying", lambda told: plan.verify(samples, told), not output.quiet
        )
    output.show(
        lambda: [report_table(report)],
        lambda: {"report": report_figures(report), "times": times.seconds(), "files": []},
    )
    if not report.ok:
        raise PlanNotVerified(report.problems)


class FlightFiles(NamedTuple):
    """Files that the command `timed` writes; None for those that it does not.

    Attributes:
        csv: table of the trajectory.
        rate: rows per second in it.
        figure: PDF, SVG or PNG.
        page: HTML.
        movie: GIF, PNG or MP4.
        speed: of the movie, how many times as fast as the flight.
    """

    csv: str | None
    rate: float
    figure: str | None
    page: str | None
    movie: str | None
    speed: float | None

    def named(self) -> dict[str, str]:
        """The paths that are given, by the names of their options."""
        options = ("--csv", "--figure", "--page", "--movie")
        paths = (self.csv, self.figure, self.page, self.movie)
        return {name: path for name, path in zip(options, paths, strict=True) if path is not None}

    def write(self, flight: SmoothFlight | TimedPlan) -> None:
        """Write all files."""
        if self.csv is not None:
            flight.to_csv(self.csv, self.rate)
        if self.figure is not None:
            flight.write_figure(self.figure)
        if self.page is not None:
            flight.write_html(self.page)
        if self.movie is not None:
            flight.write_movie(self.movie, speed=self.speed)


def time_and_report(
    plan_file: str,
    limits: dict[str, Any],
    files: FlightFiles,
    force: bool,
    output: Output,
) -> None:
    """Time a saved plan, show its figures and write its trajectory and pictures.

    Args:
        plan_file: path of the plan.
        limits: arguments of `Plan.timed`.
        files: what is written.
        force: whether files may be replaced.
        output: where the figures are shown.

    Raises:
        InvalidInput: no such plan, limits that are not allowed, or a file that cannot be written.
        PlanNotVerified: the flight does not verify; it is written and printed before.
    """
    for option, path in files.named().items():
        check_replacement(option, path, force)
    times = StepTimes()
    plan = _loaded(plan_file, times)
    with times.step("timing", "timing"):
        flight = plan.timed(**limits)
        figures = flight_figures(flight)
    with times.step("verification", "verification"):
        report = flight.verify()
    if files.named():
        with times.step("writing", "files"):
            files.write(flight)
    output.show(
        lambda: [flight_table(figures, report)],
        lambda: {
            "flight": figures._asdict(),
            "report": asdict(report),
            "times": times.seconds(),
            "files": list(files.named().values()),
        },
    )
    if not report.ok:
        raise PlanNotVerified(report.problems)


def _loaded(plan_file: str, times: StepTimes) -> Plan:
    with times.step("loading", "loading the program"):
        from ffsr_plan.planning.certified_plan import Plan
    with times.step("reading", "reading the plan"):
        return Plan.load(plan_file)

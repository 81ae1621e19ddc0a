"""The commands `verify` and `timed`: figures and times of a plan that was saved."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ffsr_plan.cli.flight_figures import flight_figures
from ffsr_plan.cli.plan_figures import report_figures
from ffsr_plan.cli.printed_tables import flight_table, report_table
from ffsr_plan.cli.result_files import check_replacement
from ffsr_plan.cli.step_times import StepTimes
from ffsr_plan.cli.terminal import with_progress
from ffsr_plan.core.errors import PlanNotVerified

if TYPE_CHECKING:
    from ffsr_plan.cli.output import Output
    from ffsr_plan.planning.certified_plan import Plan


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


def time_and_report(
    plan_file: str,
    limits: dict[str, Any],
    csv: str | None,
    rate: float,
    force: bool,
    output: Output,
) -> None:
    """Time a saved plan, show its figures and write its trajectory.

    Args:
        plan_file: path of the plan.
        limits: arguments of `Plan.timed`.
        csv: file for the trajectory, or None.
        rate: rows per second in it.
        force: whether it may be replaced.
        output: where the figures are shown.

    Raises:
        InvalidInput: no such plan, limits that are not allowed, or a file that cannot be written.
    """
    if csv is not None:
        check_replacement("--csv", csv, force)
    times = StepTimes()
    plan = _loaded(plan_file, times)
    with times.step("timing", "timing"):
        flight = plan.timed(**limits)
        figures = flight_figures(flight)
    if csv is not None:
        with times.step("writing", "table"):
            flight.to_csv(csv, rate)
    output.show(
        lambda: [flight_table(figures)],
        lambda: {
            "flight": figures._asdict(),
            "times": times.seconds(),
            "files": [] if csv is None else [csv],
        },
    )


def _loaded(plan_file: str, times: StepTimes) -> Plan:
    with times.step("loading", "loading the program"):
        from ffsr_plan.planning.certified_plan import Plan
    with times.step("reading", "reading the plan"):
        return Plan.load(plan_file)

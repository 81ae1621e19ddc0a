"""Tables that commands print: plans, reports, timed plans, robots, numbers from publications."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table
from rich.text import Text

from ffsr_plan.core.formatting import counted
from ffsr_plan.plans.plan_summary import plan_rows

if TYPE_CHECKING:
    from ffsr_plan.cli.console.output import Output
    from ffsr_plan.cli.flight_figures import FlightFigures
    from ffsr_plan.cli.step_times import StepTimes
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.published_numbers.recomputed_number import RecomputedNumber
    from ffsr_plan.robots.summary import RobotSummary
    from ffsr_plan.verification.flights.verify_flight import FlightReport
    from ffsr_plan.verification.verify import Report


def plan_table(title: str, plan: PlanData, report: Report | None, duration: float) -> Table:
    """A plan, and its verification report if there is one.

    Args:
        title: above the table, may be empty.
        plan: the plan.
        report: of the verification.
        duration: of the motion [s], for the peak momentum of the wheels.
    """
    rows = plan_rows(plan, duration)
    return _two_columns([*rows, *(report_rows(report) if report else [])], title)


def report_table(report: Report) -> Table:
    """A verification report."""
    return _two_columns(report_rows(report))


def times_table(times: StepTimes) -> Table:
    """The times that the steps of a command took."""
    return _two_columns(times.rows(), "Time taken")


def flight_table(flight: FlightFigures, report: FlightReport) -> Table:
    """A timed plan: duration, delta-v, peak loads, and its verification."""
    return _two_columns([*flight_rows(flight), *flight_report_rows(report)])


def side_by_side(titles: Sequence[str], columns: Sequence[Sequence[tuple[str, str]]]) -> Table:
    """Names and values of things of one kind, a column each; a name that one lacks is a blank.

    Args:
        titles: of the columns.
        columns: names and values of each.
    """
    table = Table("")
    for title in titles:
        table.add_column(Text(title))  # not markup: titles may hold brackets
    names = dict.fromkeys(name for column in columns for name, _ in column)
    for name in names:
        table.add_row(name, *(dict(column).get(name, "") for column in columns))
    return table


def robot_table(robots: Iterable[RobotSummary]) -> Table:
    """Mass, size, postures and joints of robots."""
    table = Table("robot", "kg", "reach", "postures", "joints", show_lines=True)
    for robot in robots:
        table.add_row(
            "\n".join(_robot_words(robot)),
            f"{robot.mass:.4g}",
            f"{robot.reach_bound:.2f} m",
            "\n".join(robot.postures),
            "\n".join(robot.joint_names),
        )
    return table


def show_numbers(output: Output) -> bool:
    """Print numbers from publications beside those computed here; whether all agree."""
    from ffsr_plan.published_numbers.literature import literature

    numbers = literature()
    output.show(
        lambda: (literature_table(numbers), sources_text(numbers)),
        lambda: {"numbers": [asdict(each) | {"ok": each.ok} for each in numbers]},
    )
    return all(each.ok for each in numbers)


def literature_table(numbers: Iterable[RecomputedNumber]) -> Table:
    """Numbers from publications beside those computed here."""
    right = {"justify": "right"}
    table = Table("number", title="Numbers from the literature", title_justify="left")
    for heading in ("expected", "computed", "tolerance"):
        table.add_column(heading, **right)  # type: ignore[arg-type]
    table.add_column("agrees")
    for each in numbers:
        quantity = f"{each.quantity} [{each.unit}]" if each.unit else each.quantity
        table.add_row(
            Text(quantity),
            f"{each.expected:.8g}",
            f"{each.computed:.8g}",
            f"{each.tolerance:.0e}",
            f"{'yes' if each.ok else 'NO'}, {each.basis}",
        )
    return table


def sources_text(numbers: Sequence[RecomputedNumber]) -> Text:
    """Sources of numbers from publications, and what differs from them."""
    lines = []
    for source in dict.fromkeys(each.source for each in numbers):
        lines.append(source)
        own = (each for each in numbers if each.source == source and each.differs)
        lines += [f"  {differs}" for differs in dict.fromkeys(each.differs for each in own)]
    return Text("\n".join(lines))


def _robot_words(robot: RobotSummary) -> Iterator[str]:
    yield robot.name
    yield counted(len(robot.joint_names), "joint")
    if robot.unchecked_links:
        yield f"not checked: {', '.join(robot.unchecked_links)}"


def report_rows(report: Report) -> Iterator[tuple[str, str]]:
    """Names and values of a verification report."""
    yield "verified", "yes" if report.ok else "NO, see below"
    hidden = "nothing can be hidden between them"
    if report.largest_gap > 0.0:
        hidden = f"a contact may be hidden between two, {report.largest_gap:.1e} m apart"
    yield "  samples", f"{report.samples}, {hidden}"
    if np.isfinite(report.least_clearance):  # there are obstacles
        least = report.least_clearance
        bound = np.floor(1e6 * report.clearance_bound) / 1e6  # a lower bound stays one
        yield "  least clearance", f"{least:.6f} m measured, at least {bound:.6f} m between samples"
    if report.nearest_time is not None:
        near = report.nearest_body or "an obstacle at rest"
        yield "  nearest obstacle", f"{near}, at {report.nearest_time:.6g} s"
    if np.isfinite(report.least_self_separation):
        yield "  least link-to-link", f"{report.least_self_separation:.6f} m measured"
    if report.momentum_residual is not None:
        yield "  momentum residual", f"{report.momentum_residual:.1e} relative"
    if report.center_drift is not None:
        yield "  centre of mass", f"moves by at most {report.center_drift:.1e} m"
    if report.wheel_momentum_error is not None:
        yield "  wheel momentum error", f"{report.wheel_momentum_error:.1e} relative"
    if report.unchecked:
        yield "  links not checked", ", ".join(report.unchecked)
    yield "  not checked", "\n".join(report.not_checked)


def flight_report_rows(report: FlightReport) -> Iterator[tuple[str, str]]:
    """Names and values of the verification report of a flight."""
    yield "verified", "yes" if report.ok else "NO, see below"
    base = f"{report.position_error:.1e} m and {report.attitude_error:.1e} rad"
    yield "  base", f"within {base} of its integration"
    worst = max(report.thrust_error, report.torque_error, report.wheel_error)
    yield "  thrust and torques", f"within {worst:.1e} of their peaks by inverse dynamics"
    for name, share in report.limits.items():
        yield f"  {name}", f"{share:.1%} of the limit"
    if np.isfinite(report.least_clearance):
        least = report.least_clearance
        bound = np.floor(1e6 * report.clearance_bound) / 1e6  # a lower bound stays one
        yield "  least clearance", f"{least:.6f} m measured, at least {bound:.6f} m between samples"
    yield "  not checked", "\n".join(report.not_checked)


def flight_rows(flight: FlightFigures) -> Iterator[tuple[str, str]]:
    """Names and values of a timed plan."""
    yield "duration", f"{flight.duration:.2f} s"
    if flight.curve is not None:
        yield "smooth curve", flight.curve
    where = ", at corners of the path" if flight.rests else ""
    yield "rests on the way", f"{flight.rests}{where}"
    if flight.pulses:
        largest, longest = flight.largest_pulse, flight.longest_pulse
        text = f"{flight.pulses}, the largest {largest:.3g} m/s, the longest {longest:.3g} s"
        yield "pulses", text
        yield "corner cut by them", f"at most {flight.corner_cut:.3g} m"
    yield "delta-v of the translation", f"{flight.delta_v:.4g} m/s"
    if flight.straight_delta_v:
        yield "  along a straight line", f"{flight.straight_delta_v:.4g} m/s in the same time"
    yield "peak thrust", f"{flight.peak_thrust:.3g} N"
    for name, values, unit in (
        ("torque", flight.peak_wheel_torque, "N m"),
        ("momentum", flight.peak_wheel_momentum, "N m s"),
    ):
        if values is not None:
            x, y, z = values
            yield f"peak wheel {name}", f"x {x:.3g}, y {y:.3g}, z {z:.3g} {unit} in base axes"
    for loads, unit in ((flight.peak_joint_torques, "N m"), (flight.peak_joint_forces, "N")):
        for name, load in loads.items():
            yield f"peak of {name}", f"{load:.3g} {unit}"


def _two_columns(rows: Iterable[tuple[str, str]], title: str = "") -> Table:
    heading = Text(title) if title else None  # not markup: titles may hold brackets
    table = Table(title=heading, show_header=False, title_justify="left")
    for name, value in rows:
        table.add_row(name, value)
    return table

"""Plans, re-checks and flights in a few rows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from ffsr_plan.planning.plan import Plan
    from ffsr_plan.trajectory.timed_plan import TimedPlan
    from ffsr_plan.verification.verify import Report


def plan_table(title: str, found: Plan, report: Report | None, duration: float) -> Table:
    """What there is to know of a plan; peak momentum of wheels for a duration [s]."""
    from ffsr_plan.core.formatting import proven

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
    nodes = f"least {clearances.min():.4f} m, mean {clearances.mean():.4f} m"
    along = f"at least {proven(proof.least_clearance)}"
    if not len(found.problem.scene):
        nodes = along = "no obstacles"
    table.add_row("clearance at nodes", nodes)
    table.add_row("proven along the motion", along)
    table.add_row(
        "attitude on arrival",
        "alpha {:.3f}°, beta {:.3f}°, gamma {:.3f}°".format(*angles),
    )
    if found.arrival_attitude_error is not None:
        missed = np.degrees(found.arrival_attitude_error)
        table.add_row("goal attitude", f"missed by {missed:.2g}°, brought about by the arms")
    if found.problem.mode.has_wheels:
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
        for name, value in report_rows(report):
            table.add_row(name, value)
    return table


def report_table(report: Report) -> Table:
    """A re-check on its own."""
    table = Table(show_header=False)
    for name, value in report_rows(report):
        table.add_row(name, value)
    return table


def report_rows(report: Report) -> Iterator[tuple[str, str]]:
    """Names and values of a re-check."""
    yield "verified", "yes" if report.ok else "NO, see below"
    yield "  samples", f"{report.samples}, at most {1e3 * report.largest_step:.2f} mm apart"
    if np.isfinite(report.least_clearance):  # there are obstacles
        yield "  least clearance", f"{report.least_clearance:.6f} m"
    if np.isfinite(report.least_self_separation):
        yield "  least link-to-link", f"{report.least_self_separation:.6f} m"
    if report.momentum_residual is not None:
        yield "  momentum residual", f"{report.momentum_residual:.1e} relative"
    if report.center_drift is not None:
        yield "  centre of mass", f"stays put within {report.center_drift:.1e} m"
    if report.wheel_momentum_error is not None:
        yield "  wheel momentum error", f"{report.wheel_momentum_error:.1e} relative"


def flight_rows(flown: TimedPlan) -> Iterator[tuple[str, str]]:
    """Names and values; peaks are those of ten thousand instants."""
    robot, found = flown.motion.robot, flown.at(np.linspace(0.0, flown.duration, 10_001))
    yield "duration", f"{flown.duration:.2f} s"
    yield "rests on the way", f"{len(flown.rests)}, at corners of the path"
    if len(flown.pulses):
        largest = np.max(np.linalg.norm(flown.pulses, axis=1))
        yield "pulses", f"{len(flown.pulses)}, the largest {largest:.3g} m/s"
        yield "corner cut by them", f"at most {flown.corner_cut:.3g} m"
    yield "delta-v of the translation", f"{flown.delta_v:.4g} m/s"
    yield "peak thrust", f"{np.max(np.linalg.norm(found.thrust, axis=1)):.3g} N"
    if flown.motion.mode.has_wheels:
        for name, values, unit in (
            ("torque", found.wheel_torque, "N m"),
            ("momentum", found.wheel_momentum, "N m s"),
        ):
            x, y, z = np.max(np.abs(values), axis=0)
            yield f"peak wheel {name}", f"x {x:.3g}, y {y:.3g}, z {z:.3g} {unit} in base axes"
    for k, name in enumerate(robot.joint_names):
        peak = np.max(np.abs(found.torques[:, k]))
        yield f"peak of {name}", f"{peak:.3g} " + ("N" if robot.prismatic[k] else "N m")

"""Summary of a plan in a few rows, for the terminal and for notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.formatting import counted, proven
from ffsr_plan.core.rotations import angle_between

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData


def plan_rows(plan: PlanData, duration: float | None = None) -> list[tuple[str, str]]:
    """Names and values of a plan's figures of merit.

    Args:
        plan: the plan.
        duration: of the motion [s], for the peak momentum of the wheels where there are wheels;
            None to leave that row out.
    """
    return [
        *_objective_rows(plan),
        *_clearance_rows(plan),
        *_attitude_rows(plan, duration),
        *_search_rows(plan),
    ]


def _objective_rows(plan: PlanData) -> list[tuple[str, str]]:
    bound = "optimum" if plan.optimum_is_exact else "lower bound"
    figures = f"{bound} {plan.optimum:.4f}, gap {plan.gap:.3%}"
    value = f"{plan.objective:.4f}"
    if plan.problem.delta > 0.0 and len(plan.problem.scene):
        value += f", {plan.motion_objective:.4f} with the clearance between nodes"
    return [
        ("length L", f"{plan.length:.4f} m"),
        ("objective F", value),
        (
            ("without a lattice", figures)
            if plan.lattice is None
            else ("on the lattice", f"F {plan.lattice_objective:.4f}, {figures}")
        ),
    ]


def _clearance_rows(plan: PlanData) -> list[tuple[str, str]]:
    nodes = f"least {plan.clearances.min():.4f} m, mean {plan.clearances.mean():.4f} m"
    motion = f"at least {proven(plan.certificate.least_clearance)}"
    if not len(plan.problem.scene):
        nodes = motion = "no obstacles"
    rows = [("clearance at nodes", nodes), ("proven along the motion", motion)]
    if np.isfinite(plan.slip):
        rows.append(("free of moving bodies", f"even {_rounded_down(plan.slip)} s early or late"))
    if unchecked := plan.problem.robot.unchecked_links:
        rows.append(("not checked, no shape", ", ".join(unchecked)))
    return rows


def _rounded_down(value: float) -> str:
    """Three digits of a number that is promised."""
    digits = 10.0 ** (2 - np.floor(np.log10(value))) if value > 0.0 else 1.0
    return f"{np.floor(value * digits) / digits:g}"


def _attitude_rows(plan: PlanData, duration: float | None) -> list[tuple[str, str]]:
    angles = np.degrees(plan.arrival_attitude)
    text = "alpha {:.3f}°, beta {:.3f}°, gamma {:.3f}°".format(*angles)
    rows = [("attitude on arrival", text)]
    if plan.arrival_attitude_error is not None:
        error = np.degrees(plan.arrival_attitude_error)
        rows.append(("goal attitude", _reached(float(error))))
    elif plan.problem.mode.attitude_reacts and not plan.optimum_is_exact:
        away = np.degrees(angle_between(plan.configurations[-1, 3:7], plan.problem.goal[3:7]))
        rows.append(("goal attitude", f"not demanded, {away:.3f}° away"))
    if plan.problem.mode.has_wheels and duration is not None:
        peaks = plan.wheel_momentum(duration).axis_peaks
        text = "peak x {:.3g}, y {:.3g}, z {:.3g} N m s in base axes".format(*peaks)
        rows.append((f"wheels, if it takes {duration:g} s", text))
    return rows


def _reached(error: float) -> str:
    """What the arms did about a demanded attitude that they miss by `error` [deg]."""
    if np.radians(error) > 1e-6:
        return f"missed by {error:.2g}°"
    return f"reached by the arms, error {error:.2g}°"


def _search_rows(plan: PlanData) -> list[tuple[str, str]]:
    proof = plan.certificate
    certified = (
        f"{counted(proof.edges_free, 'edge')} free, {proof.edges_refused} refused, "
        f"{proof.node_queries} + {proof.edge_queries} distance queries (nodes + edges)"
    )
    cycles = len(plan.history.best)
    unit = "round" if plan.lattice is None else "cycle"
    search = "" if plan.planner.exact else f", seed {plan.seed}, {counted(cycles, unit)}"
    interrupted = ", interrupted: the best so far" if plan.interrupted else ""
    return [
        ("certified", certified),
        ("planner", f"{plan.planner.name}{search}{interrupted}"),
        ("time", f"{plan.seconds:.2f} s"),
    ]

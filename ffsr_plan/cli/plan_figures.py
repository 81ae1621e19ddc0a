"""The figures of a plan and of its verification, as `--json` states them."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.verification.verify import Report


def plan_figures(plan: PlanData, title: str, duration: float) -> dict[str, Any]:
    """What the table of a plan states, by name, lengths in metres and angles in radians.

    Args:
        plan: the plan.
        title: of its scenario.
        duration: of the motion [s], for the peak momentum of the wheels.
    """
    proof, wheels = plan.certificate, plan.problem.mode.has_wheels
    return {
        "title": title,
        "mode": str(plan.problem.mode),
        "planner": plan.planner.name,
        "seed": plan.seed,
        "cycles": len(plan.history.best),
        "interrupted": plan.interrupted,
        "length": plan.length,
        "objective": plan.objective,
        "motion_objective": plan.motion_objective,
        "lattice_objective": plan.lattice_objective,
        "optimum": plan.optimum,
        "optimum_is_exact": plan.optimum_is_exact,
        "gap": plan.gap,
        "least_node_clearance": plan.clearances.min(),
        "mean_node_clearance": plan.clearances.mean(),
        "proven_clearance": proof.least_clearance,
        "unchecked_links": plan.problem.robot.unchecked_links,
        "arrival_attitude": plan.arrival_attitude,
        "arrival_attitude_error": plan.arrival_attitude_error,
        "peak_wheel_momentum": plan.wheel_momentum(duration).axis_peaks if wheels else None,
        "edges_free": proof.edges_free,
        "edges_refused": proof.edges_refused,
        "node_queries": proof.node_queries,
        "edge_queries": proof.edge_queries,
        "seconds": plan.seconds,
    }


def report_figures(report: Report | None) -> dict[str, Any] | None:
    """All fields of a verification report by name; None for none."""
    if report is None:
        return None
    return {field.name: getattr(report, field.name) for field in fields(report)}

"""Figures of a plan, or of a trajectory by another planner, as columns of a row."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import NamedTuple

from ffsr_plan.certification.judgement import certify
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats.ros_messages import messages_of
from ffsr_plan.planning.certified_plan import Plan
from ffsr_plan.plans import plan_file
from ffsr_plan.problem.problem import Problem
from ffsr_plan.studies.tasks import row as rows
from ffsr_plan.studies.tasks.canonical import digest
from ffsr_plan.studies.tasks.row import Row
from ffsr_plan.trajectory.trajectory import Trajectory


class PlanText(NamedTuple):
    """Contents of a file.

    Attributes:
        suffix: of the file's name, without a dot.
        content: its text.
    """

    suffix: str
    content: str


def figures_of(problem: Problem, found: object, kept: bool) -> tuple[Row, PlanText | None]:
    """Columns of a row, and the file of the plan if it is kept.

    Args:
        problem: what was planned.
        found: what the planner returned: a plan, or a trajectory, which is judged by `certify`; or
            one of both and a mapping of further figures by name.
        kept: whether the file is wanted.

    Raises:
        InvalidInput: something else was returned.
    """
    extra: Mapping[str, object] = {}
    if isinstance(found, tuple) and len(found) == 2 and isinstance(found[1], Mapping):
        found, extra = found
    further: Row = {"figures": json.dumps(dict(extra), sort_keys=True, default=float)}
    if isinstance(found, Plan):
        return _of_plan(found) | further, _text_of(found) if kept else None
    if isinstance(found, Trajectory):
        figures = _of_trajectory(problem, found)
        return figures | further, PlanText("json", json.dumps(messages_of(found))) if kept else None
    raise InvalidInput("result of the planner", found, "a Plan or a Trajectory")


def _text_of(plan: Plan) -> PlanText:
    return PlanText("json", plan_file.to_text(plan))


def _of_plan(plan: Plan) -> Row:
    counts = plan.certificate.counts
    return {
        "outcome": rows.PLAN,
        "length": plan.length,
        "objective": plan.objective,
        "motion_objective": finite(plan.motion_objective),
        "least_clearance": finite(plan.certificate.least_clearance),
        "optimum": finite(plan.optimum),
        "optimum_is_exact": int(plan.optimum_is_exact),
        "gap": finite(plan.gap),
        "evaluations": int(counts.node_queries + counts.edge_queries),
        "interrupted": int(plan.interrupted),
        "digest": digest(plan.to_dict() | {"seconds": 0.0}),
    }


def _of_trajectory(problem: Problem, found: Trajectory) -> Row:
    report = certify(problem.robot, problem.scene, found, problem.mode, frame=None)
    return {
        "outcome": rows.PLAN if report.free else rows.CONTACT,
        "least_clearance": finite(report.proven_clearance),
        "digest": digest(_plain(found)),
    }


def _plain(found: Trajectory) -> dict[str, object]:
    return {
        "times": found.times,
        "joints": dict(found.joints),
        "velocities": dict(found.velocities),
        "base_positions": found.base_positions,
        "base_attitudes": found.base_attitudes,
        "interpolation": found.interpolation,
    }


def finite(value: float | None) -> float | None:
    """A number, or None for what a database does not hold: infinity and NaN.

    Args:
        value: the number.
    """
    return None if value is None or not math.isfinite(value) else float(value)

"""Plans as JSON files: self-contained, bit for bit, and with a digest that shows any change."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text
from ffsr_plan.plans.body_entries import moving_entries
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.plans.plan_reading import PLAIN, plan_of
from ffsr_plan.plans.plan_tables import FORMAT
from ffsr_plan.plans.planner_registry import planner_table
from ffsr_plan.plans.robot_table import robot_table
from ffsr_plan.plans.shape_entries import shape_entries
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Branches, Trails

_LARGEST_FILE = 500_000_000  # [bytes]; reading takes about ten times as much memory


def to_dict(plan: PlanData) -> dict[str, Any]:
    """The plan in plain Python values.

    None stands for what is infinite: clearances in an empty scene, costs of cycles without a path.
    """
    return {
        "format": FORMAT,
        "problem": problem_table(plan.problem),
        "planner": planner_table(plan.planner),
        "seed": plan.seed,
        "nodes": plan.nodes.tolist(),
        "motion": {
            "positions": plan.motion.positions.tolist(),
            "joint_values": None
            if plan.motion.joints_are_straight
            else plan.motion.joint_values.tolist(),
            **_given("turn_shares", plan.motion.turn_shares),
        },
        "configurations": plan.configurations.tolist(),
        "length": plan.length,
        "objective": plan.objective,
        "lattice_objective": plan.lattice_objective,
        "optimum": plan.optimum,
        "optimum_is_exact": plan.optimum_is_exact,
        "clearances": _without_infinity(plan.clearances),
        "history": {
            k: v.tolist() if k == "distinct" else _without_infinity(v)
            for k, v in plan.history._asdict().items()
        },
        **_search_edges(plan),
        "certificate": {
            **plan.certificate.counts._asdict(),
            "least_clearance": _without_infinity(np.array([plan.certificate.least_clearance]))[0],
        },
        "interrupted": plan.interrupted,
        "seconds": plan.seconds,
        **({} if plan.fuel is None else {"fuel": plan.fuel._asdict()}),
    }


def problem_table(problem: Problem) -> dict[str, Any]:
    """A problem in plain Python values, without further goals that are allowed.

    Args:
        problem: the problem.
    """
    return {
        "robot": robot_table(problem.robot),
        "scene": {
            "centers": problem.scene.centers.tolist(),
            "radii": problem.scene.radii.tolist(),
            "excess": problem.scene.excess,
            "sources": [list(source) for source in problem.scene.sources],
            **shape_entries(problem.scene),
            **moving_entries(problem.scene),
        },
        "start": problem.start.tolist(),
        "goal": problem.goal.tolist(),
        "lattice": None if problem.lattice is None else dataclasses.asdict(problem.lattice),
        "mode": problem.mode.value,
        **{name: getattr(problem, name) for name in PLAIN},
        **_given("window", problem.window),
        **_pace(problem),
    }


def _pace(problem: Problem) -> dict[str, Any]:
    if problem.duration is None:
        return {}
    return {"duration": problem.duration, "ramp": problem.ramp}


def _given(name: str, values: NDArray[np.float64] | None) -> dict[str, Any]:
    """A table of one entry; of none without values, as in files of older versions."""
    return {} if values is None else {name: values.tolist()}


def _search_edges(plan: PlanData) -> dict[str, Any]:
    """Trails of ants, and branches of trees where there are any."""
    found = plan.trails
    trails = Trails.none() if isinstance(found, Branches) else found
    tables: dict[str, Any] = {"trails": {k: v.tolist() for k, v in trails._asdict().items()}}
    if isinstance(found, Branches):
        tables["branches"] = {k: v.tolist() for k, v in found._asdict().items()}
    return tables


def write(plan: PlanData, path: Path) -> None:
    """Write a plan file, whole or not at all.

    Args:
        plan: the plan.
        path: of the file; an existing one is replaced.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    write_text("plan file", path, to_text(plan))


def to_text(plan: PlanData) -> str:
    """The text of a plan file, digest included."""
    data = to_dict(plan)
    return json.dumps({"sha256": digest(data), **data}, allow_nan=False, indent=1)


def read(path: Path) -> PlanData:
    """Read and check a plan file.

    Args:
        path: of the file.

    Raises:
        InvalidInput: no such file, cut short, or changed since it was written.
    """
    what = f"plan file '{path}'"
    text = read_text("plan file", path, "utf-8-sig", _LARGEST_FILE)
    try:
        data = json.loads(text, parse_constant=_no_number, object_pairs_hook=_without_twins)
    except json.JSONDecodeError as error:
        raise InvalidInput(
            what, f"broken JSON at line {error.lineno}", "a whole plan file, not one cut short"
        ) from None
    except (RecursionError, ValueError) as error:
        if isinstance(error, InvalidInput):
            raise InvalidInput(f"{what}, {error.what}", error.value, error.allowed) from None
        raise InvalidInput(what, str(error), "a plan file") from None
    fields = _check_format(what, data)
    try:
        unchanged = fields.pop("sha256", None) == digest(fields)
    except (RecursionError, ValueError):  # a number of thousands of digits, which no file holds
        unchanged = False
    if not unchanged:
        raise InvalidInput(
            what, "contents that do not match their digest", "an unchanged plan file"
        )
    return plan_of(what, fields)


def _no_number(text: str) -> float:
    raise ValueError(f"{text}, which is no number")


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object whose keys differ."""
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twin = next(key for key in keys if keys.count(key) > 1)
        raise InvalidInput(f"key '{twin}'", "two values", "one value for each key")
    return found


def checked(what: str, data: object) -> PlanData:
    """The plan of a dictionary, which may come from anywhere; `what` names it in errors.

    Raises:
        InvalidInput: not what `to_dict` gives.
    """
    return plan_of(what, _check_format(what, data))


def _check_format(what: str, data: object) -> dict[str, Any]:
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else type(data).__name__
        raise InvalidInput(what, found, f"format '{FORMAT}'")
    return data


def digest(data: dict[str, Any]) -> str:
    """SHA-256 of the canonical JSON text of a plan without its digest."""
    canonical = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _without_infinity(values: NDArray[np.float64]) -> list[float | None]:
    return [float(v) if np.isfinite(v) else None for v in values]

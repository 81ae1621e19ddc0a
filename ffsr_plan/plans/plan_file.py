"""Plans as JSON files: self-contained, bit for bit, and with a digest that shows any change."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.checks import finite_array, number, truth, whole_number
from ffsr_plan.core.errors import FfsrPlanError, InvalidInput
from ffsr_plan.core.text_files import write_text
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.plans.planner_registry import PLANNERS
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.collision_shapes import Containers
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.search.records import History, Trails

FORMAT = "ffsr-plan/3"
_AGREEMENT = 1e-9  # [m, rad] between the motion and the configurations beside it
_PLAIN = (
    "delta", "length_unit", "clearance_cap", "position_weight", "rotation_weight",
    "tolerance", "reach_attitude",
)  # fmt: skip


def to_dict(plan: PlanData) -> dict[str, Any]:
    """The plan in plain Python values.

    None stands for what is infinite: clearances in an empty scene, costs of cycles without a path.
    """
    problem = plan.problem
    return {
        "format": FORMAT,
        "problem": {
            "robot": _robot_to_dict(problem.robot),
            "scene": {
                "centers": problem.scene.centers.tolist(),
                "radii": problem.scene.radii.tolist(),
                "excess": problem.scene.excess,
                "sources": [list(source) for source in problem.scene.sources],
            },
            "start": problem.start.tolist(),
            "goal": problem.goal.tolist(),
            "lattice": dataclasses.asdict(problem.lattice),
            "mode": problem.mode.value,
            **{name: getattr(problem, name) for name in _PLAIN},
        },
        "planner": {"name": plan.planner.name, **dataclasses.asdict(plan.planner)},
        "seed": plan.seed,
        "nodes": plan.nodes.tolist(),
        "motion": {
            "positions": plan.motion.positions.tolist(),
            "joint_values": None
            if plan.motion.joints_are_straight
            else plan.motion.joint_values.tolist(),
        },
        "configurations": plan.configurations.tolist(),
        "length": plan.length,
        "objective": plan.objective,
        "lattice_objective": plan.lattice_objective,
        "optimum": plan.optimum,
        "clearances": _without_infinity(plan.clearances),
        "history": {
            k: v.tolist() if k == "distinct" else _without_infinity(v)
            for k, v in plan.history._asdict().items()
        },
        "trails": {k: v.tolist() for k, v in plan.trails._asdict().items()},
        "certificate": {
            **plan.certificate._asdict(),
            "least_clearance": _without_infinity(np.array([plan.certificate.least_clearance]))[0],
        },
        "interrupted": plan.interrupted,
        "seconds": plan.seconds,
    }


def _robot_to_dict(robot: SpaceRobot) -> dict[str, Any]:
    """Everything that the robot was made from, meshes included, and what it made of its shapes."""
    return {
        "name": robot.name,
        "urdf": robot.urdf,
        "package_dirs": list(robot.package_dirs),
        "srdf": robot.srdf,
        "disabled_pairs": [list(pair) for pair in robot.disabled_pairs],
        "containers": robot.containers._asdict(),
        "meshes": {address: corners.tolist() for address, corners in robot.meshes.items()},
        "replacements": [
            {"link": r.link, "number": r.number, "shape": r.shape, "by": r.by, "excess": r.excess}
            for r in robot.replacements
        ],
    }


def _robot_from_dict(data: dict[str, Any]) -> SpaceRobot:
    """The inverse; collision meshes come from the plan, not from their files.

    Raises:
        InvalidInput: what the plan says of replacements and exempt pairs is not what its URDF, SRDF
            and meshes give.
    """
    robot = robot_from_urdf(
        data["urdf"], data["name"], data["package_dirs"],
        srdf=data["srdf"],
        containers=Containers(**data["containers"]),
        meshes={
            address: finite_array(f"mesh {address}", corners, (-1, 3))
            for address, corners in data["meshes"].items()
        },
    )  # fmt: skip
    remade = _robot_to_dict(robot)
    if data["disabled_pairs"] != remade["disabled_pairs"]:
        raise InvalidInput(
            "disabled_pairs of the plan", data["disabled_pairs"],
            f"those of its SRDF: {remade['disabled_pairs']}",
        )  # fmt: skip
    stated, expected = data["replacements"], remade["replacements"]
    if len(stated) != len(expected) or not all(map(_same_replacement, stated, expected)):
        raise InvalidInput(
            "replacements of the plan", stated, f"those of its URDF and meshes: {expected}"
        )
    return robot


def _same_replacement(stated: dict[str, Any], expected: dict[str, Any]) -> bool:
    """Whether two records agree but for rounding, which may also change a number of vertices."""
    same = ("link", "number", "shape")
    if stated.keys() != expected.keys() or any(stated[k] != expected[k] for k in same):
        return False
    kinds = [re.sub(r"\d+", "n", record["by"]) for record in (stated, expected)]
    excess = number("excess of the plan's replacements", stated["excess"], at_least=0.0)
    difference = abs(excess - expected["excess"])
    return kinds[0] == kinds[1] and difference <= 1e-9 + 1e-6 * expected["excess"]


def from_dict(data: dict[str, Any]) -> PlanData:
    """The inverse of `to_dict`.

    Args:
        data: what `to_dict` gives.

    Raises:
        InvalidInput: a value that is not allowed.
    """
    given = data["problem"]
    settings = dict(data["planner"])
    problem = Problem(
        _robot_from_dict(given["robot"]),
        Scene(
            given["scene"]["centers"],
            given["scene"]["radii"],
            given["scene"].get("excess", 0.0),  # older files have none
            given["scene"].get("sources", ()),  # nor these
        ),
        start=given["start"],
        goal=given["goal"],
        lattice=Lattice(**given["lattice"]),
        mode=given["mode"],
        **{name: given[name] for name in _PLAIN},
    )
    history: dict[str, Any] = {
        k: _whole(v) if k == "distinct" else _with_infinity(v) for k, v in data["history"].items()
    }
    trails: dict[str, Any] = {
        k: finite_array(f"trails of the plan, {k}", v, (-1,))
        if k in ("laid", "pheromone")
        else _whole(v)
        for k, v in data["trails"].items()
    }
    certificate = dict(data["certificate"])
    certificate["least_clearance"] = float(_with_infinity([certificate["least_clearance"]])[0])
    return PlanData(
        problem=problem,
        planner=PLANNERS[settings.pop("name")](**settings),
        seed=data["seed"],
        lattice=LayeredLattice(problem),
        motion=_motion(problem, data),
        nodes=_whole(data["nodes"]),
        length=data["length"],
        objective=data["objective"],
        lattice_objective=data["lattice_objective"],
        optimum=data["optimum"],
        clearances=_with_infinity(data["clearances"]),
        history=History(**history),
        trails=Trails(**trails),
        certificate=Certificate(**certificate),
        interrupted=data["interrupted"],
        seconds=data["seconds"],
    )


def _motion(problem: Problem, data: dict[str, Any]) -> Motion:
    """The motion; the configurations beside it are for other readers, and have to agree with it."""
    corners, robot = problem.lattice.divisions + 1, problem.robot
    positions, values = data["motion"]["positions"], data["motion"]["joint_values"]
    motion = Motion(
        robot,
        problem.mode,
        problem.start,
        problem.goal,
        finite_array("motion of the plan, positions", positions, (corners, 3)),
        None
        if values is None
        else finite_array("motion of the plan, joint_values", values, (corners, robot.nd)),
    )
    what = "configurations of the plan"
    stored = finite_array(what, data["configurations"], (corners, robot.model.nq))
    if np.max(np.abs(stored - motion.configurations())) > _AGREEMENT:
        raise InvalidInput(what, "others", "those of its motion")
    return motion


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
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidInput(what, type(error).__name__, "a readable plan file") from None
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise InvalidInput(
            what, f"broken JSON at line {error.lineno}", "a whole plan file, not one cut short"
        ) from None
    except (RecursionError, ValueError) as error:
        raise InvalidInput(what, str(error), "a plan file") from None
    _check_format(what, data)
    try:
        unchanged = data.pop("sha256", None) == digest(data)
    except ValueError:  # not a number, which no plan file holds
        unchanged = False
    if not unchanged:
        raise InvalidInput(
            what, "contents that do not match their digest", "an unchanged plan file"
        )
    return checked(what, data)


def checked(what: str, data: object) -> PlanData:
    """The plan of a dictionary, which may come from anywhere; `what` names it in errors.

    Raises:
        InvalidInput: not what `to_dict` gives.
    """
    fields = _check_format(what, data)
    try:
        plan = from_dict(fields)
        _check_shapes(plan)
        _check_numbers(plan)
        return plan
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        if isinstance(error, FfsrPlanError):
            raise
        raise InvalidInput(what, repr(error), "every field of a plan file") from None


def _check_format(what: str, data: object) -> dict[str, Any]:
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        found = data.get("format") if isinstance(data, dict) else type(data).__name__
        raise InvalidInput(what, found, f"format '{FORMAT}'")
    return data


def _check_shapes(plan: PlanData) -> None:
    """Raise `InvalidInput` where the arrays of a plan do not fit its problem."""
    corners = plan.problem.lattice.divisions + 1
    axes = len(plan.problem.lattice.axes) + len(plan.problem.lattice.postures)
    shapes = {
        "clearances": (plan.clearances.shape, (corners,)),
        "nodes": (plan.nodes.shape, (corners, axes) if axes > 1 else (corners,)),
    }
    for name, (shape, wanted) in shapes.items():
        if shape != wanted:
            raise InvalidInput(f"{name} of the plan", shape, f"the shape {wanted}")
    for name in ("length", "objective", "lattice_objective", "optimum", "seconds"):
        number(f"{name} of the plan", getattr(plan, name), at_least=0.0)
    for name, table in (("history", plan.history), ("trails", plan.trails)):
        sizes = sorted({column.shape for column in table})
        if len(sizes) > 1 or len(sizes[0]) > 1:
            raise InvalidInput(f"{name} of the plan", sizes, "columns of one length")


def _check_numbers(plan: PlanData) -> None:
    """Raise `InvalidInput` for numbers that no planner gives, and nodes that the lattice lacks."""
    if plan.seed is not None:
        whole_number("seed of the plan", plan.seed, at_least=0)
    truth("interrupted of the plan", plan.interrupted)
    for name, value in plan.certificate._asdict().items():
        what = f"certificate of the plan, {name}"
        if name != "least_clearance":
            whole_number(what, value, at_least=0)
        elif value != np.inf:  # an empty scene; the bound may fall short of zero by rounding
            number(what, value, at_least=-1e-6)
    if plan.optimum > plan.lattice_objective * (1.0 + 1e-9):
        allowed = f"at most F on the lattice, {plan.lattice_objective!r}"
        raise InvalidInput("optimum of the plan", plan.optimum, allowed)
    lattice = plan.problem.lattice
    offsets = int(np.prod([2 * getattr(lattice, n).half_count + 1 for n in lattice.axes]))
    for end, most in (("layer", lattice.divisions), ("tail", offsets), ("head", offsets)):
        walked = getattr(plan.trails, end)
        if np.any((walked < 0) | (walked >= most)):
            raise InvalidInput(f"trails of the plan, {end}", walked, f"0 to {most - 1}")
    nodes = plan.nodes.reshape(len(plan.nodes), -1)
    counts = {name: getattr(lattice, name).half_count for name in lattice.axes}
    known = {name: range(-n, n + 1) for name, n in counts.items()}
    known |= {f"postures.{k}": axis.indices for k, axis in enumerate(lattice.postures)}
    known = known or {"no axis": range(1)}
    for (axis, inside), column in zip(known.items(), nodes.T, strict=True):
        for node in column.tolist():
            if node not in inside:
                raise InvalidInput(
                    f"nodes of the plan, {axis}", node, f"{inside[0]} to {inside[-1]}"
                )


def digest(data: dict[str, Any]) -> str:
    """SHA-256 of the canonical JSON text of a plan without its digest."""
    canonical = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _whole(values: list[int]) -> NDArray[np.int64]:
    found = np.array(values, dtype=np.float64)
    if not np.all(np.abs(found) < 2.0**53) or np.any(found != np.round(found)):
        raise InvalidInput("plan", values, "integers")
    return frozen(found.astype(np.int64))


def _without_infinity(values: NDArray[np.float64]) -> list[float | None]:
    return [float(v) if np.isfinite(v) else None for v in values]


def _with_infinity(values: list[float | None]) -> NDArray[np.float64]:
    found = np.array([np.inf if v is None else v for v in values], dtype=np.float64)
    if np.any(np.isnan(found)):
        raise InvalidInput("plan", values, "numbers")
    return frozen(found)

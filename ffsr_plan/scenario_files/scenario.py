"""Scenario files: TOML, through a schema, to a `Problem` with a planner and a seed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pydantic
from pydantic import BaseModel

from ffsr_plan.core import bundled_files
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, finite_array, number, one_of, whole_number
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.plans.planners import PLANNERS, Planner
from ffsr_plan.problem.end_effector_goal import inverse_kinematics
from ffsr_plan.problem.lattice_settings import Axis, Lattice, PostureAxis
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.robot import SpaceRobot, load_robot
from ffsr_plan.scenario_files.scenario_tables import (
    OBSTACLES,
    OF_A_MESH,
    GoalTable,
    ObstacleTable,
    PostureTable,
    ScenarioFile,
)
from ffsr_plan.scene.generators import belt, cloud, gate, scatter, truss
from ffsr_plan.scene.scene import Scene

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


class Scenario(NamedTuple):
    """What a scenario file asks for."""

    title: str
    problem: Problem
    planner: Planner
    seed: int
    refine: bool


def load_scenario(source: str | Path) -> Problem:
    """The problem of a scenario file; see `read_scenario`."""
    return read_scenario(source).problem


def read_scenario(source: str | Path) -> Scenario:
    """Read a scenario.

    Args:
        source: path to a TOML file, or name of a bundled scenario ("fig2a").

    Raises:
        InvalidInput: no such file, not TOML, an unknown key (the nearest one is suggested), a wrong
            type or a value that is not allowed; the message names file and field.
    """
    if not isinstance(source, (str, Path)):
        raise InvalidInput("scenario", source, "a name or a path")
    path = bundled_files.find("scenarios", str(source), ".toml") or Path(source)
    what = f"scenario '{source}'"
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise InvalidInput(what, str(error), "a TOML file") from None
    except (OSError, ValueError) as error:
        known = ", ".join(bundled_files.names("scenarios", ".toml"))
        raise InvalidInput(
            what, type(error).__name__, f"a readable file, or one of: {known}"
        ) from None
    try:
        file = ScenarioFile.model_validate(data)
    except pydantic.ValidationError as error:
        # a misspelt key also leaves the right one missing: speak of the misspelling first
        first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
        raise _explain(what, first) from None
    try:
        return _build(file, path.parent)
    except InvalidInput as error:
        raise InvalidInput(f"{what}: {error.what}", error.value, error.allowed) from None


def _build(file: ScenarioFile, folder: Path) -> Scenario:
    source = file.robot.urdf
    robot = load_robot(
        folder / source if source.endswith(".urdf") else source,
        [folder / entry for entry in file.robot.package_dirs],
        srdf=None if file.robot.srdf is None else folder / file.robot.srdf,
        meshes=file.robot.meshes,
        cylinders=file.robot.cylinders,
    )
    mode = Mode.parse("robot.mode", file.robot.mode)
    posed = file.goal.end_effector is not None
    reach = file.goal.attitude is not None and mode.attitude_reacts
    if reach and not file.lattice.postures:
        raise InvalidInput(
            "goal.attitude",
            file.goal.attitude,
            f"no goal attitude in the mode {mode}, where it follows from the arms, on a lattice "
            "without posture axes; leave it out, or use mode = 'attitude-held'",
        )
    if file.goal.position is not None and mode.floats:
        raise InvalidInput(
            "goal.position",
            file.goal.position,
            "no goal position in the mode free-floating, where it follows from the arms",
        )
    with _in_table("start"):
        start = robot.configuration(**file.start.model_dump())
    base = start[:3] if posed and mode.floats else _place(file.goal)
    scene = _scene(file, folder, [start[:3], base])
    with _in_table("goal"):
        goal = _goal(file.goal, robot, scene, start, mode)
    axes = {
        name: Axis(**axis.model_dump())
        for name in ("lateral", "normal")
        if (axis := getattr(file.lattice, name)) is not None
    }
    problem = Problem(
        robot,
        scene,
        start=start,
        goal=goal,
        mode=mode,
        lattice=Lattice(
            divisions=file.lattice.divisions,
            lateral=axes.get("lateral"),
            normal=axes.get("normal"),
            postures=[_posture_axis(k, table) for k, table in enumerate(file.lattice.postures)],
        ),
        reach_attitude=reach or bool(posed and file.lattice.postures and mode.attitude_reacts),
        **file.objective.model_dump(),
    )
    wanted = file.planner
    kind = PLANNERS[one_of("planner.name", wanted.name, list(PLANNERS))]
    settings = wanted.model_dump(exclude={"name", "seed", "refine"}, exclude_none=True)
    for key in settings:
        if key not in kind.__dataclass_fields__:
            known = [name for name in kind.__dataclass_fields__ if name != "name"]
            raise unknown_name(f"planner ({kind.name})", key, known)
    seed = whole_number("planner.seed", wanted.seed, at_least=0)
    return Scenario(file.title, problem, kind(**settings), seed, wanted.refine)


def _place(table: GoalTable) -> Array:
    """(3,) where the base is to go [m]."""
    return finite_array("goal: position", table.position or (0.0, 0.0, 0.0), (3,), FARTHEST)


def _goal(table: GoalTable, robot: SpaceRobot, scene: Scene, start: Array, mode: Mode) -> Array:
    """The goal configuration (nq,), by inverse kinematics where a pose is given."""
    wanted = table.end_effector
    if wanted is None:
        return robot.configuration(_place(table), table.attitude or (0.0, 0.0, 0.0), table.joints)
    if table.joints:
        raise InvalidInput("joints", table.joints, "none beside end_effector: they follow from it")
    if table.attitude is not None and mode.attitude_reacts:
        raise InvalidInput(
            "attitude", table.attitude, f"none beside end_effector in the mode {mode}"
        )
    floats = mode.floats
    with _in_table("end_effector"):
        return inverse_kinematics(
            robot, wanted.frame, wanted.position, wanted.attitude,
            start=start,
            mode=mode,
            base_position=None if floats else _place(table),
            base_attitude=(table.attitude or (0.0, 0.0, 0.0)) if mode.has_wheels else None,
            scene=scene,
            seed=wanted.seed,
        )  # fmt: skip


def _scene(file: ScenarioFile, folder: Path, ends: list[Array]) -> Scene:
    """All obstacles; `ends` (3,) are what clouds and belts spare."""
    scene = Scene()
    for place, obstacle in enumerate(file.obstacles):
        scene += _obstacle(f"obstacles.{place}", obstacle, folder)
    makers: dict[str, Callable[..., Scene]] = {
        "clouds": cloud, "belts": belt, "scatters": scatter, "trusses": truss, "gates": gate,
    }  # fmt: skip
    for name, make in makers.items():
        for place, table in enumerate(getattr(file, name)):
            given = table.model_dump()
            if "spared" in given:
                given["spared"] = [(end, table.spared) for end in ends]
            with _in_table(f"{name}.{place}"):
                scene += make(**given)
    return scene


def _obstacle(where: str, table: ObstacleTable, folder: Path) -> Scene:
    given = table.model_dump(exclude_none=True)
    kinds = [name for name in OBSTACLES if name in given]
    kind = "center" if not kinds and "radius" in given else kinds[0] if len(kinds) == 1 else None
    if kind is None:
        raise InvalidInput(where, ", ".join(given) or "no key", f"one of {', '.join(OBSTACLES)}")
    for name in (kind, *OBSTACLES[kind]):
        if name not in given:
            raise InvalidInput(f"{where}.{name}", None, "this key is required")
    known = [kind, *OBSTACLES[kind], *(OF_A_MESH if kind == "mesh" else ())]
    for name in given:
        if name not in known:
            raise InvalidInput(f"{where}.{name}", given[name], f"not beside {kind}")
    if kind == "center":
        return Scene([given["center"]], [number(f"{where}.radius", given["radius"], above=0.0)])
    path = folder / given.pop(kind)
    with _in_table(where):
        if kind == "mesh":
            return Scene.from_mesh(path, **given)
        return Scene.from_csv(path) if kind == "csv" else Scene.from_numpy(path)


def _posture_axis(place: int, table: PostureTable) -> PostureAxis:
    given = table.model_dump(exclude_none=True)
    if set(given) == {"towards", "levels"}:
        return PostureAxis.towards(given["towards"], given["levels"])
    if set(given) == {"joints", "half_count", "spacing"}:
        return PostureAxis(**given)
    raise InvalidInput(
        f"lattice.postures.{place}",
        ", ".join(given) or "nothing",
        "either towards and levels, or joints, half_count and spacing",
    )


@contextmanager
def _in_table(name: str) -> Iterator[None]:
    """Say in which table of the file a value stands."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error.what}", error.value, error.allowed) from None


def _explain(what: str, error: Any) -> InvalidInput:  # noqa: ANN401 - pydantic's error record
    """A pydantic error in our words, with the nearest key for a misspelt one."""
    place = [str(step) for step in error["loc"]]
    where = f"{what}: {'.'.join(place)}"
    if error["type"] == "extra_forbidden":
        return unknown_name(f"{what}: unknown key", ".".join(place), _keys_beside(place))
    if error["type"] == "missing":
        return InvalidInput(where, None, "this key is required")
    return InvalidInput(where, error["input"], error["msg"])


def _keys_beside(place: list[str]) -> list[str]:
    """Full names of the keys allowed in the table that `place` lies in."""
    table: type[BaseModel] = ScenarioFile
    for step in place[:-1]:
        if step.isdigit():
            continue
        annotation = table.model_fields[step].annotation
        inner = [annotation, *getattr(annotation, "__args__", ())]
        table = next(t for t in inner if isinstance(t, type) and issubclass(t, BaseModel))
    return [".".join([*place[:-1], key]) for key in table.model_fields]

"""Scenario files: TOML, through a schema, to a `Problem` with a planner and a seed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pydantic
from pydantic import BaseModel, ConfigDict, Field

from ffsr_plan import bundled
from ffsr_plan.axes import Axis, Lattice, PostureAxis
from ffsr_plan.colony import MaxMinAntSystem, Planner
from ffsr_plan.errors import InvalidInput, unknown_name
from ffsr_plan.generators import cloud
from ffsr_plan.inputs import one_of, whole_number
from ffsr_plan.motion import MODES
from ffsr_plan.paper import DIVISIONS
from ffsr_plan.planner import PLANNERS
from ffsr_plan.problem import Problem
from ffsr_plan.robot import load_robot
from ffsr_plan.scene import Scene

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Number = Annotated[float, Field(allow_inf_nan=False)]
Triple = Annotated[list[Number], Field(min_length=3, max_length=3)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class RobotTable(_Table):
    """The table `[robot]`."""

    urdf: str
    """Name of a bundled robot, or a path relative to the scenario file."""
    mode: str = MODES[0]
    package_dirs: list[str] = []
    srdf: str | None = None
    """Path of an SRDF, relative to the scenario file."""
    meshes: str = "hull"
    cylinders: str = "hull"


class PoseTable(_Table):
    """The table `[start]`."""

    position: Triple = [0.0, 0.0, 0.0]
    attitude: Triple = [0.0, 0.0, 0.0]
    """ZYX angles alpha, beta, gamma [rad]."""
    joints: dict[str, Number] = {}
    """Joints that are not named are at zero."""


class GoalTable(_Table):
    """The table `[goal]`."""

    position: Triple | None = None
    """At the world's origin if not given; not to be given in the mode free-floating."""
    attitude: Triple | None = None
    joints: dict[str, Number] = {}


class ObstacleTable(_Table):
    """The table `[[obstacles]]`."""

    center: Triple
    radius: Number


class CloudTable(_Table):
    """The table `[[clouds]]`: spheres drawn from a seed."""

    seed: int
    count: int
    low: Triple
    high: Triple
    radii: Annotated[list[Number], Field(min_length=2, max_length=2)]
    spared: Number = 0.0
    """No sphere comes nearer than this to the base at start or goal [m]."""


class AxisTable(_Table):
    """The tables `lateral` and `normal`."""

    half_count: int
    spacing: Number


class PostureTable(_Table):
    """An entry of `postures`: `towards` and `levels`, or `joints`, `half_count` and `spacing`."""

    towards: str | None = None
    levels: int | None = None
    joints: dict[str, Number] | None = None
    half_count: int | None = None
    spacing: Number | None = None


class LatticeTable(_Table):
    """The table `[lattice]`."""

    divisions: int = DIVISIONS
    lateral: AxisTable | None = None
    normal: AxisTable | None = None
    postures: list[PostureTable] = []


class ObjectiveTable(_Table):
    """The table `[objective]`."""

    delta: Number = 0.0
    length_unit: Number = 1.0
    clearance_cap: Number | None = None
    position_weight: Number = 1.0
    rotation_weight: Number = 1.0


class PlannerTable(_Table):
    """The table `[planner]`: what is not given stays at the planner's default."""

    name: str = MaxMinAntSystem.name
    seed: int = 0
    refine: bool = True
    ants: int | None = None
    cycles: int | None = None
    alpha: Number | None = None
    beta: Number | None = None
    rho: Number | None = None
    Q: Number | None = None
    C: Number | None = None
    improved: int | None = None
    patience: int | None = None
    cost_aware: bool | None = None
    pheromone: bool | None = None


class ScenarioFile(_Table):
    """A whole scenario file."""

    title: str = ""
    robot: RobotTable
    start: PoseTable = PoseTable()
    goal: GoalTable
    obstacles: list[ObstacleTable] = []
    clouds: list[CloudTable] = []
    lattice: LatticeTable
    objective: ObjectiveTable = ObjectiveTable()
    planner: PlannerTable = PlannerTable()


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
    path = bundled.find("scenarios", str(source), ".toml") or Path(source)
    what = f"scenario '{source}'"
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as error:
        raise InvalidInput(what, str(error), "a TOML file") from None
    except (OSError, ValueError) as error:
        known = ", ".join(bundled.names("scenarios", ".toml"))
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
    mode = one_of("robot.mode", file.robot.mode, MODES)
    reach = file.goal.attitude is not None and mode != "attitude-held"
    if reach and not file.lattice.postures:
        raise InvalidInput(
            "goal.attitude",
            file.goal.attitude,
            f"no goal attitude in the mode {mode}, where it follows from the arms, on a lattice "
            "without posture axes; leave it out, or use mode = 'attitude-held'",
        )
    if file.goal.position is not None and mode == "free-floating":
        raise InvalidInput(
            "goal.position",
            file.goal.position,
            "no goal position in the mode free-floating, where it follows from the arms",
        )
    with _in_table("start"):
        start = robot.configuration(**file.start.model_dump())
    with _in_table("goal"):
        goal = robot.configuration(
            file.goal.position or (0.0, 0.0, 0.0),
            file.goal.attitude or (0.0, 0.0, 0.0),
            file.goal.joints,
        )
    with _in_table("obstacles"):
        scenes = [Scene([o.center for o in file.obstacles], [o.radius for o in file.obstacles])]
    for number, table in enumerate(file.clouds):
        spared = [(q[:3], table.spared) for q in (start, goal)]
        with _in_table(f"clouds.{number}"):
            scenes.append(cloud(**table.model_dump(exclude={"spared"}), spared=spared))
    scene = Scene(np.vstack([s.centers for s in scenes]), np.hstack([s.radii for s in scenes]))
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
        reach_attitude=reach,
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


def _posture_axis(number: int, table: PostureTable) -> PostureAxis:
    given = table.model_dump(exclude_none=True)
    if set(given) == {"towards", "levels"}:
        return PostureAxis.towards(given["towards"], given["levels"])
    if set(given) == {"joints", "half_count", "spacing"}:
        return PostureAxis(**given)
    raise InvalidInput(
        f"lattice.postures.{number}",
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

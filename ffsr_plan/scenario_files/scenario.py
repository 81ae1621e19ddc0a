"""Scenario files: TOML that describes a problem, a planner and a seed."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.core import bundled_files
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import from_mapping
from ffsr_plan.core.text_files import read_text
from ffsr_plan.plans.planner_registry import Planner
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem.timing_rules import check_duration
from ffsr_plan.scenario_files.scenario_schema import ScenarioFile
from ffsr_plan.scenario_files.shape_tables import with_names
from ffsr_plan.scene.scene import Scene

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

GENERATORS = ("clouds", "belts", "scatters", "trusses", "gates")
"""Tables that make obstacles by a function of `generators`, in the order of the scene."""


@dataclass(frozen=True, eq=False, repr=False)
class Scenario:
    """Contents of a scenario file.

    Attributes:
        title: of the scenario, may be empty.
        problem: what to plan.
        planner: the planner that the file names, or None for the default of the lattice.
        seed: of the planner's random numbers.
        refine: whether to move the path off the lattice after the search, or None for the default
            of `plan`.
    """

    title: str
    problem: Problem
    planner: Planner | None
    seed: int
    refine: bool | None

    @classmethod
    def load(cls, source: str | Path) -> Scenario:
        """Read a scenario file.

        Args:
            source: path of a TOML file, or name of a bundled scenario ("fig2a").

        Raises:
            InvalidInput: no such file, not TOML (with line and column), an unknown key (the nearest
                one is suggested), a wrong type or a value that is not allowed; the message names
                file and field.
            PoseOutOfReach, GoalInCollision: no goal configuration for the pose of an end effector.
        """
        data, folder = read_tables(source)
        try:
            return cls.from_tables(data, folder)
        except InvalidInput as error:
            place = f"scenario '{source}': {error.what.removeprefix('.')}"
            raise InvalidInput(place, error.value, error.allowed) from None

    @classmethod
    def from_tables(cls, tables: Mapping[str, Any], folder: Path) -> Scenario:
        """The scenario of the tables of a file.

        Args:
            tables: what `read_tables` gives, or the same with other values.
            folder: that paths in the tables are relative to.

        Raises:
            InvalidInput, PoseOutOfReach, GoalInCollision: see `load`.
        """
        return _scenario(from_mapping(ScenarioFile, tables), folder)

    def __repr__(self) -> str:
        planner = "default" if self.planner is None else self.planner.name
        return (
            f"Scenario({self.title!r}, {self.problem!r}, planner={planner}, seed={self.seed}, "
            f"refine={self.refine})"
        )


def read_tables(source: str | Path) -> tuple[dict[str, Any], Path]:
    """The tables of a scenario file, not yet checked, and the folder of the file.

    Args:
        source: path of a TOML file, or name of a bundled scenario ("fig2a").

    Raises:
        InvalidInput: no such file, or not TOML (with line and column).
    """
    path = _find(source)
    return toml_tables("scenario", source, path), path.parent


def toml_tables(what: str, source: object, path: Path) -> dict[str, Any]:
    """The tables of a TOML file.

    Args:
        what: kind of the file, for errors.
        source: the file as the user named it, for errors.
        path: the file.

    Raises:
        InvalidInput: no such file, or not TOML (with line and column).
    """
    text = read_text(what, path, "utf-8-sig")
    try:
        return tomllib.loads(text)
    except (RecursionError, ValueError) as error:  # a TOMLDecodeError is a ValueError
        deep = isinstance(error, RecursionError)
        reason = "lists or tables nested too deeply" if deep else str(error)
        raise InvalidInput(f"{what} '{source}'", reason, "a TOML file") from None


def _find(source: object) -> Path:
    """The file of a bundled name or a path.

    Raises:
        InvalidInput: neither; the nearest bundled name is suggested.
    """
    path = checked_path("scenario", source)
    bundled = bundled_files.find("scenarios", str(source), ".toml")
    if bundled is None and not path.suffix and not path.exists():
        known = bundled_files.names("scenarios", ".toml")
        raise unknown_name("scenario", str(source), [*known, "or a path to a .toml file"])
    return bundled or path


def load_scenario(source: str | Path) -> Problem:
    """The problem of a scenario file; `Scenario.load` gives planner and seed as well.

    Args:
        source: path of a TOML file, or name of a bundled scenario ("fig2a").

    Raises:
        InvalidInput, PoseOutOfReach, GoalInCollision: see `Scenario.load`.
    """
    return Scenario.load(source).problem


def _scenario(file: ScenarioFile, folder: Path) -> Scenario:
    """The scenario of checked tables; paths in them are relative to `folder`."""
    robot, mode = file.robot.robot(folder), file.robot.mode
    _check_goal(file)
    with _in_table("start"):
        start = file.start.configuration(robot)
    base_stays = file.goal.end_effector is not None and mode.floats
    base_goal = start[:3] if base_stays else file.goal.base_position
    scene = _scene(file, folder, [start[:3], base_goal])
    check_duration(scene, file.pace.duration, file.pace.ramp)
    with _in_table("goal"):
        around = scene.grown(file.objective.min_clearance).at(file.pace.duration or 0.0)
        goals = file.goal.configurations(robot, around, start, mode, file.lattice is None)
    demanded = file.goal.attitude is not None or file.goal.end_effector is not None
    problem = Problem(
        robot,
        scene,
        start=start,
        goal=goals[0],
        alternatives=goals[1:],
        mode=mode,
        lattice=file.lattice,
        window=None if file.window is None else [file.window.low, file.window.high],
        reach_attitude=demanded
        and mode.attitude_reacts
        and (file.lattice is None or bool(file.lattice.postures)),
        **{each.name: getattr(file.objective, each.name) for each in fields(file.objective)},
        **{each.name: getattr(file.pace, each.name) for each in fields(file.pace)},
    )
    planner = file.planner
    return Scenario(file.title, problem, planner.planner(), planner.seed, planner.refine)


def _check_goal(file: ScenarioFile) -> None:
    """Raise `InvalidInput` where the mode does not prescribe what the goal demands."""
    goal, mode = file.goal, file.robot.mode
    if goal.attitude is not None and mode.attitude_reacts:
        if goal.end_effector is not None:
            raise InvalidInput(
                "goal.attitude",
                goal.attitude,
                f"none beside end_effector in the mode {mode}, where it follows from the arms",
            )
        if file.lattice is not None and not file.lattice.postures:
            raise InvalidInput(
                "goal.attitude",
                goal.attitude,
                f"no goal attitude in the mode {mode}, where it follows from the arms, on a "
                "lattice without posture axes; leave it or the lattice out, or use "
                "mode = 'attitude-held'",
            )
    if goal.position is not None and mode.floats:
        raise InvalidInput(
            "goal.position",
            goal.position,
            "no goal position in the mode free-floating, where it follows from the arms",
        )


def _scene(file: ScenarioFile, folder: Path, ends: Sequence[Array]) -> Scene:
    """All obstacles and zones; generated ones keep away from base positions `ends` (3,) [m]."""
    scene = Scene()
    for k, obstacle in enumerate(file.obstacles):
        with _in_table(f"obstacles.{k}"):
            made = obstacle.scene(folder)
            made = with_names(made, f"obstacles.{k}")
            scene += made if made.sources else made.named(f"obstacles.{k}")
    for name in GENERATORS:
        for k, table in enumerate(getattr(file, name)):
            with _in_table(f"{name}.{k}"):
                scene += table.scene(ends).named(f"{name}.{k}")
    bodies = list[MovingBody]()
    for k, body in enumerate(file.bodies):
        with _in_table(f"bodies.{k}"):
            bodies.append(body.body(folder))
    clouds = list[DebrisCloud]()
    for k, cloud in enumerate(file.debris):
        with _in_table(f"debris.{k}"):
            clouds.append(cloud.cloud(folder))
    zones = [table.zone for table in file.keep_in]
    return scene + Scene(keep_in=zones, bodies=bodies, debris=clouds)


@contextmanager
def _in_table(name: str) -> Iterator[None]:
    """Name the table of the file in errors."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(f"{name}: {error.what}", error.value, error.allowed) from None

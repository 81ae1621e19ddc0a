"""A study file, read and checked before anything is planned."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import product
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput, PlanningError
from ffsr_plan.core.settings import from_mapping
from ffsr_plan.scenario_files.planner_tables import ByPlannerName, PlannerTable
from ffsr_plan.scenario_files.scenario import Scenario, read_tables, toml_tables
from ffsr_plan.scenario_files.scenario_schema import ScenarioFile
from ffsr_plan.studies.study_files.axis_values import Values, shown, with_values
from ffsr_plan.studies.study_files.scenario_grid import BaseScenario, ScenarioGrid
from ffsr_plan.studies.study_files.study_schema import StudyFile
from ffsr_plan.studies.tasks.given_values import given_memory_limit
from ffsr_plan.studies.tasks.grid import Grid, NamedPlanner

_PLANNER = "planner."
_MOST_CHECKED = 1000  # values of an axis; a longer list is of one kind, and wrong ones get rows
_MOST_TASKS = 10**9


def read_study(path: str | Path) -> tuple[str, Grid]:
    """Title and grid of a study file.

    Args:
        path: of the file.

    Raises:
        InvalidInput: no such file, not TOML, an unknown key or axis, or a value that is not
            allowed; the message names file and key.
    """
    source = checked_path("study", path)
    tables = toml_tables("study", source, source)
    with _in_file(path):
        file = from_mapping(StudyFile, tables)
        bases = _bases(file, source)
        axes = {k: v for k, v in file.axes.items() if not k.startswith(_PLANNER)}
        first = _checked(bases, axes)
        planner_axes = {k: v for k, v in file.axes.items() if k.startswith(_PLANNER)}
        planners = _planners(file, bases, first, planner_axes)
        seeds = (first.planner.seed,) if file.seeds is None else file.seeds
        grid = Grid(
            ScenarioGrid(bases, axes),
            planners,
            seeds,
            file.limits.time,
            given_memory_limit(file.limits.memory),
            file.plans,
        )
        if (
            math.prod([len(bases), *map(len, axes.values()), len(planners), len(seeds)])
            > _MOST_TASKS
        ):
            raise InvalidInput("axes", "more than 10^9 tasks", "at most 10^9 tasks")
    return file.title, grid


@contextmanager
def _in_file(path: object) -> Iterator[None]:
    """Name the file in errors."""
    try:
        yield
    except InvalidInput as error:
        place = f"study '{path}': {error.what.removeprefix('.')}"
        raise InvalidInput(place, error.value, error.allowed) from None


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Name the place in the file in errors."""
    try:
        yield
    except InvalidInput as error:
        inner = error.what.removeprefix(".")
        if inner.startswith("axes."):
            raise
        raise InvalidInput(f"{place}: {inner}", error.value, error.allowed) from None


def _bases(file: StudyFile, source: Path) -> list[BaseScenario]:
    """The scenarios of a study file."""
    if "file" not in file.scenario:
        return [BaseScenario(source.stem, file.scenario, source.parent.absolute())]
    given = file.scenario["file"]
    found = []
    for name in given if isinstance(given, list) else [given]:
        place = source.parent / name
        tables, folder = read_tables(place if place.suffix and place.is_file() else name)
        found.append(BaseScenario(Path(name).stem, tables, folder.absolute()))
    names = [each.name for each in found]
    if len(set(names)) < len(names):
        raise InvalidInput("scenario.file", given, "files of different names")
    return found


def _checked(bases: list[BaseScenario], axes: Mapping[str, Values]) -> ScenarioFile:
    """The first scenario, after a look at each scenario and each value of each axis."""
    start = {key: values[0] for key, values in axes.items()}
    read = []
    for base in bases:
        with _at(f"scenario {base.name}"):
            made = with_values(base.tables, start)
            made.pop("planner", None) if bases[1:] else None
            try:
                read.append(from_mapping(ScenarioFile, made))
            except InvalidInput as error:
                _blame_axis(base, axes, error)
            with suppress(PlanningError):  # a goal in collision is a result, as any other
                Scenario.from_tables(made, base.folder)
    for key, values in axes.items():
        for value in values[1:_MOST_CHECKED]:
            with _at(f"axes.{key}"):
                from_mapping(ScenarioFile, with_values(bases[0].tables, {**start, key: value}))
    return read[0]


def _blame_axis(base: BaseScenario, axes: Mapping[str, Values], error: InvalidInput) -> None:
    """Raise an error of the first combination by the name of the axis that is wrong, if one is."""
    for key in axes:
        others = {k: v[0] for k, v in axes.items() if k != key}
        try:
            from_mapping(ScenarioFile, with_values(base.tables, others))
        except InvalidInput:
            continue
        raise InvalidInput(
            f"axes.{key}: {error.what.removeprefix('.')}", error.value, error.allowed
        )
    raise error


def _planners(
    file: StudyFile, bases: list[BaseScenario], first: ScenarioFile, axes: Mapping[str, Values]
) -> tuple[NamedPlanner, ...]:
    """The planners of a study file, at each combination of the axes that are settings of them."""
    tables = list(file.planners) or [_own_planner(bases)]
    found = []
    for k, table in enumerate(tables):
        given = {key: value for key, value in table.items() if key not in ("label", "seed")}
        label = table.get("label", given.get("name", "default"))
        for values in product(*axes.values()):
            chosen = dict(zip(axes, values, strict=True))
            inner = {key.removeprefix(_PLANNER): value for key, value in chosen.items()}
            if wrong := {"seed", "name", "label"} & set(inner):
                what = f"axes.{_PLANNER}{min(wrong)}"
                raise InvalidInput(what, min(wrong), "seeds, or [[planners]], of the study instead")
            with _at(f"planners.{k}" if not chosen else f"planners.{k}, axes {', '.join(chosen)}"):
                made = ByPlannerName().table(with_values(given, inner), first.lattice)
                assert isinstance(made, PlannerTable)
                planner = made.planner()
            name = ", ".join([label, *(f"{key}={shown(value)}" for key, value in inner.items())])
            found.append(NamedPlanner(name, planner, made.refine, chosen))
    names = [each.name for each in found]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput("planners", name, "each name once; `label` gives another")
    return tuple(found)


def _own_planner(bases: list[BaseScenario]) -> Mapping[str, Any]:
    """The table `[planner]` that all scenarios have."""
    tables = [base.tables.get("planner", {}) for base in bases]
    for base, table in zip(bases, tables, strict=True):
        if table != tables[0]:
            allowed = "[[planners]] in the study, as the scenarios have different ones"
            raise InvalidInput(f"scenario {base.name}, planner", table, allowed)
    return tables[0]

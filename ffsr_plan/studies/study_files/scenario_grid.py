"""The problems of a study file: scenario files, at each combination of the axes' values."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, overload

from ffsr_plan.core.settings import from_mapping
from ffsr_plan.plans.robot_table import robot_table
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scenario_files.scenario import Scenario
from ffsr_plan.scenario_files.scenario_schema import RobotTable
from ffsr_plan.studies.study_files.axis_values import Values, shown, with_values
from ffsr_plan.studies.tasks.canonical import digest
from ffsr_plan.studies.tasks.sources import ProblemSource

_NO_PROBLEM = ("title", "planner")  # tables that do not decide the problem


@dataclass(frozen=True)
class BaseScenario:
    """The tables that a study varies.

    Attributes:
        name: of the scenario, different from all others of the study.
        tables: of the scenario file, not yet checked.
        folder: that paths in them are relative to.
    """

    name: str
    tables: Mapping[str, Any]
    folder: Path


@dataclass(frozen=True)
class ScenarioPoint:
    """A scenario with one value of each axis; see `ProblemSource`.

    Attributes:
        base: the scenario.
        axes: the value of each axis, by its dotted key.
    """

    base: BaseScenario
    axes: Mapping[str, object]

    @property
    def name(self) -> str:
        """Scenario, keys and values."""
        return ", ".join([self.base.name, *(f"{k}={shown(v)}" for k, v in self.axes.items())])

    @cached_property
    def tables(self) -> dict[str, Any]:
        """The tables of the scenario, with these values."""
        return with_values(self.base.tables, self.axes)

    @cached_property
    def digest(self) -> str:
        """What changes with the tables, the robot, or the contents of a file that they name."""
        tables = {key: value for key, value in self.tables.items() if key not in _NO_PROBLEM}
        folder = self.base.folder
        robot = _Robot(tables.pop("robot", {}), folder).digest
        files = sorted(set(_files(tables, folder)))
        return digest([tables, robot, [[str(name), _file_digest(folder / name)] for name in files]])

    def problem(self) -> Problem:
        """See `ProblemSource`."""
        return Scenario.from_tables(self.tables, self.base.folder).problem


class ScenarioGrid(Sequence[ProblemSource]):
    """All combinations of scenarios and values; each is made when it is asked for."""

    def __init__(self, bases: Sequence[BaseScenario], axes: Mapping[str, Values]) -> None:
        """See the class.

        Args:
            bases: the scenarios.
            axes: the values of each axis, by its dotted key; the last axis varies fastest.
        """
        self._bases, self._axes = tuple(bases), dict(axes)

    def __len__(self) -> int:
        return len(self._bases) * math.prod(map(len, self._axes.values()))

    @overload
    def __getitem__(self, number: int) -> ProblemSource: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[ProblemSource]: ...
    def __getitem__(self, number: int | slice) -> ProblemSource | Sequence[ProblemSource]:
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        if not 0 <= number < len(self):
            raise IndexError(number)
        values = {}
        for key in reversed(self._axes):
            number, place = divmod(number, len(self._axes[key]))
            values[key] = self._axes[key][place]
        return ScenarioPoint(self._bases[number], {key: values[key] for key in self._axes})


class _Robot:
    """A robot of a scenario; its meshes are read once, however many problems have it."""

    def __init__(self, table: Mapping[str, Any], folder: Path) -> None:
        self._table, self._folder = dict(table), folder

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, _Robot):
            return NotImplemented
        return (self._table, self._folder) == (other._table, other._folder)

    def __hash__(self) -> int:
        return hash((digest(self._table), self._folder))

    @property
    def digest(self) -> str:
        """Of all that the robot is made from, and of what actuates its base."""
        return _robot_digest(self)

    def described(self) -> list[object]:
        """The robot in plain values."""
        table = from_mapping(RobotTable, self._table)
        return [robot_table(table.robot(self._folder)), table.mode.value]


@lru_cache(maxsize=256)
def _robot_digest(robot: _Robot) -> str:
    return digest(robot.described())


def _files(value: object, folder: Path) -> Iterator[str]:
    """Names of files in tables, as far as there are such files."""
    if isinstance(value, Mapping):
        for each in value.values():
            yield from _files(each, folder)
    elif isinstance(value, list):
        for each in value:
            yield from _files(each, folder)
    elif isinstance(value, str) and value and len(value) < 4096 and "\0" not in value:
        try:
            if (folder / value).is_file():
                yield value
        except OSError:  # too long a name, which is a file's in no case
            return


@lru_cache(maxsize=4096)
def _file_digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()

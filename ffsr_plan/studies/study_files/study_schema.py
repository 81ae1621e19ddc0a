"""Tables of a study file as settings classes: keys, types, ranges and defaults."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import TypeAdapter

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Rule, Truth
from ffsr_plan.core.settings import settings
from ffsr_plan.scenario_files.scenario_schema import schema as scenario_schema
from ffsr_plan.studies.study_files.axis_values import flattened
from ffsr_plan.studies.tasks.given_values import (
    LARGEST_SEED,
    MOST_SEEDS,
    given_seeds,
    given_title,
)

_FILE = {"type": "string", "minLength": 1}
_INLINE = {"type": "object", "title": "Scenario"}  # replaced by the schema of scenario files
_SEED = {"type": "integer", "minimum": 0, "maximum": LARGEST_SEED}


@dataclass(frozen=True)
class ScenarioOfStudy(Rule):
    """The tables of a scenario, or `file` with the name of one or of several."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`; tables of a scenario are checked with the values of the axes."""
        if not isinstance(value, Mapping) or not value:
            raise InvalidInput(what, value, "file = 'x.toml', or the tables of a scenario")
        if "file" not in value:
            return value
        others_there = ", ".join(key for key in value if key != "file")
        if others_there:
            allowed = "file alone; an axis of one value replaces a value of the file"
            raise InvalidInput(f"{what}.file", f"file, {others_there}", allowed)
        names = value["file"] if isinstance(value["file"], list) else [value["file"]]
        wrong = [each for each in names if not isinstance(each, str) or not each]
        if wrong or not names or len(set(names)) < len(names):
            allowed = "a bundled name or a path, or a list of different ones"
            raise InvalidInput(f"{what}.file", value["file"], allowed)
        return value

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        files = {"anyOf": [_FILE, {"type": "array", "items": _FILE, "minItems": 1}]}
        named = {
            "type": "object",
            "properties": {"file": files},
            "required": ["file"],
            "additionalProperties": False,
        }
        return {"anyOf": [named, dict(_INLINE)]}


@dataclass(frozen=True)
class Title(Rule):
    """A text on one line."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        return given_title(value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "string"}


@dataclass(frozen=True)
class Axes(Rule):
    """Values by dotted key of a scenario file."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        if not isinstance(value, Mapping):
            raise InvalidInput(what, value, "a table of dotted keys of a scenario file")
        return flattened(value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "object", "additionalProperties": {"type": ["array", "object"]}}


@dataclass(frozen=True)
class Seeds(Rule):
    """A number of seeds, or a list of them."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`."""
        return given_seeds(value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        count = {"type": "integer", "minimum": 1, "maximum": MOST_SEEDS}
        listed = {"type": "array", "items": _SEED, "minItems": 1, "uniqueItems": True}
        return {"anyOf": [count, listed]}


@dataclass(frozen=True)
class PlannersOfStudy(Rule):
    """Tables as `[planner]` of a scenario, with a label and without a seed."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> object:
        """See `Rule.check`; settings are checked with the values of the axes."""
        if not isinstance(value, (list, tuple)):
            raise InvalidInput(what, value, "a list of tables, [[planners]] in a file")
        for k, table in enumerate(value):
            if not isinstance(table, Mapping):
                raise InvalidInput(f"{what}.{k}", table, "a table")
            if "seed" in table:
                raise InvalidInput(f"{what}.{k}.seed", table["seed"], "seeds of the study instead")
            if not isinstance(table.get("label", "x"), str) or not table.get("label", "x"):
                raise InvalidInput(f"{what}.{k}.label", table["label"], "a text")
        return tuple(value)

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "array", "items": {"type": "object"}}


@settings
class LimitsTable:
    """The table `[limits]` of a study file.

    Attributes:
        time: of one plan [s].
        memory: of one plan, beyond what its process has in use before [GB].
    """

    time: Annotated[float, Number(above=0.0)] | None = None
    memory: Annotated[float, Number(above=0.0, at_most=1e6)] | None = None


@settings
class StudyFile:
    """A study file.

    Attributes:
        scenario: `file` with a bundled name or a path relative to the study file, or a list of
            them; or the tables of a scenario file.
        title: of the study.
        axes: values that replace or complete those of the scenarios, by dotted key.
        planners: tables as `[planner]` of a scenario, without a seed; `label` names each in rows
            and reports. Without any, the planner of the scenario runs.
        seeds: how many, counted from 0, or a list of them; by default that of the scenario.
        limits: of each plan.
        plans: whether plans are kept.
    """

    scenario: Annotated[Any, ScenarioOfStudy()]
    title: Annotated[str, Title()] = ""
    axes: Annotated[Any, Axes()] = field(default_factory=dict)
    planners: Annotated[Any, PlannersOfStudy()] = ()
    seeds: Annotated[Any, Seeds()] | None = None
    limits: LimitsTable = field(default_factory=LimitsTable)
    plans: Annotated[bool, Truth()] = True


def study_schema() -> dict[str, Any]:
    """The JSON Schema of study files, by which editors complete and check them."""
    scenario = scenario_schema()
    own = TypeAdapter(StudyFile).json_schema()
    scenario.pop("$schema")
    inner = scenario.pop("$defs")
    kinds = own["properties"]["scenario"]["anyOf"]
    kinds[kinds.index(_INLINE)] = {"$ref": "#/$defs/Scenario"}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **own,
        "$defs": {**own.get("$defs", {}), **inner, "Scenario": scenario},
        "title": "ffsr-plan study",
    }

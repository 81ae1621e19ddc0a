"""JSON Schemas of the set's files: problems, index and results."""

from __future__ import annotations

from typing import Any

from ffsr_plan.problem_set.bench_problem import FORMAT
from ffsr_plan.problem_set.judging.result_files import RESULTS_FORMAT
from ffsr_plan.problem_set.set_index import INDEX_FORMAT
from ffsr_plan.scenario_files.scenario_schema import schema as scenario_schema

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_TEXT, _SECONDS = {"type": "string"}, {"type": "number", "exclusiveMinimum": 0}
_SHA256 = {"type": "string", "pattern": "^[0-9a-f]{64}$"}


def problem_schema() -> dict[str, Any]:
    """The schema of a problem file; `scenario` has the tables of scenario files."""
    scenario = scenario_schema()
    definitions = scenario.pop("$defs", {})
    del scenario["$schema"]
    fields = {
        "format": {"const": FORMAT},
        "name": {"type": "string", "pattern": "^[a-z]+/[0-9]{2}$"},
        "family": _TEXT,
        "seed": {"type": "integer", "minimum": 0},
        "title": _TEXT,
        "time_limit": _SECONDS,
        "straight_motion": {"enum": ["blocked", "free", "not defined"]},
        "spheres_sha256": {"anyOf": [{"const": ""}, _SHA256]},
        "scenario": scenario,
    }
    return {
        "$schema": _DRAFT,
        "title": "ffsr-plan problem",
        **_object(fields),
        "$defs": definitions,
    }


def index_schema() -> dict[str, Any]:
    """The schema of the index."""
    entry = {
        "name": _TEXT,
        "family": _TEXT,
        "title": _TEXT,
        "file": _TEXT,
        "sha256": _SHA256,
        "time_limit": _SECONDS,
    }
    fields = {
        "format": {"const": INDEX_FORMAT},
        "version": _TEXT,
        "families": {"type": "object", "additionalProperties": _TEXT},
        "problems": {"type": "array", "items": _object(entry)},
    }
    return {"$schema": _DRAFT, "title": "ffsr-plan problem index", **_object(fields)}


def results_schema() -> dict[str, Any]:
    """The schema of results that anybody can fill in."""
    pair = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
    result = {
        "problem": {**_TEXT, "description": "name of the problem, such as traps/07"},
        "trajectory": {
            "type": ["string", "null"],
            "description": "path of a trajectory file relative to this file; null for none",
        },
        "seconds": {"type": "number", "minimum": 0, "description": "that the planner took"},
        "seed": {"type": "integer", "minimum": 0},
        "curve": {"type": "array", "items": pair, "description": "seconds, and cost by then"},
        "reason": {**_TEXT, "description": "why there is no trajectory"},
    }
    fields = {
        "format": {"const": RESULTS_FORMAT},
        "planner": _TEXT,
        "set_version": _TEXT,
        "results": {"type": "array", "items": _object(result, 3)},
    }
    return {"$schema": _DRAFT, "title": "ffsr-plan results", **_object(fields)}


SCHEMAS = {"problem": problem_schema, "index": index_schema, "results": results_schema}
"""Schemas by kind of file."""


def _object(fields: dict[str, Any], needed: int | None = None) -> dict[str, Any]:
    """An object of these keys, of which the first so many are needed; None for all."""
    return {
        "type": "object",
        "properties": fields,
        "required": list(fields)[:needed],
        "additionalProperties": False,
    }

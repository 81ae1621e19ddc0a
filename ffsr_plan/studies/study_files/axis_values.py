"""The axes of a study file: dotted keys of a scenario file, and the values that each takes."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ffsr_plan.core.checks import number, whole_number
from ffsr_plan.core.errors import InvalidInput

_MOST_VALUES = 10**7
_COUNTED, _SPACED = {"count", "first"}, {"count", "low", "high"}
ALLOWED = (
    "a list of different values, { count = 50 } for 0 to 49, { first = 1, count = 50 }, or "
    "{ low = 0.0, high = 2.0, count = 5 }"
)
Values = Sequence[Any]


def flattened(tables: Mapping[str, Any], path: str = "") -> dict[str, Values]:
    """Values of all axes by dotted key, whether keys are quoted or tables of their own.

    Args:
        tables: of the file.
        path: of the table in the file, empty or ending with a dot.

    Raises:
        InvalidInput: what are no values.
    """
    found: dict[str, Values] = {}
    for key, value in tables.items():
        if isinstance(value, Mapping) and not _is_range(value):
            found |= flattened(value, f"{path}{key}.")
        else:
            found[path + key] = _values(f"axes.{path}{key}", value)
    return found


def _is_range(value: Mapping[str, Any]) -> bool:
    return not value or set(value) <= _COUNTED | _SPACED


def _values(what: str, value: object) -> Values:
    if isinstance(value, Mapping):
        return _range(what, value)
    if not isinstance(value, (list, tuple)) or not value:
        raise InvalidInput(what, value, ALLOWED)
    texts = [shown(each) for each in value]
    if len(set(texts)) < len(texts):
        raise InvalidInput(what, value, ALLOWED)
    return tuple(value)


def _range(what: str, table: Mapping[str, Any]) -> Values:
    if "count" not in table or not (set(table) <= _COUNTED or set(table) == _SPACED):
        raise InvalidInput(what, dict(table), ALLOWED)
    count = whole_number(f"{what}.count", table["count"], at_least=1, at_most=_MOST_VALUES)
    if set(table) <= _COUNTED:
        first = whole_number(f"{what}.first", table.get("first", 0), at_least=0)
        return range(first, first + count)
    low, high = (number(f"{what}.{name}", table[name]) for name in ("low", "high"))
    if count < 2 or low >= high:
        raise InvalidInput(what, dict(table), "low < high, and count >= 2")
    return tuple(np.linspace(low, high, count).tolist())


def shown(value: object) -> str:
    """A value as names of problems and planners have it, on one line.

    Args:
        value: of a TOML file.
    """
    return value if isinstance(value, str) else json.dumps(value, default=str)


def with_values(tables: Mapping[str, Any], values: Mapping[str, object]) -> dict[str, Any]:
    """Tables with other values, of which keys the tables need not have yet.

    Args:
        tables: of a file; not changed.
        values: by dotted key, in which numbers are places in lists, from 0.

    Raises:
        InvalidInput: a place that a list does not have, or a key within what is no table.
    """
    made: dict[str, Any] = copy.deepcopy(dict(tables))
    for key, value in values.items():
        *outer, last = key.split(".")
        at: Any = made
        for depth, step in enumerate(outer):
            at = _inner(key, at, step, ".".join(outer[:depth]))
        if isinstance(at, list):
            at[_place(key, at, last, ".".join(outer))] = copy.deepcopy(value)
        elif isinstance(at, dict):
            at[last] = copy.deepcopy(value)
        else:
            raise InvalidInput(
                f"axes.{key}", last, f"a key within a table; {'.'.join(outer)} is none"
            )
    return made


def _inner(key: str, at: object, step: str, path: str) -> object:
    if isinstance(at, list):
        return at[_place(key, at, step, path)]
    if isinstance(at, dict):
        return at.setdefault(step, {})
    raise InvalidInput(f"axes.{key}", step, f"a key within a table; {path} is none")


def _place(key: str, at: list[Any], step: str, path: str) -> int:
    if not step.isdecimal() or int(step) >= len(at):
        allowed = f"a place in the list {path}, from 0 to {len(at) - 1}"
        raise InvalidInput(f"axes.{key}", step, allowed if at else f"no place: {path} is empty")
    return int(step)

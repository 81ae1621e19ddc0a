"""Canonical descriptions of problems and planners, from which the keys of tasks are made."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from typing import Any, cast

import numpy as np

from ffsr_plan.plans.plan_file import problem_table
from ffsr_plan.plans.planner_registry import PLANNERS, Planner, planner_table
from ffsr_plan.problem.problem import Problem

_PICKLE = 4  # the protocol, which must not change with Python's default


def digest(description: object) -> str:
    """SHA-256 of the canonical JSON text of a description, as 64 hexadecimal digits.

    Args:
        description: numbers, texts, None, arrays, and sequences and mappings of these.
    """
    text = json.dumps(description, sort_keys=True, separators=(",", ":"), default=_plain)
    return hashlib.sha256(text.encode()).hexdigest()


def problem_description(problem: Problem) -> dict[str, Any]:
    """All that decides a plan, further goals included.

    Args:
        problem: the problem.
    """
    return {**problem_table(problem), "alternatives": problem.alternatives.tolist()}


def planner_description(planner: Any) -> object:  # noqa: ANN401 - also planners of others
    """What tells a planner from others: its class and its settings.

    A planner that is not of this package is described by its fields if it is a dataclass, by its
    module and name if it is a function, and otherwise by what it is pickled as.

    Args:
        planner: settings of a planner, None for the default of the problem, or any other planner.

    Raises:
        Exception: of any kind, where the planner cannot be pickled.
    """
    if planner is None:
        return None
    if isinstance(planner, tuple(PLANNERS.values())):
        return planner_table(cast(Planner, planner))
    kind = planner if hasattr(planner, "__qualname__") else type(planner)
    name = [kind.__module__, kind.__qualname__]
    if kind is planner:
        return name
    if is_dataclass(planner) and not isinstance(planner, type):
        return [*name, asdict(planner)]
    return [*name, hashlib.sha256(pickle.dumps(planner, _PICKLE)).hexdigest()]


def _plain(value: object) -> object:
    """What JSON has in place of a value that it does not know.

    Raises:
        TypeError: nothing.
    """
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "isoformat"):  # dates of TOML
        return value.isoformat()
    raise TypeError(f"{type(value).__name__} has no canonical form")

"""The columns of a study's rows: one row for each task, whatever it ended in."""

from __future__ import annotations

from functools import cache
from importlib.metadata import version
from typing import NamedTuple

Value = str | float | int | None
Row = dict[str, Value]

PLAN, CONTACT, NO_PLAN, INVALID, FAULT = "plan", "contact", "no plan", "invalid", "fault"
"""What a task ends in: a proven plan; a trajectory of another planner that touches something; no
plan was found or there is none; input that the planner refuses; an error that nobody foresaw."""

COLUMNS = {
    "key": "TEXT PRIMARY KEY NOT NULL",
    "problem": "TEXT NOT NULL",
    "planner": "TEXT NOT NULL",
    "seed": "INTEGER NOT NULL",
    "axes": "TEXT NOT NULL",
    "outcome": "TEXT NOT NULL",
    "error": "TEXT",
    "message": "TEXT",
    "length": "REAL",
    "objective": "REAL",
    "motion_objective": "REAL",
    "least_clearance": "REAL",
    "optimum": "REAL",
    "optimum_is_exact": "INTEGER",
    "gap": "REAL",
    "evaluations": "INTEGER",
    "interrupted": "INTEGER",
    "figures": "TEXT NOT NULL DEFAULT '{}'",
    "digest": "TEXT",
    "plan": "TEXT",
    "version": "TEXT NOT NULL",
    "seconds": "REAL",
    "wall": "REAL",
    "cpu": "REAL",
    "finished": "TEXT",
    "worker": "TEXT",
    "lost_workers": "TEXT NOT NULL DEFAULT '[]'",
    "traceback": "TEXT",
}
"""Names and SQLite's types."""

OF_ONE_RUN = ("seconds", "wall", "cpu", "finished", "worker", "lost_workers", "traceback")
"""Columns that differ from run to run; all others are the same, bit for bit, on any machine."""

SAME = tuple(name for name in COLUMNS if name not in OF_ONE_RUN)
"""Columns that do not."""


@cache
def package_version() -> str:
    """The version of the package in this process."""
    return version("ffsr-plan")


class Outcome(NamedTuple):
    """What a task ended in.

    Attributes:
        row: values by column.
        plan: name and text of the plan's file, or None.
    """

    row: Row
    plan: tuple[str, str] | None = None

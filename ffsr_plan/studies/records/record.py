"""`Record`: the one writer of a study's folder.

A plan's file is there, whole, before the transaction that holds its row is committed. So each row
has its plan, whenever the writer is killed; a file without a row is written again later.
"""

from __future__ import annotations

import fcntl
import json
import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import cache
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_text
from ffsr_plan.studies.records.database import (
    FILE,
    SCHEMA,
    about,
    define_results,
    failures_named,
    open_to_write,
)
from ffsr_plan.studies.tasks.grid import Grid, Task
from ffsr_plan.studies.tasks.row import COLUMNS, PLAN, Outcome

_LOCK = "study.lock"


class Record:
    """Rows and plans of a study in its folder; one process at a time has it.

    Attributes:
        folder: of the study.
    """

    def __init__(self, folder: Path, connection: sqlite3.Connection) -> None:
        """See `opened`, which makes records."""
        self.folder, self._connection = folder, connection
        self._place = cache(self._made)

    @classmethod
    @contextmanager
    def opened(cls, folder: Path) -> Iterator[Record]:
        """The record of a folder, which is made if it is not there; closed after the body.

        Args:
            folder: of the study.

        Raises:
            InvalidInput: a folder that cannot be written, or that another process writes to.
        """
        path = folder / FILE
        try:
            folder.mkdir(parents=True, exist_ok=True)
            lock = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            allowed = f"a folder that can be written ({error.strerror})"
            raise InvalidInput("directory", str(folder), allowed) from None
        try:
            _lock(lock, folder)
            with failures_named(path), closing(open_to_write(path)) as connection:
                yield cls(folder, connection)
        finally:
            os.close(lock)  # which unlocks it

    def begin(self, title: str, axes: Sequence[str], version: str) -> None:
        """Say what the study is.

        Args:
            title: of the study.
            axes: names of its axes.
            version: of the package.

        Raises:
            InvalidInput: rows of another version are there.
        """
        known = about(self._connection)
        for name, value in (("schema", str(SCHEMA)), ("version", version)):
            if known.get(name, value) != value:
                what, allowed = f"study in '{self.folder}'", f"{name} {value}, or another folder"
                raise InvalidInput(what, f"{name} {known[name]}", allowed)
        given = [*json.loads(known.get("axes", "[]")), *axes]
        entries = {
            "schema": str(SCHEMA),
            "version": version,
            "title": title,
            "axes": json.dumps(list(dict.fromkeys(given))),
        }
        self._connection.execute("BEGIN IMMEDIATE")
        statement = "INSERT OR REPLACE INTO about VALUES (?, ?)"
        self._connection.executemany(statement, entries.items())
        define_results(self._connection, json.loads(entries["axes"]))
        self._connection.execute("COMMIT")

    def done(self, failed_too: bool = True) -> set[str]:
        """Keys of the tasks that have a row.

        Args:
            failed_too: whether those without a plan are among them.
        """
        which = "" if failed_too else f" WHERE outcome = '{PLAN}'"
        return {key for (key,) in self._connection.execute(f"SELECT key FROM rows{which}")}

    def refuse_another(self, grid: Grid, task: Task) -> None:
        """Raise an error if the task's place in the grid has the row of another task.

        Args:
            grid: the study.
            task: one of its tasks.

        Raises:
            InvalidInput: problem or planner of this name were others when the row was made.
        """
        problem, planner = grid.sources[task.problem].name, grid.planners[task.planner].name
        found = self._connection.execute(
            "SELECT key FROM rows WHERE problem = ? AND planner = ? AND seed = ?",
            (problem, planner, task.seed),
        ).fetchone()
        if found is not None and found[0] != task.key:
            raise InvalidInput(
                f"study in '{self.folder}'",
                f"problem '{problem}', planner '{planner}', seed {task.seed}",
                "problem, planner and time limit as they were when this row was made, or other "
                "names, or another folder",
            )

    def write(self, outcomes: Sequence[Outcome], replace: bool = False) -> None:
        """Write plans, then their rows in one transaction.

        Args:
            outcomes: what tasks ended in.
            replace: whether rows of the same tasks are replaced, rather than kept.

        Raises:
            InvalidInput: a file that cannot be written; then no row is.
        """
        for outcome in outcomes:
            if outcome.plan is not None:
                name, text = outcome.plan
                path = self.folder / name
                self._place(path.parent)
                write_text("plan file", path, text)
        marks = ", ".join("?" * len(COLUMNS))
        statement = f"INSERT OR {'REPLACE' if replace else 'IGNORE'} INTO rows VALUES ({marks})"
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            rows = [[outcome.row[name] for name in COLUMNS] for outcome in outcomes]
            self._connection.executemany(statement, rows)
            self._connection.execute("COMMIT")
        except BaseException:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
            raise

    def _made(self, folder: Path) -> None:
        """Make a folder of plans."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            allowed = f"a folder that can be written ({error.strerror})"
            raise InvalidInput("plan file", str(folder), allowed) from None


def _lock(lock: int, folder: Path) -> None:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        allowed = "a folder to which no other run of a study writes at the moment"
        raise InvalidInput("directory", str(folder), allowed) from None
    except OSError:  # a file system without locks: two runs would still not damage the database
        return

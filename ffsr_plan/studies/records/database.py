"""The database of a study: its tables, and connections to it.

SQLite with a write-ahead log: whoever reads sees whole transactions while the study writes, and a
writer that is killed leaves those that it has committed. `synchronous = FULL` makes them survive a
loss of power too; a commit takes as many rows as have come in, so that it costs little.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.studies.tasks.row import COLUMNS

FILE = "study.sqlite"
"""Name of the database in the folder of a study."""
SCHEMA = 1
"""Version of the tables."""
_WAIT = 30.0  # [s] for another connection to end its transaction


@contextmanager
def failures_named(path: Path) -> Iterator[None]:
    """In the body, failures of the database become errors that name its file.

    Args:
        path: of the database.

    Raises:
        InvalidInput: what SQLite could not do, such as writing to a full disk.
    """
    try:
        yield
    except sqlite3.Error as error:
        allowed = f"a database of a study that can be read and written ({error})"
        raise InvalidInput("study database", str(path), allowed) from None


def open_to_write(path: Path) -> sqlite3.Connection:
    """A connection that writes; the tables are made if they are not there.

    Args:
        path: of the database.
    """
    connection = sqlite3.connect(path, timeout=_WAIT, isolation_level=None)
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")
    columns = ", ".join(f'"{name}" {kind}' for name, kind in COLUMNS.items())
    connection.execute("BEGIN IMMEDIATE")
    connection.execute(f"CREATE TABLE IF NOT EXISTS rows ({columns})")
    connection.execute("CREATE UNIQUE INDEX IF NOT EXISTS places ON rows (problem, planner, seed)")
    connection.execute("CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, value TEXT)")
    connection.execute("COMMIT")
    return connection


def open_to_read(path: Path) -> sqlite3.Connection:
    """A connection that reads, also while a study writes.

    Args:
        path: of the database.

    Raises:
        InvalidInput: no such file.
    """
    if not path.is_file():
        raise InvalidInput("study", str(path.parent), f"a folder of a study, with a file {FILE}")
    return sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=_WAIT)


def define_results(connection: sqlite3.Connection, axes: Sequence[str]) -> None:
    """Define the view `results`: the rows, with a column for each axis of the study.

    Args:
        connection: one that writes.
        axes: names of the axes.
    """
    own = [f'"{name}"' for name in COLUMNS if name not in ("axes",)]
    taken = {name.casefold() for name in COLUMNS}
    for axis in axes:
        name = f"axis {axis}" if axis.casefold() in taken else axis
        path = f'$."{axis}"'.replace("'", "''")
        quoted = name.replace('"', '""')
        own.append(f"""json_extract(axes, '{path}') AS "{quoted}\"""")
    connection.execute("DROP VIEW IF EXISTS results")
    connection.execute(f"CREATE VIEW results AS SELECT {', '.join(own)} FROM rows")


def about(connection: sqlite3.Connection) -> dict[str, str]:
    """What is said of the study as a whole, by name."""
    return dict(connection.execute("SELECT name, value FROM about").fetchall())


def axes_of(connection: sqlite3.Connection) -> list[str]:
    """Names of the study's axes."""
    found: list[str] = json.loads(about(connection).get("axes", "[]"))
    return found

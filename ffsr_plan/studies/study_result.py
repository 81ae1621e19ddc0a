"""`StudyResult`: the rows of a study in its folder, complete or not."""

from __future__ import annotations

import hashlib
import json
from contextlib import closing
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.planning.certified_plan import Plan
from ffsr_plan.studies.records.database import FILE, about, axes_of, failures_named, open_to_read
from ffsr_plan.studies.tasks.row import PLAN, SAME

Row = dict[str, Any]


class StudyResult:
    """The rows of a study. They can be read while the study runs.

    `pandas.read_sql("SELECT * FROM results", sqlite3.connect(result.database))` reads them too.

    Attributes:
        directory: of the study.
        database: its SQLite file; the view `results` has a column for each axis.
        title: of the study, may be empty.
        axes: names of its axes.
    """

    def __init__(self, directory: str | Path) -> None:
        """Look at the folder of a study.

        Args:
            directory: that `Study.run` wrote to.

        Raises:
            InvalidInput: no such folder, or no study in it.
        """
        self.directory = checked_path("directory", directory)
        self.database = self.directory / FILE
        with failures_named(self.database), closing(open_to_read(self.database)) as connection:
            self.title = about(connection).get("title", "")
            self.axes = axes_of(connection)

    def rows(self) -> list[Row]:
        """All rows, by problem, planner and seed, with a key for each column and each axis.

        Numbers are None where there are none. `optimum_is_exact` and `interrupted` are 0 or 1;
        `figures` are a mapping, `lost_workers` a list.
        """
        order = "SELECT * FROM results ORDER BY problem, planner, seed"
        with failures_named(self.database), closing(open_to_read(self.database)) as connection:
            found = connection.execute(order)
            names = [each[0] for each in found.description]
            rows = [dict(zip(names, values, strict=True)) for values in found]
        for row in rows:
            for name in ("figures", "lost_workers"):
                row[name] = json.loads(row[name])
        return rows

    def __len__(self) -> int:
        return self._count("SELECT count(*) FROM rows")

    @property
    def plans(self) -> int:
        """Number of rows with a plan."""
        return self._count(f"SELECT count(*) FROM rows WHERE outcome = '{PLAN}'")

    @property
    def faults(self) -> int:
        """Number of rows whose task ended in an error that nobody foresaw."""
        return self._count("SELECT count(*) FROM rows WHERE outcome = 'fault'")

    def digest(self) -> str:
        """SHA-256 of all that does not depend on times and workers, 64 hexadecimal digits.

        Two runs of one study have the same, bit for bit, on any machines: plans are equal too, as
        their digests are among the columns.
        """
        whole = hashlib.sha256()
        columns = ", ".join(f'"{name}"' for name in SAME)
        order = f"SELECT {columns} FROM rows ORDER BY key"
        with failures_named(self.database), closing(open_to_read(self.database)) as connection:
            for values in connection.execute(order):
                whole.update(repr(values).encode())
        return whole.hexdigest()

    def plan(self, row: Row) -> Plan:
        """The plan of a row.

        Args:
            row: one of `rows`.

        Raises:
            InvalidInput: a row without a plan, or whose plan was not kept or has changed.
        """
        name = row.get("plan") if isinstance(row, dict) else None
        if not isinstance(name, str):
            raise InvalidInput("row", row, "a row whose plan was kept")
        return Plan.load(self.directory / name)

    def write_report(self, directory: str | Path) -> list[Path]:
        """Write `report.html`, a page with tables and pictures, and each picture as PNG and PDF.

        Args:
            directory: for the files, made if it is not there; existing files are replaced.

        Returns:
            Paths of the files.

        Raises:
            InvalidInput: a file that cannot be written, or a study without rows.
        """
        from ffsr_plan.studies.report.report_files import write_report

        rows = self._some_rows()
        folder = checked_path("directory", directory)
        return write_report(self.title or self.directory.name, rows, self.axes, folder)

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as CSV, without tracebacks; a cell without a value is empty.

        Args:
            path: of the file; an existing one is replaced.

        Raises:
            InvalidInput: a file that cannot be written.
        """
        from ffsr_plan.studies.report.exports import write_csv_rows

        write_csv_rows(checked_path("path", path), self.rows())

    def to_parquet(self, path: str | Path) -> None:
        """Write the rows as Parquet, by the extra `parquet`; read it by `pandas.read_parquet`.

        Args:
            path: of the file; an existing one is replaced.

        Raises:
            InvalidInput: a file that cannot be written, or pyarrow is not installed.
        """
        from ffsr_plan.studies.report.exports import write_parquet_rows

        write_parquet_rows(checked_path("path", path), self.rows())

    def _some_rows(self) -> list[Row]:
        rows = self.rows()
        if not rows:
            raise InvalidInput("study", str(self.directory), "a study with at least one row")
        return rows

    def __repr__(self) -> str:
        return f"StudyResult({str(self.directory)!r}, {len(self)} rows, {self.plans} plans)"

    def _count(self, question: str) -> int:
        with failures_named(self.database), closing(open_to_read(self.database)) as connection:
            return int(connection.execute(question).fetchone()[0])

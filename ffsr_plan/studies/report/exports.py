"""Rows of a study as CSV and Parquet tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import reason, write_text
from ffsr_plan.studies.report.summary import Row

_NESTED = ("figures", "lost_workers")  # as texts


def write_csv_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as CSV, with a line of headings; a cell without a value is empty.

    Args:
        path: of the file, replaced if it exists.
        rows: of a study.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    text = io.StringIO()
    names = [name for name in (rows[0] if rows else {}) if name != "traceback"]
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([row[name] for name in names] for row in rows)
    write_text("CSV file", path, text.getvalue())


def write_parquet_rows(path: Path, rows: Sequence[Row]) -> None:
    """Write rows as Parquet.

    Args:
        path: of the file, replaced if it exists.
        rows: of a study.

    Raises:
        InvalidInput: a file that cannot be written, or pyarrow is not installed.
    """
    try:
        from pyarrow import Table, parquet
    except ImportError:
        allowed = "the extra 'parquet' installed: pip install 'ffsr-plan[parquet]'"
        raise InvalidInput("Parquet file", "pyarrow, which is not installed", allowed) from None
    plain = [row | {name: str(row[name]) for name in _NESTED} for row in rows]
    try:
        parquet.write_table(Table.from_pylist(_one_type_each(plain)), path)
    except (OSError, ValueError) as error:
        allowed = f"a file that can be written ({reason(error)})"
        raise InvalidInput("Parquet file", str(path), allowed) from None


def _one_type_each(rows: list[Row]) -> list[Row]:
    """Rows in which a column of texts and numbers, such as an axis of both, holds texts alone."""
    for name in rows[0] if rows else ():
        kinds = {type(row[name]) for row in rows} - {type(None)}
        if len(kinds) > 1:
            to = float if kinds <= {int, float} else str
            for row in rows:
                row[name] = None if row[name] is None else to(row[name])
    return rows

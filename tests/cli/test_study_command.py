"""The command `study`: one file gives rows, tables and pictures; reports; exit statuses."""

import csv
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from tests.studies.test_study_files import STUDY

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A study that the command has run."""
    made = tmp_path_factory.mktemp("study")
    (made / "spheres.toml").write_text(STUDY)
    result = CliRunner().invoke(app, ["study", str(made / "spheres.toml")])
    assert result.exit_code == 0, result.output
    assert "ant-system" in result.stdout
    assert "By objective.delta" in result.stdout
    return made / "spheres-study"


def test_a_second_run_finds_everything_done(folder):
    before = {row["key"]: row["finished"] for row in fp.StudyResult(folder).rows()}
    result = CliRunner().invoke(app, ["study", str(folder.parent / "spheres.toml"), "--json"])
    assert result.exit_code == 0
    assert json.loads(result.stdout)["study"]["rows"] == 40 == len(before)
    assert {row["key"]: row["finished"] for row in fp.StudyResult(folder).rows()} == before


def test_rows_of_points_that_the_file_does_not_have_are_told(folder, tmp_path):
    (tmp_path / "fewer.toml").write_text(STUDY.replace("count = 5", "count = 2"))
    command = ["study", str(tmp_path / "fewer.toml"), "--out", str(folder)]
    result = CliRunner().invoke(app, command)
    assert "24 of the rows are of points that the study file does not have." in result.stdout
    data = json.loads(CliRunner().invoke(app, [*command, "--json"]).stdout)["study"]
    assert (data["rows"], data["rows_of_other_points"]) == (40, 24)


def test_the_report_has_tables_pictures_and_every_row(folder, tmp_path):
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    table, columns = tmp_path / "rows.csv", tmp_path / "rows.parquet"
    options = ["--out", tmp_path / "out", "--csv", table, "--parquet", columns]
    result = CliRunner().invoke(app, list(map(str, ["study", "report", folder, *options])))
    assert result.exit_code == 0, result.output
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count("<svg") == 3
    assert len(re.findall(r"</svg>\s*<figcaption>[A-Z][^<]{40,}</figcaption>", page)) == 3
    assert not re.search(r"""<(script|link|img)|(src|href)=["'](?!#)""", page)  # no network
    rows = fp.StudyResult(folder).rows()
    read = list(csv.DictReader(table.open()))
    assert [row["key"] for row in read] == [row["key"] for row in rows]
    assert [float(row["objective"]) for row in read] == [row["objective"] for row in rows]
    assert parquet.read_table(columns)["objective"].to_pylist() == [r["objective"] for r in rows]
    again = CliRunner().invoke(app, list(map(str, ["study", "report", folder, *options])))
    assert again.exit_code == 2
    assert "--force" in again.stderr


def test_the_view_has_a_column_for_each_axis(folder):
    with sqlite3.connect(folder / "study.sqlite") as connection:
        text = 'SELECT "clouds.0.seed", count(*) FROM results GROUP BY 1 ORDER BY 1'
        assert connection.execute(text).fetchall() == [(k, 8) for k in range(5)]


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["study", "nowhere.toml"], "nowhere.toml"),
        (["study", "report", "nowhere"], "nowhere"),
        (["study", "wrong.toml"], "wrong.toml"),
        (["study", "spheres.toml", "--workers", "0"], "workers"),
        (["study", "spheres.toml", "--scheduler", "nowhere"], "scheduler"),
        (["study", "spheres.toml", "--out", "spheres.toml"], "spheres.toml"),
    ],
)
def test_bad_input_is_exit_status_2_and_names_what_is_wrong(
    tmp_path, monkeypatch, arguments, named
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spheres.toml").write_text(STUDY)
    (tmp_path / "wrong.toml").write_text(STUDY.replace("[axes]", "[axs]"))
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 2, result.output
    assert named in result.stderr


def test_ctrl_c_is_exit_status_130_and_says_how_to_go_on(tmp_path):
    (tmp_path / "spheres.toml").write_text(STUDY.replace("count = 5", "count = 500"))
    command = [sys.executable, "-m", "ffsr_plan_command", "study", str(tmp_path / "spheres.toml")]
    process = subprocess.Popen(
        command, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    database = tmp_path / "spheres-study" / "study.sqlite"
    while process.poll() is None and not (database.exists() and counted(database)):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "of 4000 rows" in errors
    assert "the same command goes on" in errors
    assert 0 < counted(database) < 4000


def counted(database):
    try:
        return len(fp.StudyResult(database.parent))
    except fp.InvalidInput:
        return 0

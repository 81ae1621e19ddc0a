"""The problem set, a few of its best plans as results, and a run on two small problems."""

import json

import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app

SMALL = ("paper/03", "remounted/00")
"""Problems that are planned and judged in a second."""


@pytest.fixture(scope="session")
def problems():
    return fp.ProblemSet()


@pytest.fixture(scope="session")
def best(problems):
    return problems.best


@pytest.fixture
def submitted(tmp_path):
    """Writes results: trajectories by problem, in a folder that is returned."""

    def write(trajectories, **more):
        rows = []
        for k, (name, given) in enumerate(trajectories.items()):
            fp.formats.write_csv(tmp_path / f"{k}.csv", given)
            rows.append({"problem": name, "trajectory": f"{k}.csv", "seconds": 0.5})
        data = {"format": "ffsr-plan results 1", "planner": "theirs", "set_version": "1"}
        (tmp_path / "results.json").write_text(json.dumps({**data, "results": rows, **more}))
        return tmp_path

    return write


@pytest.fixture(scope="session")
def small_run(tmp_path_factory):
    """The folder of `bench run` on two small problems, and what it printed."""
    folder = tmp_path_factory.mktemp("bench") / "run"
    options = [option for name in SMALL for option in ("--problem", name)]
    command = ["bench", "run", *options, "--time", "3", "--out", str(folder)]
    done = CliRunner().invoke(app, command, env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    return folder, done.output

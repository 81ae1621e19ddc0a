"""`--json`, `--quiet`, `--no-pictures` and the table of times."""

import json
import math

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.cli.console.output import plain
from ffsr_plan.cli.console.result_files import RESULTS
from tests.cli.test_commands import QUICK, run

__all__ = ["run"]  # a fixture


def test_json_has_the_figures_of_the_plan_with_all_digits(run):
    result = run("plan", "quick.toml", "--out", "results", "--json")
    assert result.exit_code == 0, result.output
    shown, plan = json.loads(result.stdout), fp.Plan.load("results/plan.json")
    for name in ("length", "objective", "motion_objective", "optimum", "gap", "seconds"):
        assert shown["plan"][name] == getattr(plan, name)
    assert shown["plan"]["arrival_attitude"] == plan.arrival_attitude.tolist()
    assert shown["report"]["ok"] is True
    assert shown["files"] == [f"results/{name}" for name in RESULTS]
    times = shown["times"]
    steps = ["loading", "reading", "planning", "writing", "verification"]
    assert list(times) == [*steps, "compiling", "total"]
    assert sum(times[step] for step in steps) + times["compiling"] <= times["total"]
    assert times["planning"] == pytest.approx(plan.seconds, abs=0.1)


def test_json_of_saved_plans_is_one_object(run):
    run("plan", "quick.toml", "--out", "results")
    verified = json.loads(run("verify", "results/plan.json", "--json").stdout)
    assert verified["report"]["least_clearance"] > 0.0
    fly = ("timed", "results/plan.json", "--thruster-acceleration", 0.01)
    timed = json.loads(run(*fly, "--csv", "flown.csv", "--json").stdout)
    flight = fp.Plan.load("results/plan.json").timed(thruster_acceleration=0.01)
    assert timed["flight"]["duration"] == flight.duration
    assert timed["flight"]["peak_wheel_torque"] is None
    assert timed["files"] == ["flown.csv"]


def test_json_states_a_plan_that_does_not_verify(run, monkeypatch):
    verify = fp.Plan.verify

    def failing(plan, *arguments, **named):
        report = verify(plan, *arguments, **named)
        object.__setattr__(report, "ok", False)
        object.__setattr__(report, "problems", ("it flies too low",))
        return report

    monkeypatch.setattr(fp.Plan, "verify", failing)
    result = run("plan", "quick.toml", "--json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["report"]["problems"] == ["it flies too low"]
    assert "it flies too low" in result.stderr


def test_what_is_infinite_is_null_in_json(run, tmp_path):
    obstacle = "[[obstacles]]\ncenter = [2.0, 0.1, 0.0]\nradius = 0.3\n"
    (tmp_path / "empty.toml").write_text(QUICK.replace(obstacle, ""))
    result = run("plan", "empty.toml", "--json")
    assert json.loads(result.stdout)["plan"]["proven_clearance"] is None
    odd = {"a": [math.nan, -math.inf, 1.5], "b": np.array([[np.inf, 2.0]]), "c": np.float64("nan")}
    assert plain(odd) == {"a": [None, None, 1.5], "b": [[None, 2.0]], "c": None}


@pytest.mark.parametrize("command", ["plan", "demo", "verify", "timed"])
def test_quiet_prints_nothing_but_errors(run, command):
    run("plan", "quick.toml", "--out", "results")
    arguments = {
        "plan": ["quick.toml"],
        "demo": [],
        "verify": ["results/plan.json"],
        "timed": ["results/plan.json", "--thruster-acceleration", 0.01],
    }[command]
    result = run(command, *arguments, "--quiet")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    refused = run(command, *arguments, "--quiet", "--json")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "either --quiet or --json" in " ".join(refused.stderr.split())


def test_quiet_does_not_hide_an_error(run):
    result = run("verify", "missing.json", "--quiet")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "missing.json" in result.stderr


def test_the_table_shows_what_takes_the_time(run):
    result = run("plan", "quick.toml", "--out", "results")
    rows = [line.strip("│ ").split("│")[0].strip() for line in result.stdout.splitlines()]
    first = rows.index("loading the program")
    steps = ["reading scenario and robot", "search, proof, refinement", "page and pictures"]
    assert rows[first + 1 : first + 5] == [*steps, "verification"]
    assert "total" in rows
    assert "search and proof" in run("plan", "quick.toml", "--no-refine").stdout


def test_pictures_of_an_earlier_plan_do_not_stay(run, tmp_path):
    run("plan", "quick.toml", "--out", "results")
    again = ("plan", "quick.toml", "--out", "results", "--seed", 1, "--no-pictures")
    assert run(*again).exit_code == 2
    assert run(*again, "--force").exit_code == 0
    names = sorted(path.name for path in (tmp_path / "results").iterdir())
    assert names == ["plan.html", "plan.json"]


def test_warm_up_says_what_it_compiled(run):
    run("warm-up")
    result = run("warm-up")
    assert result.exit_code == 0, result.output
    assert "All kernels were compiled already" in result.stdout


def test_warm_up_refuses_a_folder_that_cannot_be_written(run, tmp_path, monkeypatch):
    from numba import config

    (tmp_path / "file").write_text("")
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "file"))
    result = run("warm-up")
    assert result.exit_code == 2
    assert "NUMBA_CACHE_DIR" in result.stderr

"""The command line: exit codes, results on disk, errors on standard error."""

import json
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from ffsr_plan.cli import app
from ffsr_plan.cli.console.result_files import RESULTS

QUICK = """
title = "quick"
[robot]
urdf = "point"
[goal]
position = [4.0, 0.0, 0.0]
[[obstacles]]
center = [2.0, 0.1, 0.0]
radius = 0.3
[lattice]
divisions = 8
lateral = { half_count = 3, spacing = 0.2 }
[objective]
delta = 0.1
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick.toml").write_text(QUICK)
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


def test_plan_writes_everything_and_says_what_was_found(run, tmp_path):
    result = run("plan", "quick.toml", "--seed", 3, "--out", "results")
    assert result.exit_code == 0, result.output
    for name in RESULTS:
        assert (tmp_path / "results" / name).stat().st_size > 1000
    for word in ("length L", "objective F", "attitude on arrival", "certified", "verified", "yes"):
        assert word in result.stdout
    saved = json.loads((tmp_path / "results" / "plan.json").read_text())
    assert saved["seed"] == 3


def test_verify_checks_a_saved_plan(run):
    run("plan", "quick.toml", "--out", "results")
    result = run("verify", "results/plan.json", "--samples", 100)
    assert result.exit_code == 0
    assert "yes" in result.stdout


def test_existing_results_are_kept_unless_forced(run, tmp_path):
    run("plan", "quick.toml", "--out", "results")
    before = (tmp_path / "results" / "plan.json").read_bytes()
    refused = run("plan", "quick.toml", "--out", "results", "--seed", 1)
    assert refused.exit_code == 2
    assert "--force" in refused.stderr
    assert (tmp_path / "results" / "plan.json").read_bytes() == before
    assert run("plan", "quick.toml", "--out", "results", "--seed", 1, "--force").exit_code == 0
    assert (tmp_path / "results" / "plan.json").read_bytes() != before


def test_demo_runs_and_never_overwrites_its_earlier_results(run, tmp_path):
    assert run("demo").exit_code == 0
    assert run("demo").exit_code == 0
    assert (tmp_path / "ffsr-demo" / "plan.html").exists()
    assert (tmp_path / "ffsr-demo-2" / "plan.html").exists()


def test_robots_lists_the_bundled_ones(run):
    result = run("robots")
    assert result.exit_code == 0
    for word in ("planar_dual_arm", "left_1", "7.4", "stowed", "spread", "satellite_ur5", "kinova"):
        assert word in result.stdout


def test_no_path_is_exit_status_1_with_the_reason_on_stderr(run, tmp_path):
    wall = "\n".join(
        f"[[obstacles]]\ncenter = [2.0, {y / 2}, 0.0]\nradius = 0.4" for y in range(-4, 5)
    )
    (tmp_path / "wall.toml").write_text(QUICK.replace("[lattice]", wall + "\n[lattice]"))
    result = run("plan", "wall.toml", "--out", "results")
    assert result.exit_code == 1
    assert "no path on this lattice: layer" in result.stderr.replace("\n", " ")
    assert not (tmp_path / "results").exists()


def test_a_title_with_brackets_is_shown_as_it_is(run, tmp_path):
    (tmp_path / "odd.toml").write_text(QUICK.replace('"quick"', '"[red]odd[/foo]"'))
    result = run("plan", "odd.toml", "--no-verify")
    assert result.exit_code == 0
    assert "[red]odd[/foo]" in result.stdout


def test_an_unwritable_output_is_refused_before_planning(run, tmp_path):
    (tmp_path / "file").write_text("")
    result = run("plan", "quick.toml", "--out", "file/inside")
    assert result.exit_code == 2
    assert "can be written" in result.stderr


def test_every_planner_can_be_chosen_and_refinement_switched_off(run):
    for name in ("ant-system", "max-min-ant-system", "lattice-optimum"):
        result = run("plan", "quick.toml", "--planner", name, "--no-refine", "--out", name)
        assert result.exit_code == 0, result.output
        assert "gap" in result.stdout
    result = run("plan", "quick.toml", "--colonies", 2, "--workers", 2, "--time-limit", 20)
    assert result.exit_code == 0


def test_the_peak_momentum_of_wheels_is_printed_if_there_are_any(run, tmp_path):
    goal = "attitude = [0.6, 0.0, 0.0]"
    held = QUICK.replace("[goal]", f"mode = 'attitude-held'\n[goal]\n{goal}")
    (tmp_path / "held.toml").write_text(held)
    result = run("plan", "held.toml")
    assert result.exit_code == 0, result.output
    assert "wheels, if it takes 600 s" in result.stdout
    assert "wheel momentum error" in result.stdout
    assert "wheels, if it takes 60 s" in run("plan", "held.toml", "--duration", 60).stdout
    assert "wheel" not in run("plan", "quick.toml").stdout


def test_paths_and_trajectories_are_written_as_tables(run, tmp_path):
    run("plan", "quick.toml", "--out", "results")
    assert run("export", "results/plan.json", "path.csv", "--samples", 20).exit_code == 0
    assert len((tmp_path / "path.csv").read_text().splitlines()) == 21
    fly = ("timed", "results/plan.json", "--thruster-acceleration", 0.01, "--csv", "flown.csv")
    result = run(*fly)
    assert result.exit_code == 0, result.output
    for word in ("duration", "rests on the way", "delta-v", "peak thrust"):
        assert word in result.stdout
    before = (tmp_path / "flown.csv").read_bytes()
    assert before.startswith(b"t [s],s [1],base_x [m]")
    for again in (("export", "results/plan.json", "path.csv"), fly):
        refused = run(*again)
        assert refused.exit_code == 2
        assert "--force" in refused.stderr
    assert (tmp_path / "flown.csv").read_bytes() == before
    assert run(*fly, "--rate", 1, "--force").exit_code == 0
    assert len((tmp_path / "flown.csv").read_bytes()) < len(before)


def test_flights_are_drawn_as_figures_pages_and_moving_pictures(run, tmp_path):
    run("plan", "quick.toml", "--out", "results")
    files = {"--figure": "flight.pdf", "--page": "flight.html", "--movie": "flight.gif"}
    fly = ("timed", "results/plan.json", "--thruster-acceleration", 0.01)
    options = [word for pair in files.items() for word in pair]
    result = run(*fly, *options, "--movie-speed", 50)
    assert result.exit_code == 0, result.output
    begins = {"flight.pdf": b"%PDF", "flight.html": b"<!DOCTYPE html>", "flight.gif": b"GIF89a"}
    for name, begin in begins.items():
        assert (tmp_path / name).read_bytes().startswith(begin)
    refused = run(*fly, *options[:2])
    assert refused.exit_code == 2
    assert "--figure" in refused.stderr
    assert "--force" in refused.stderr
    wrong = run(*fly, "--movie", "flight.avi")
    assert wrong.exit_code == 2
    assert ".mp4" in wrong.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("export", "missing.json", "path.csv"),
        ("timed", "quick.toml", "--thruster-acceleration", "0.1"),
        ("plan", "missing.toml"),
        ("plan", "quick.toml", "--planner", "ants"),
        ("plan", "quick.toml", "--seed", "-1"),
        ("plan", "quick.toml", "--duration", "0"),
        ("plan", "quick.toml", "--seed", "one"),
        ("plan", "quick.toml", "--out", "quick.toml"),
        ("verify", "missing.json"),
        ("verify", "quick.toml"),
        ("fly",),
    ],
    ids=" ".join,
)
def test_bad_input_is_exit_status_2(run, arguments):
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stderr.strip()
    assert "Traceback" not in result.output


@pytest.mark.parametrize(
    "arguments",
    [
        ("plan", "quick.toml", "--out", ""),
        ("plan", ""),
        ("demo", "--out", ""),
        ("verify", ""),
        ("view", ""),
        ("export", "", "path.csv"),
        ("export", "plan.json", ""),
        ("gif", "plan.json", ""),
        ("timed", "plan.json", "--thruster-acceleration", "0.1", "--csv", ""),
    ],
    ids=" ".join,
)
def test_an_empty_path_is_not_the_current_folder(run, tmp_path, arguments):
    before = sorted(tmp_path.iterdir())
    result = run(*arguments)
    assert result.exit_code == 2
    assert "got ''; allowed: a path that is not empty" in " ".join(result.stderr.split())
    assert sorted(tmp_path.iterdir()) == before


def test_the_current_folder_may_be_named(run, tmp_path):
    assert run("plan", "quick.toml", "--out", ".").exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} >= set(RESULTS)


def test_a_plan_file_that_is_not_there_is_named_once(run, tmp_path):
    for name, reason in (("nope.json", "No such file or directory"), (".", "Is a directory")):
        sentence = " ".join(run("verify", name).stderr.split())
        allowed = f"a readable UTF-8 file ({reason})"
        assert sentence == f"ffsr-plan: plan file: got '{name}'; allowed: {allowed}"


def test_a_limit_that_is_missing_is_exit_status_2_and_named(run):
    run("plan", "quick.toml", "--out", "results")
    result = run("timed", "results/plan.json")
    assert result.exit_code == 2
    assert "thruster_acceleration" in result.stderr


def test_a_changed_plan_file_does_not_pass_as_verified(run, tmp_path):
    run("plan", "quick.toml", "--out", "results")
    path = tmp_path / "results" / "plan.json"
    path.write_text(path.read_text().replace('"radii": [\n    0.3', '"radii": [\n    0.2'))
    assert run("verify", path).exit_code == 2


def test_the_version_is_printed(run):
    result = run("--version")
    assert result.exit_code == 0
    assert result.stdout.startswith("ffsr-plan 0.")
    command = [sys.executable, "-m", "ffsr_plan", "--version"]
    assert subprocess.run(command, capture_output=True, text=True).stdout == result.stdout


def test_nothing_infinite_is_printed_for_an_empty_scene(tmp_path):
    file = tmp_path / "empty.toml"
    file.write_text(
        "[robot]\nurdf = 'planar_dual_arm'\n[goal]\nposition = [3.0, 0.0, 0.0]\n"
        "[lattice]\ndivisions = 5\nlateral = { half_count = 2, spacing = 0.2 }\n"
    )
    result = CliRunner().invoke(app, ["plan", str(file)])
    assert result.exit_code == 0, result.output
    assert "no obstacles" in result.output
    assert "inf" not in result.output


def test_a_scenario_without_a_lattice_is_planned(run, tmp_path):
    text = QUICK.replace(
        "[lattice]\ndivisions = 8\nlateral = { half_count = 3, spacing = 0.2 }\n", ""
    )
    free = text + "[planner]\nchecks = 60000\n[window]\nlow = [0, -1, 0]\nhigh = [4, 1, 0]\n"
    (tmp_path / "free.toml").write_text(free)
    result = run("plan", "free.toml", "--out", "results")
    assert result.exit_code == 0, result.output
    assert "tree-planner" in result.stdout
    assert "without a lattice" in result.stdout
    assert run("verify", "results/plan.json").exit_code == 0
    assert run("timed", "results/plan.json", "--thruster-acceleration", 0.1).exit_code == 0
    (tmp_path / "both.toml").write_text(free.replace("[window]", "[lattice]\n[window]"))
    refused = run("plan", "both.toml")
    assert refused.exit_code == 2


def test_without_a_lattice_the_first_path_may_be_enough(run):
    result = run("plan", "cup", "--until", "first", "--no-verify", "--json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["plan"]["planner"] == "tree-planner"
    refused = run("plan", "fig2a", "--until", "first")
    assert refused.exit_code == 2
    assert "tree-planner" in refused.output

"""The command `certify`: a stranger's table is judged at once."""

import json

import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli.commands import app

TABLE = "time,{}\n0,0,0,0,0,0,0\n2,80 ,0,0,0,0,0\n"
SCENE = "[[obstacles]]\ncenter = [-0.35, 1.1, 0.0]\nradius = 0.2\n"


@pytest.fixture
def run(tmp_path, monkeypatch, robot):
    monkeypatch.chdir(tmp_path)
    names = [f"{name} [deg]" for name in robot.joint_names]
    (tmp_path / "arm.csv").write_text(TABLE.format(",".join(names)))
    (tmp_path / "scene.toml").write_text(SCENE)
    runner = CliRunner()
    return lambda *words: runner.invoke(app, ["certify", *words])


def test_a_table_is_judged_in_one_command(run, tmp_path):
    given = ["arm.csv", "--urdf", "planar_dual_arm", "--scene", "scene.toml", "--json"]
    both = run(*given, "--mode", "free-floating", "--mode", "attitude-held", "--page", "p.html")
    assert both.exit_code == 1
    free, held = json.loads(both.stdout)["reports"]
    assert free["contact"]["link"] == "left_link_3"
    assert free["contact"]["time"] > held["contact"]["time"] > 0.0
    assert free["contact"]["turn"] > 0.02
    assert (tmp_path / "p.html").stat().st_size > 10**5
    assert run(*given[:3]).exit_code == 0


def test_the_mass_of_a_bus_counts(run):
    given = ["arm.csv", "--urdf", "planar_dual_arm", "--json"]
    light, heavy = (
        json.loads(run(*given, *more).stdout)["reports"][0]["base_turn"]
        for more in ([], ["--base-mass", "1000", "--base-inertia", "100,100,100"])
    )
    assert heavy < 0.05 * light


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["none.csv", "--urdf", "planar_dual_arm"], "trajectory"),
        (["arm.csv", "--urdf", "planar_dual_arm", "--mode", "flying"], "mode"),
        (["arm.csv", "--urdf", "planar_dual_arm", "--lock", "left_1"], "--lock"),
        (["arm.csv", "--urdf", "planar_dual_arm", "--base-inertia", "1,1,1"], "--base-inertia"),
        (["arm.csv", "--urdf", "planar_dual_arm", "--scene", "s.xyz"], "scene"),
        (["arm.csv", "--urdf", "point"], "unknown joints"),
    ],
)
def test_bad_input_is_named(run, words, named):
    result = run(*words)
    assert result.exit_code == 2
    assert named in result.stderr


def test_of_a_bag_one_topic_is_judged(run, robot, tmp_path):
    pytest.importorskip("mcap_ros2.writer")
    still = fp.Trajectory([0.0, 1.0], {name: [0.0, 0.0] for name in robot.joint_names})
    fp.formats.write_mcap(tmp_path / "one.mcap", still)
    given = ["one.mcap", "--urdf", "planar_dual_arm"]
    assert run(*given, "--topic", "/joint_trajectory").exit_code == 0
    other = run(*given, "--topic", "/nothing")
    assert other.exit_code == 2
    assert "/nothing" in other.output
    table = run("arm.csv", "--urdf", "planar_dual_arm", "--topic", "/joints")
    assert table.exit_code == 2
    assert "no bag" in table.output

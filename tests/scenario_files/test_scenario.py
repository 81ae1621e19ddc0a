"""Scenario files: what is read, and what each mistake in them is answered with."""

import re

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.bundled_files import folder

GOOD = """
title = "one sphere"
[robot]
urdf = "planar_dual_arm"
[start]
joints = { left_1 = 0.2 }
[goal]
position = [6, 0, 0]
[[obstacles]]
center = [3.0, 0.4, 0.0]
radius = 0.3
[lattice]
divisions = 12
lateral = { half_count = 6, spacing = 0.3 }
[objective]
delta = 2.0
length_unit = 0.1
[planner]
name = "ant-system"
seed = 5
ants = 8
rho = 0.7
"""


def write(tmp_path, text):
    path = tmp_path / "scenario.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_scenario_is_read_as_written(tmp_path, robot):
    title, problem, planner, seed, refine = fp.read_scenario(write(tmp_path, GOOD))
    assert title == "one sphere"
    assert problem.mode == "free-flying"
    assert np.array_equal(problem.start, robot.configuration(joints={"left_1": 0.2}))
    assert np.array_equal(problem.goal, robot.configuration((6, 0, 0)))
    assert problem.lattice == fp.Lattice(12, fp.Axis(6, 0.3))
    assert (problem.delta, problem.length_unit, problem.clearance_cap) == (2.0, 0.1, None)
    assert planner == fp.AntSystem(ants=8, rho=0.7)
    assert seed == 5
    assert refine
    assert fp.load_scenario(write(tmp_path, GOOD)).delta == 2.0


@pytest.mark.parametrize("path", sorted(folder("scenarios").glob("*.toml")), ids=lambda p: p.stem)
def test_every_bundled_scenario_reads_by_name_and_by_path(path):
    by_name, by_path = fp.read_scenario(path.stem), fp.read_scenario(path)
    assert by_name.title == by_path.title
    assert np.array_equal(by_name.problem.goal, by_path.problem.goal)


def test_the_two_scenarios_of_the_paper_differ_in_delta_alone():
    a, b = fp.load_scenario("fig2a"), fp.load_scenario("fig2b")
    assert (a.delta, b.delta) == (6.0, 2.0)
    assert np.array_equal(a.scene.centers, b.scene.centers)
    assert np.array_equal(a.start, b.start)
    assert np.array_equal(a.goal, b.goal)
    assert a.lattice == b.lattice
    assert a.length_unit == b.length_unit


def test_a_robot_file_is_looked_up_beside_the_scenario(tmp_path):
    (tmp_path / "mine.urdf").write_text((folder("urdf") / "planar_dual_arm.urdf").read_text())
    text = GOOD.replace('"planar_dual_arm"', '"mine.urdf"')
    assert fp.load_scenario(write(tmp_path, text)).robot.name == "mine"


MISTAKES = [
    ("radius = 0.3", "radus = 0.3", r"obstacles\.0\.radus.*did you mean 'obstacles\.0\.radius'"),
    ("spacing = 0.3", "spaceing = 0.3", r"did you mean 'lattice\.lateral\.spacing'"),
    ("[objective]", "[objektive]", r"did you mean 'objective'"),
    ("seed = 5", "sede = 5", r"did you mean 'planner\.seed'"),
    ("radius = 0.3", 'radius = "0.3"', r"obstacles\.0\.radius.*got '0\.3'"),
    ("divisions = 12", "divisions = 12.5", r"lattice\.divisions.*got 12\.5"),
    ("[6, 0, 0]", "[6, 0]", r"goal\.position.*got \[6, 0\]"),
    ("delta = 2.0", "delta = nan", r"objective\.delta.*got nan"),
    ("radius = 0.3", "", r"obstacles\.0\.radius.*required"),
    ("radius = 0.3", "radius = 0.0", r"obstacles\.0\.radius: got 0\.0.*greater than 0"),
    ("divisions = 12", "divisions = 1", r"divisions.*at least 2"),
    ("half_count = 6", "half_count = 0", r"half_count.*at least 1"),
    ("delta = 2.0", "delta = -2.0", r"delta.*at least 0"),
    ("rho = 0.7", "rho = 1.0", r"rho.*less than 1"),
    ("seed = 5", "seed = -5", r"seed.*at least 0"),
    ("left_1 = 0.2", "left_9 = 0.2", r"start: joints.*left_9.*did you mean 'left_"),
    ("left_1 = 0.2", "left_1 = 9.2", r"left_1.*-1\.8 to 1\.8"),
    ('"planar_dual_arm"', '"planar_arm"', r"did you mean 'planar_dual_arm'"),
    ("[start]", 'mode = "floating"\n[start]', r"mode.*free-flying, attitude-held"),
    ('"ant-system"', '"ants"', r"planner\.name.*did you mean 'ant-system'"),
    ("[6, 0, 0]", "[6, 0, 0]\nattitude = [0.1, 0, 0]", r"goal\.attitude.*follows from the arms"),
    ("rho = 0.7", "patience = 3", r"planner \(ant-system\).*patience"),
    ("title = ", "title == ", r"a TOML file"),
]


CLOUDS = """
[[clouds]]
seed = 0
count = 0
low = [2, -1, -1]
high = [3, 1, 1]
radii = [0.1, 0.1]
[[clouds]]
seed = 1
count = 3
low = [2, -1, -1]
high = [3, 1, 1]
radii = [0.1, 0.1]
"""


def test_clouds_add_up_and_may_be_empty(tmp_path):
    alone = fp.load_scenario(write(tmp_path, GOOD)).scene
    assert len(fp.load_scenario(write(tmp_path, GOOD + CLOUDS)).scene) == len(alone) + 3


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("count = -1", r"clouds\.1: cloud count: got -1"),
        ("count = 2\nspared = 99.0", r"clouds\.1: cloud spared: got '99 m about \(0, 0, 0\); 99 m"),
        ("count = 2\nspared = -1.0", r"clouds\.1: cloud spared: got -1"),
        ("count = 2.5", r"clouds\.1\.count: got 2\.5"),
    ],
)
def test_a_mistake_in_a_cloud_names_the_cloud(tmp_path, wrong, message):
    with pytest.raises(fp.InvalidInput, match=message):
        fp.load_scenario(write(tmp_path, GOOD + CLOUDS.replace("count = 3", wrong)))


@pytest.mark.parametrize(("right", "wrong", "message"), MISTAKES, ids=[m[1] for m in MISTAKES])
def test_a_mistake_in_a_scenario_is_named(tmp_path, right, wrong, message):
    assert right in GOOD
    path = write(tmp_path, GOOD.replace(right, wrong))
    with pytest.raises(fp.InvalidInput) as caught:
        fp.read_scenario(path)
    assert re.search(message, str(caught.value)), str(caught.value)
    assert "scenario" in str(caught.value)


def test_a_scenario_that_does_not_exist_is_answered_with_the_bundled_ones():
    with pytest.raises(fp.InvalidInput, match="fig2a, fig2b"):
        fp.read_scenario("fig3")

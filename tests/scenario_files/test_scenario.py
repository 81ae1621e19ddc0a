"""Reading of scenario files, and the error for each mistake in them."""

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
    scenario = fp.Scenario.load(write(tmp_path, GOOD))
    problem = scenario.problem
    assert scenario.title == "one sphere"
    assert problem.mode == "free-flying"
    assert np.array_equal(problem.start, robot.configuration(joints={"left_1": 0.2}))
    assert np.array_equal(problem.goal, robot.configuration((6, 0, 0)))
    assert problem.lattice == fp.Lattice(12, fp.Axis(6, 0.3))
    assert (problem.delta, problem.length_unit, problem.clearance_cap) == (2.0, 0.1, None)
    assert scenario.planner == fp.AntSystem(ants=8, rho=0.7)
    assert scenario.seed == 5
    assert scenario.refine is None
    assert repr(scenario).startswith("Scenario('one sphere', Problem(robot=planar_dual_arm, ")
    assert fp.load_scenario(write(tmp_path, GOOD)).delta == 2.0


@pytest.mark.parametrize("path", sorted(folder("scenarios").glob("*.toml")), ids=lambda p: p.stem)
def test_every_bundled_scenario_reads_by_name_and_by_path(path):
    by_name, by_path = fp.Scenario.load(path.stem), fp.Scenario.load(path)
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
    (
        "rho = 0.7",
        "patience = 3",
        r"unknown key: got 'planner\.patience'; allowed: planner\.seed, .*planner\.Q, planner\.C$",
    ),
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
        ("count = -1", r"clouds\.1\.count: got -1"),
        ("count = 2\nspared = 99.0", r"clouds\.1: cloud spared: got '99 m about \(0, 0, 0\); 99 m"),
        ("count = 2\nspared = -1.0", r"clouds\.1\.spared: got -1"),
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
        fp.Scenario.load(path)
    assert re.search(message, str(caught.value)), str(caught.value)
    assert "scenario" in str(caught.value)


def test_a_missing_scenario_is_answered_with_the_bundled_ones():
    with pytest.raises(fp.InvalidInput, match="fig2a, fig2b"):
        fp.Scenario.load("fig3")


def test_without_a_name_the_planner_is_that_of_the_lattice(tmp_path):
    text = GOOD.replace('name = "ant-system"\n', "").replace("ants = 8\nrho = 0.7\n", "")
    scenario = fp.Scenario.load(write(tmp_path, text))
    assert scenario.planner is None
    assert scenario.seed == 5


def test_settings_without_a_name_are_of_the_max_min_ant_system(tmp_path):
    text = GOOD.replace('name = "ant-system"\n', "")
    scenario = fp.Scenario.load(write(tmp_path, text))
    assert scenario.planner == fp.MaxMinAntSystem(ants=8, rho=0.7)


def test_start_and_goal_may_name_a_posture(tmp_path, robot):
    text = GOOD.replace(
        "joints = { left_1 = 0.2 }", "posture = 'stowed'\njoints = { left_1 = 0.2 }"
    )
    text = text.replace("[6, 0, 0]", "[6, 0, 0]\nposture = 'spread'")
    problem = fp.load_scenario(write(tmp_path, text))
    stowed = {**robot.postures["stowed"], "left_1": 0.2}
    assert np.array_equal(problem.start, robot.configuration(joints=stowed))
    spread = robot.configuration((6, 0, 0), joints=robot.postures["spread"])
    assert np.array_equal(problem.goal, spread)


def test_an_unknown_posture_is_named_with_the_nearest_one(tmp_path):
    text = GOOD.replace("joints = { left_1 = 0.2 }", "posture = 'stowd'")
    with pytest.raises(fp.InvalidInput, match=r"start: posture.*did you mean 'stowed'"):
        fp.load_scenario(write(tmp_path, text))


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        ('{ towards = "stowed" }', r"lattice\.postures\.0\.levels.*required"),
        ("{ levels = 3 }", r"lattice\.postures\.0\.towards.*required"),
        ('{ towards = "stowed", levels = 0 }', r"lattice\.postures\.0\.levels.*at least 1"),
        ('{ towrds = "stowed" }', r"did you mean 'lattice\.postures\.0\.towards'"),
        ('{ towards = "stowed", joints = {} }', r"lattice\.postures\.0: got 'joints, towards'"),
        ('{ towards = "stowd", levels = 3 }', r"postures, towards.*did you mean 'stowed'"),
    ],
)
def test_a_mistake_in_a_posture_axis_is_named(tmp_path, axis, message):
    text = GOOD.replace("divisions = 12", f"divisions = 12\npostures = [{axis}]")
    with pytest.raises(fp.InvalidInput, match=message):
        fp.load_scenario(write(tmp_path, text))

"""Scenario files whose obstacles come from files and generators, or whose goal is a pose."""

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import ffsr_plan as fp
from ffsr_plan.scene.generators import belt, gate, scatter, truss
from tests.scenario_files.test_scenario import GOOD, write

TABLES = """
[[belts]]
seed = 3
count = 20
radius = 6.0
thickness = 0.5
radii = [0.05, 0.1]
center = [3.0, 0.0, 8.0]
arc = [0.0, 3.0]
spared = 1.0
[[scatters]]
seed = 4
counts = [2, 5]
low = [2, 3]
high = [4, 5]
radii = [0.1, 0.2]
[[trusses]]
begin = [0, 5, 0]
end = [6, 5, 0]
width = 0.5
bays = 6
radius = 0.04
[[gates]]
along = 3.0
aside = 0.5
opening = 4.0
radius = 0.7
"""
ARM = """
[robot]
urdf = "planar_dual_arm"
mode = "MODE"
[start]
joints = { left_1 = -0.6, left_2 = -0.9, right_1 = 0.2 }
[goal]
end_effector = { frame = "right_link_3", position = [0.5, -0.75, 0.0] }
[lattice]
divisions = 8
"""


def scene_of(text, tmp_path):
    """The scene of a scenario with other obstacles than `GOOD` has."""
    begin, end = GOOD.index("[[obstacles]]"), GOOD.index("[lattice]")
    return fp.load_scenario(write(tmp_path, GOOD[:begin] + text + GOOD[end:])).scene


def test_generators_stand_in_tables_of_their_own(tmp_path):
    one = fp.load_scenario(write(tmp_path, GOOD)).scene
    found = fp.load_scenario(write(tmp_path, GOOD + TABLES)).scene
    spared = [((0, 0, 0), 1.0), ((6, 0, 0), 1.0)]
    ring = {"center": (3, 0, 8), "arc": (0.0, 3.0), "spared": spared}
    expected = (
        one
        + belt(3, 20, 6.0, 0.5, (0.05, 0.1), **ring)
        + scatter(4, (2, 5), (2, 3), (4, 5), (0.1, 0.2))
        + truss((0, 5, 0), (6, 5, 0), 0.5, 6, 0.04)
        + gate(3.0, 0.5, 4.0, 0.7)
    )
    assert np.array_equal(found.centers, expected.centers)
    assert np.array_equal(found.radii, expected.radii)
    names = ["obstacles.0", "belts.0", "scatters.0", "trusses.0", "gates.0"]
    assert [name for name, _ in found.sources] == names
    assert [name for name, _ in expected.sources[1:]] == ["belt", "scatter", "truss", "gate"]


def test_obstacles_come_from_files_beside_the_scenario(tmp_path, monkeypatch):
    folder = tmp_path / "scenes"
    folder.mkdir()
    debris = fp.Scene([[3.0, 4.0, 0.0], [2.0, 4.0, 0.0]], [0.2, 0.3])
    debris.to_csv(folder / "debris.csv")
    np.savez(folder / "more.npz", centers=debris.centers + 1.0, radii=debris.radii)
    trimesh.creation.box((0.4, 0.4, 1.0)).export(folder / "bus.stl")
    monkeypatch.chdir(tmp_path)  # somewhere else than the scenario's folder
    scene = scene_of(
        """
        [[obstacles]]
        csv = "debris.csv"
        [[obstacles]]
        numpy = "more.npz"
        [[obstacles]]
        mesh = "bus.stl"
        excess = 0.1
        scale = 2.0
        position = [3.0, -6.0, 0.0]
        attitude = [0.5, 0.0, 0.0]
        """,
        folder,
    )
    placed = {"scale": 2.0, "position": (3, -6, 0), "attitude": (0.5, 0, 0)}
    bus = fp.Scene.from_mesh(folder / "bus.stl", 0.1, **placed)
    expected = debris + fp.Scene(debris.centers + 1.0, debris.radii) + bus
    assert np.array_equal(scene.centers, expected.centers)
    assert np.array_equal(scene.radii, expected.radii)
    assert scene.excess == 0.1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('csv = "nowhere.csv"', r"obstacles\.0: CSV file: got '.*nowhere\.csv'.*No such file"),
        ('mesh = "nowhere.stl"\nexcess = 0.1', r"obstacles\.0: mesh: got '.*nowhere\.stl'"),
        ('mesh = "bus.stl"', r"obstacles\.0\.excess.*required"),
        (
            'csv = "a.csv"\nscale = 2.0',
            r"'obstacles\.0\.scale'; allowed: obstacles\.0\.csv",
        ),
        ('csv = "a.csv"\nmesh = "b.stl"', r"obstacles\.0: got 'csv, mesh'; allowed: one of center"),
        ("radius = 1.0", r"obstacles\.0\.center.*required"),
        ("scale = 1.0", r"obstacles\.0\.mesh.*required"),
        ('cvs = "a.csv"', r"obstacles\.0\.cvs.*did you mean 'obstacles\.0\.csv'"),
    ],
)
def test_a_mistake_in_an_obstacle_names_it(tmp_path, text, message):
    with pytest.raises(fp.InvalidInput, match=message):
        scene_of("[[obstacles]]\n" + text + "\n", tmp_path)


@pytest.mark.parametrize("wrong", ["count = 2.5", "thickness = 9.0"])
def test_a_mistake_in_a_belt_names_the_belt(tmp_path, wrong):
    key = wrong.split(" = ")[0]
    lines = [wrong if line.startswith(f"{key} =") else line for line in TABLES.splitlines()]
    with pytest.raises(fp.InvalidInput, match=rf"belts\.0.*{key}"):
        fp.load_scenario(write(tmp_path, GOOD + "\n".join(lines)))


def test_a_plan_among_meshes_is_loaded_without_them(tmp_path):
    trimesh.creation.box((0.4, 0.4, 1.0)).export(tmp_path / "bus.stl")
    begin, end = GOOD.index("[[obstacles]]"), GOOD.index("[lattice]")
    mesh = '[[obstacles]]\nmesh = "bus.stl"\nexcess = 0.15\nposition = [3.0, 1.2, 0.0]\n'
    plan = fp.plan(fp.load_scenario(write(tmp_path, GOOD[:begin] + mesh + GOOD[end:])))
    assert plan.verify(50).ok
    plan.save(tmp_path / "plan.json")
    (tmp_path / "bus.stl").unlink()
    again = fp.Plan.load(tmp_path / "plan.json")
    assert again == plan
    assert again.problem.scene.excess == 0.15


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_a_goal_may_be_the_pose_of_an_end_effector(tmp_path, mode):
    plan = fp.plan(fp.load_scenario(write(tmp_path, ARM.replace("MODE", mode))))
    robot = plan.problem.robot
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, plan.configurations[-1])
    reached = data.oMf[robot.model.getFrameId("right_link_3")].translation
    assert reached == pytest.approx((0.5, -0.75, 0.0), abs=1e-6)
    assert plan.verify(50).ok


def test_posture_axes_demand_the_attitude_of_the_pose(tmp_path):
    postures = 'postures = [{ towards = "stowed", levels = 3 }]\n'
    text = ARM.replace("MODE", "free-flying") + postures
    assert fp.load_scenario(write(tmp_path, text)).reach_attitude


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("right_link_3", "right_link_4", r"goal: end_effector\.frame.*did you mean 'right_link_3'"),
        ("[goal]", "[goal]\njoints = { left_1 = 0.1 }", r"goal\.joints.*none beside end_effector"),
        ("[goal]", "[goal]\nattitude = [0.1, 0, 0]", r"goal.attitude.*follows from the arms"),
        (", position = [0.5, -0.75, 0.0]", "", r"goal\.end_effector\.position.*required"),
    ],
)
def test_a_mistake_in_an_end_effector_is_named(tmp_path, right, wrong, message):
    text = ARM.replace("MODE", "free-flying").replace(right, wrong)
    with pytest.raises(fp.InvalidInput, match=message):
        fp.load_scenario(write(tmp_path, text))


def test_a_pose_out_of_reach_says_by_how_much(tmp_path):
    text = ARM.replace("MODE", "attitude-held").replace("0.5, -0.75", "0.5, -1.75")
    with pytest.raises(fp.PoseOutOfReach, match=r"'right_link_3' misses it by 0\.\d+ m"):
        fp.load_scenario(write(tmp_path, text))

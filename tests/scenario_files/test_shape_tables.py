"""Scenario files whose obstacles are boxes, capsules and so on, and that have keep-in zones."""

import re
import sys

import numpy as np
import pytest
import trimesh

import ffsr_plan as fp
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.settings import from_mapping
from ffsr_plan.scenario_files.obstacle_tables import CsvFile
from ffsr_plan.scenario_files.scenario_schema import ScenarioFile
from tests.helpers.documentation_pages import ROOT, blocks
from tests.scenario_files.test_json_schema import validator  # noqa: F401 - a fixture
from tests.scenario_files.test_scenario import GOOD, write

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BODIES = """
[[obstacles]]
box = { size = [0.1, 2.0, 0.0], position = [3.0, 9.0, 0.0], attitude = [0.5, 0.1, 0.0], name = "p" }
[[obstacles]]
ball = { radius = 0.5, position = [3.0, 9.0, 0.0] }
[[obstacles]]
[obstacles.capsule]
radius = 0.2
length = 1.5
position = [3.0, 9.0, 0.0]
attitude = [0.0, 0.6, 0.0, 0.8]
[[obstacles]]
cylinder = { radius = 0.2, length = 1.5, position = [3.0, 9.0, 0.0] }
[[obstacles]]
ellipsoid = { semi_axes = [0.2, 0.3, 0.4], position = [3.0, 9.0, 0.0], name = "egg" }
[[obstacles]]
hull = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], position = [3.0, 9.0, 0.0] }
[[keep_in]]
box = { size = [40.0, 40.0, 40.0], name = "laboratory" }
[[keep_in]]
ball = { radius = 30.0 }
[[keep_in]]
half_space = { direction = [0.0, 0.0, -2.0], position = [0.0, 0.0, -5.0] }
"""
PLACE = [3.0, 9.0, 0.0]


def scene_of(text, folder):
    return fp.load_scenario(write(folder, GOOD + text)).scene


def test_each_key_makes_the_shape_that_it_names(tmp_path):
    scene = scene_of(BODIES, tmp_path)
    assert scene.shapes == (
        fp.Box([0.1, 2.0, 0.0], PLACE, [0.5, 0.1, 0.0], "p"),
        fp.Ball(0.5, PLACE, "obstacles.2"),
        fp.Capsule(0.2, 1.5, PLACE, [0.0, 0.6, 0.0, 0.8], "obstacles.3"),
        fp.Cylinder(0.2, 1.5, PLACE, name="obstacles.4"),
        fp.Ellipsoid([0.2, 0.3, 0.4], PLACE, name="egg"),
        fp.Hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], PLACE, name="obstacles.6"),
    )
    assert scene.keep_in == (
        fp.Box([40.0, 40.0, 40.0], name="laboratory"),
        fp.Ball(30.0),
        fp.HalfSpace([0.0, 0.0, -2.0], [0.0, 0.0, -5.0]),
    )
    assert np.array_equal(scene.centers, fp.load_scenario(write(tmp_path, GOOD)).scene.centers)


def test_errors_name_a_shape_by_its_table(tmp_path):
    scene = scene_of(BODIES, tmp_path)
    assert scene.source_of(2) == "ball 'obstacles.2'"
    assert scene.source_of(len(scene) - 1) == "half-space (keep_in.2)"


def test_a_hull_comes_from_a_mesh_beside_the_scenario(tmp_path, monkeypatch):
    folder = tmp_path / "scenes"
    folder.mkdir()
    trimesh.creation.box((400.0, 200.0, 100.0)).export(folder / "bus.stl")
    monkeypatch.chdir(tmp_path)  # somewhere else than the scenario's folder
    (hull,) = scene_of(
        """
        [[obstacles]]
        hull = { mesh = "bus.stl", scale = 0.001, position = [3, 9, 0], attitude = [0.5, 0, 0] }
        """,
        folder,
    ).shapes
    placed = {"scale": 0.001, "position": PLACE, "attitude": [0.5, 0.0, 0.0]}
    assert hull == fp.Hull.from_mesh(folder / "bus.stl", **placed)
    assert hull.name == "bus.stl"
    assert np.allclose(np.ptp(hull.points, axis=0), [0.4, 0.2, 0.1])


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("[[obstacles]]\nbox = { size = [1, 1] }", r"obstacles\.1\.box\.size"),
        ("[[obstacles]]\nbox = { size = [1, 1, -1] }", r"obstacles\.1\.box\.size.*at least 0"),
        ("[[obstacles]]\nbox = { }", r"obstacles\.1\.box\.size.*required"),
        ("[[obstacles]]\nball = { radios = 1 }", r"did you mean 'obstacles\.1\.ball\.radius'"),
        ("[[obstacles]]\ncapsul = { radius = 1 }", r"did you mean 'obstacles\.1\.capsule'"),
        ("[[obstacles]]\nball = { radius = 1 }\ncenter = [0, 0, 0]", r"center, ball.*one of"),
        ("[[obstacles]]\nball = { radius = 1 }\nradius = 1", r"unknown key.*obstacles\.1\.radius"),
        ("[[obstacles]]\nball = 3", r"obstacles\.1\.ball: got 3"),
        ('[[obstacles]]\nhull = "a.stl"', r"obstacles\.1\.hull: got 'a\.stl'"),
        ('[[obstacles]]\nhull = { mesh = "a.stl" }', r"obstacles\.1: hull\.mesh: got '.*a\.stl'"),
        ("[[obstacles]]\nhull = { points = [[0, 0, 0]] }", r"obstacles\.1\.hull\.points.*1 points"),
        ("[[keep_in]]\nhalf_space = { direction = [0, 0, 0] }", r"keep_in\.0\.half_space"),
        ("[[keep_in]]\ncapsule = { radius = 1 }", r"keep_in\.0.*box, ball, half_space"),
        ("[keep_in]\nbox = { size = [1, 1, 1] }", r"keep_in: .*a list of tables"),
    ],
)
def test_a_mistake_in_a_shape_or_zone_is_named(tmp_path, table, message):
    with pytest.raises(fp.InvalidInput, match=message):
        scene_of(table + "\n", tmp_path)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        (None, None),
        ("size = [0.1, 2.0, 0.0]", "size = [0.1, 2.0]"),
        ("radius = 0.5", "radius = 0.0"),
        ("semi_axes", "axes"),
        ("half_space", "halfspace"),
        ("points", "corners"),
        ("attitude = [0.5, 0.1, 0.0]", "attitude = [0.5]"),
    ],
)
def test_the_schema_takes_shapes_and_finds_mistakes(validator, right, wrong):  # noqa: F811
    text = BODIES if right is None else BODIES.replace(right, wrong)
    found = tomllib.loads(GOOD + text)
    assert validator.is_valid(found) is (right is None)
    if right is None:
        from_mapping(ScenarioFile, found)
    else:
        with pytest.raises(InvalidInput):
            from_mapping(ScenarioFile, found)


def test_the_example_of_the_documentation_is_read(validator, tmp_path):  # noqa: F811
    texts = [block.text for block in blocks(ROOT / "docs/howto/scene.md", "ini")]
    for text in texts:
        found = tomllib.loads(GOOD + "\n" + re.sub(r"[\w/]+\.stl", "bus.stl", text))
        validator.validate(found)
        file = from_mapping(ScenarioFile, found)
        trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "bus.stl")
        made = [each.scene(tmp_path) for each in file.obstacles if not isinstance(each, CsvFile)]
        assert sum(len(scene.shapes) for scene in made) == 6
        assert len(file.keep_in) == 2
    assert texts


@pytest.mark.parametrize(
    ("fields", "shown"),
    [
        ("size = [1, 1, 1]\nposition = [1, 9, 0]", "box = { size = ..., position = ... }"),
        ("radius = 1\nlength = 2", "capsule = { radius = ..., length = ... } or cylinder = {"),
        ("semi_axes = [1, 1, 1]", "ellipsoid = { semi_axes = ... }"),
    ],
)
def test_fields_of_a_shape_that_stand_outside_its_table_are_told_where(tmp_path, fields, shown):
    path = write(tmp_path, GOOD + "\n[[obstacles]]\n" + fields + "\n")
    with pytest.raises(InvalidInput, match=r"obstacles\.\d.*in a table of their own") as raised:
        fp.load_scenario(path)
    assert shown in str(raised.value)


def test_a_missing_mesh_of_a_hull_is_named(tmp_path):
    path = write(tmp_path, GOOD + '\n[[obstacles]]\nhull = { mesh = "no.stl" }\n')
    with pytest.raises(InvalidInput, match=r"obstacles\.\d+.*hull\.mesh"):
        fp.load_scenario(path)

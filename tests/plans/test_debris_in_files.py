"""Debris in plan files and scenario files."""

import base64
from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.drifting_spheres import cloud_about
from tests.scenario_files.test_json_schema import validator  # noqa: F401 - a fixture
from tests.scenario_files.test_scenario import GOOD, write

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

DEBRIS = """
[pace]
duration = 40.0
[[debris]]
csv = "debris.csv"
[[debris]]
name = "bolts"
centers = [[2.0, 30.0, 0.0], [2.0, 31.0, 0.0]]
radii = [0.1, 0.2]
velocities = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]
"""
AWAY = np.array((0.0, 50.0, 0.0))


def far_cloud():
    cloud = cloud_about(3, 25)
    return fp.DebrisCloud(cloud.centers + AWAY, cloud.radii, cloud.velocities, "shell")


def moved(plan):
    scene = replace(plan.problem.scene, debris=[far_cloud(), cloud_about(4, 3, name="")])
    return replace(plan, problem=replace(plan.problem, scene=scene, duration=40.0))


def test_debris_is_saved_bit_for_bit(fig2a_plan, tmp_path):
    plan = moved(fig2a_plan)
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert loaded.problem.scene.debris == plan.problem.scene.debris
    entry = plan.to_dict()["problem"]["scene"]["debris"][0]
    assert len(entry["spheres"]) < 76 * 25  # less than 11 characters a number
    assert "debris" not in fig2a_plan.to_dict()["problem"]["scene"]


@pytest.mark.parametrize(
    "text",
    [
        "not base 64",
        base64.b64encode(np.zeros(8).tobytes()).decode(),
        base64.b64encode(np.array([0.0, 0, 0, -1, 0, 0, 0]).tobytes()).decode(),
    ],
)
def test_debris_of_a_changed_file_is_refused(fig2a_plan, text):
    data = moved(fig2a_plan).to_dict()
    data["problem"]["scene"]["debris"][0]["spheres"] = text
    with pytest.raises(fp.InvalidInput, match=r"debris"):
        fp.Plan.from_dict(data)


def loaded(folder, text):
    far_cloud().to_csv(folder / "debris.csv")
    return fp.load_scenario(write(folder, GOOD + text))


def test_debris_of_a_scenario_is_that_of_python(tmp_path, validator):  # noqa: F811
    validator.validate(tomllib.loads(GOOD + DEBRIS))
    first, second = loaded(tmp_path, DEBRIS).scene.debris
    assert first == fp.DebrisCloud.from_csv(tmp_path / "debris.csv")
    rows = [[2.0, 30.0, 0.0], [2.0, 31.0, 0.0]], [0.1, 0.2], [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]
    assert second == fp.DebrisCloud(*rows, "bolts")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("radii = [0.1, 0.2]", "radii = [0.1, -1.0]", "debris.1: .* 'bolts', radii, sphere 1"),
        ("radii = [0.1, 0.2]\n", "", "radii"),
        ('name = "bolts"', 'names = "bolts"', "name"),
        ('csv = "debris.csv"', 'csv = "gone.csv"', "debris.0"),
    ],
)
def test_a_wrong_table_is_named(tmp_path, old, new, words):
    with pytest.raises(fp.InvalidInput, match=words):
        loaded(tmp_path, DEBRIS.replace(old, new))

"""Study files: what they describe, and what is refused by the name of its key."""

import json
import sys
from dataclasses import fields

import jsonschema
import pytest

import ffsr_plan as fp
from ffsr_plan.studies.study_files.study_schema import StudyFile, study_schema

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

STUDY = """
title = "spheres"
seeds = [0, 7]

[scenario.robot]
urdf = "point"
[scenario.goal]
position = [4.0, 0.0, 0.0]
[[scenario.clouds]]
seed = 0
count = 3
low = [1.0, -1.0, -0.1]
high = [3.0, 1.0, 0.1]
radii = [0.1, 0.2]
[scenario.lattice]
divisions = 6
lateral = { half_count = 2, spacing = 0.3 }

[axes]
"clouds.0.seed" = { count = 5 }
objective.delta = [0.0, 0.1]

[[planners]]
name = "ant-system"
ants = 3
cycles = 2
[[planners]]
label = "exact"
name = "lattice-optimum"

[limits]
time = 20.0
memory = 4.0
"""


@pytest.fixture
def load(tmp_path):
    def made(text):
        file = tmp_path / "spheres.toml"
        file.write_text(text)
        return fp.Study.load(file)

    return made


def test_the_grid_has_each_combination_once(load):
    study = load(STUDY)
    assert len(study) == 5 * 2 * 2 * 2
    assert len({task.key for task in study.grid.tasks()}) == 40
    points = [dict(source.axes) for source in study.grid.sources]
    assert points[0] == {"clouds.0.seed": 0, "objective.delta": 0.0}
    assert points[1] == {"clouds.0.seed": 0, "objective.delta": 0.1}
    assert points[-1] == {"clouds.0.seed": 4, "objective.delta": 0.1}
    assert [planner.name for planner in study.grid.planners] == ["ant-system", "exact"]
    assert study.grid.planners[0].planner == fp.AntSystem(ants=3, cycles=2)
    assert (study.grid.seconds("any"), study.grid.memory_limit) == (20.0, 4 * 10**9)


def test_a_point_is_the_problem_of_the_scenario_with_these_values(load):
    study = load(STUDY)
    last = study.grid.sources[9].problem()
    assert last.delta == 0.1
    cloud = fp.generators.cloud(
        seed=4, count=3, low=[1, -1, -0.1], high=[3, 1, 0.1], radii=[0.1, 0.2],
        spared=[([0, 0, 0], 0.0), ([4, 0, 0], 0.0)],
    )  # fmt: skip
    assert (last.scene.centers == cloud.centers).all()


def test_scenario_files_and_settings_of_planners_can_be_axes(load, tmp_path):
    study = load("""
        [scenario]
        file = ["fig2a", "fig2b"]
        [axes]
        "objective.delta" = { low = 0.0, high = 2.0, count = 3 }
        "planner.ants" = [4, 8]
        [[planners]]
        name = "ant-system"
    """)
    assert len(study) == 2 * 3 * 2
    assert study.grid.sources[3].name == "fig2b, objective.delta=0.0"
    assert [each.planner.ants for each in study.grid.planners] == [4, 8]
    assert study.grid.planners[1].axes == {"planner.ants": 8}


def test_without_planners_that_of_the_scenario_runs_with_its_seed(load):
    study = load("[scenario]\nfile = 'fig2b'")
    scenario = fp.Scenario.load("fig2b")
    (named,) = study.grid.planners
    assert (named.planner, named.refine) == (scenario.planner, scenario.refine)
    assert list(study.grid.seeds) == [scenario.seed]
    assert study.grid.sources[0].problem() == scenario.problem


def test_a_file_that_a_scenario_names_is_part_of_the_key(load, tmp_path):
    text = STUDY.replace(
        "[[scenario.clouds]]", "[[scenario.obstacles]]\ncsv='s.csv'\n[[scenario.clouds]]"
    )
    (tmp_path / "s.csv").write_text("x,y,z,radius\n9,9,0,0.1\n")
    before = {task.key for task in load(text).grid.tasks()}
    (tmp_path / "s.csv").write_text("x,y,z,radius\n9,9,0,0.2\n")
    from ffsr_plan.studies.study_files import scenario_grid

    scenario_grid._file_digest.cache_clear()  # a process reads each file once
    assert not before & {task.key for task in load(text).grid.tasks()}


WRONG = [
    ("seeds = [0, 7]", "seeds = [0, 0]", "seeds", "no seed twice"),
    ("high = [3.0", "high = [0.5", "clouds.0: cloud high", "more than low"),
    ("seeds = [0, 7]", "seeds = 0", "seeds", "at least 1"),
    ("seeds = [0, 7]", "sedes = 3", "sedes", "did you mean 'seeds'"),
    ("[scenario.robot]", "[scenario.robt]", "robt", "did you mean 'robot'"),
    ("objective.delta =", "objective.detla =", "axes.objective.detla", "did you mean"),
    ("clouds.0.seed", "clouds.1.seed", "axes.clouds.1.seed", "from 0 to 0"),
    ("[0.0, 0.1]", "[0.0, -0.1]", "axes.objective.delta", "at least 0"),
    ("[0.0, 0.1]", "[-0.5, 0.1]", "axes.objective.delta", "at least 0"),
    ("[0.0, 0.1]", "[0.1, 0.1]", "axes.objective.delta", "different values"),
    ("[0.0, 0.1]", "0.1", "axes.objective.delta", "a list"),
    ("{ count = 5 }", "{ cuont = 5 }", "axes.clouds.0.seed.cuont", "a list"),
    ("{ count = 5 }", "{ count = 0 }", "axes.clouds.0.seed.count", "at least 1"),
    ('label = "exact"', 'label = "ant-system"', "planners", "each name once"),
    ('name = "ant-system"', 'name = "ant-systme"', "planners.0", "did you mean 'ant-system'"),
    ("ants = 3", "ansts = 3", "planners.0", "did you mean 'ants'"),
    ("ants = 3", "seed = 3", "planners.0.seed", "seeds of the study"),
    ("time = 20.0", "time = 0.0", "limits.time", "greater than 0"),
    ("memory =", "memroy =", "limits.memroy", "did you mean"),
    ('title = "spheres"', 'title = "a\\nb"', "title", "printable"),
    ("[axes]", "[axes", "spheres.toml", "a TOML file"),
]


@pytest.mark.parametrize(("old", "new", "place", "allowed"), WRONG)
def test_a_mistake_is_named_by_file_key_and_what_is_allowed(load, old, new, place, allowed):
    assert STUDY.count(old) == 1
    with pytest.raises(fp.InvalidInput) as error:
        load(STUDY.replace(old, new))
    for part in ("spheres.toml", place, allowed):
        assert part in str(error.value)


def test_the_schema_describes_every_key_and_accepts_what_is_read():
    schema = json.loads(json.dumps(study_schema()))
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    assert set(schema["properties"]) == {each.name for each in fields(StudyFile)}
    assert all("description" in each for each in schema["properties"].values())
    kind(schema).validate(tomllib.loads(STUDY))
    for old, new in (("seeds = [0, 7]", "sedes = 3"), ("[scenario.robot]", "[scenario.robt]")):
        assert not kind(schema).is_valid(tomllib.loads(STUDY.replace(old, new)))

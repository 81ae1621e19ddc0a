"""Problem files: schema, checksums, and the same files from the same seeds."""

import hashlib
import json

import jsonschema
import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.problem_set.bench_problem import read_problem
from ffsr_plan.problem_set.families.drafts import BLOCKED, nearest_turn
from ffsr_plan.problem_set.families.mounted import robot_files
from ffsr_plan.problem_set.judging.schemas import SCHEMAS
from ffsr_plan.problem_set.making.generation import FAMILIES, made

FIRST = [
    f"{family}/{'08' if family == 'reaching' else '01'}" for family in FAMILIES
]  # one that is drawn soon


def test_there_are_three_hundred_problems_in_ten_families(problems):
    assert len(problems) >= 300
    assert list(problems.families) == list(FAMILIES)
    assert len(FAMILIES) >= 10
    for family in FAMILIES.values():
        assert len(problems.names(family.name)) == family.count


def test_every_file_has_the_checksum_of_the_index(problems):
    for name in problems.names():
        entry = problems.entry(name)
        content = (problems.folder / entry["file"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == entry["sha256"], name


def test_files_hold_to_their_schemas(problems):
    index = json.loads((problems.folder / "index.json").read_text())
    jsonschema.validate(index, SCHEMAS["index"]())
    validator = jsonschema.Draft202012Validator(SCHEMAS["problem"]())
    for name in FIRST:
        validator.validate(json.loads((problems.folder / f"problems/{name}.json").read_text()))


def test_the_schema_refuses_a_misspelt_table(problems):
    data = json.loads((problems.folder / "problems/traps/00.json").read_text())
    data["scenario"]["gaol"] = data["scenario"].pop("goal")
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, SCHEMAS["problem"]())


@pytest.mark.parametrize("name", FIRST)
def test_the_same_seed_gives_the_same_file(problems, name):
    family, _, number = name.partition("/")
    again = made(FAMILIES[family], int(number), problems.folder)
    text = again.text()
    assert hashlib.sha256(text.encode()).hexdigest() == problems.entry(name)["sha256"]


def test_the_robots_are_made_anew_the_same(problems):
    for name, text in robot_files().items():
        assert (problems.folder / "robots" / name).read_text() == text


def test_most_straight_motions_are_blocked(problems):
    kinds = [each.straight_motion for each in problems]
    assert "free" not in kinds
    assert kinds.count(BLOCKED) > 0.7 * len(kinds)


def test_other_spheres_than_those_of_the_file_are_refused(problems, tmp_path):
    text = (problems.folder / "problems/debris/00.json").read_text()
    changed = text.replace('"count": 100,', '"count": 99,')
    assert changed != text
    (tmp_path / "00.json").write_text(changed)
    with pytest.raises(fp.InvalidInput, match="spheres"):
        _ = read_problem(tmp_path / "00.json", problems.folder).problem


def test_a_changed_file_is_refused(problems, tmp_path):
    text = (problems.folder / "problems/traps/00.json").read_text()
    (tmp_path / "00.json").write_text(text.replace("0.", "1.", 1))
    with pytest.raises(fp.InvalidInput, match="unchanged"):
        read_problem(tmp_path / "00.json", problems.folder, problems.entry("traps/00")["sha256"])


def test_unknown_problems_are_refused_with_the_nearest_name(problems):
    with pytest.raises(fp.InvalidInput, match="traps/07"):
        problems["trap/07"]
    with pytest.raises(fp.InvalidInput, match="traps"):
        problems.names("trapz")


def test_goals_are_not_a_whole_turn_farther_than_need_be(problems):
    for name in [*problems.names("reaching")[:6], "clutter/01", "clutter/03"]:
        problem = problems[name].problem
        robot = problem.robot
        start, goal = robot.joint_values(problem.start), robot.joint_values(problem.goal)
        assert np.allclose(nearest_turn(robot, start, goal), goal, atol=1e-5), name

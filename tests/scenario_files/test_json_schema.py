"""The JSON Schema of scenario files accepts what the reader accepts, and finds mistakes."""

import json
import sys
from dataclasses import fields

import jsonschema
import pytest
from typer.testing import CliRunner

import ffsr_plan as fp
from ffsr_plan.cli import app
from ffsr_plan.core.bundled_files import folder
from ffsr_plan.core.settings import from_mapping
from ffsr_plan.scenario_files.scenario_schema import ScenarioFile
from tests.scenario_files.test_obstacle_sources import ARM, TABLES
from tests.scenario_files.test_scenario import CLOUDS, GOOD

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


@pytest.fixture(scope="module")
def validator():
    printed = CliRunner().invoke(app, ["schema"])
    assert printed.exit_code == 0
    schema = json.loads(printed.stdout)
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    return kind(schema)


@pytest.mark.parametrize("path", sorted(folder("scenarios").glob("*.toml")), ids=lambda p: p.stem)
def test_every_bundled_scenario_is_valid(validator, path):
    validator.validate(tomllib.loads(path.read_text(encoding="utf-8")))


FLOATS = ARM.replace("MODE", "free-floating")
PORTFOLIO = """
[planner.lattice]
name = "ant-system"
ants = 8
[planner.trees]
checks = 20000
"""
BOTH = (
    GOOD.replace("ants = 8\n", "").replace("rho = 0.7\n", "").replace('"ant-system"', '"portfolio"')
    + PORTFOLIO
)


@pytest.mark.parametrize("text", [GOOD, GOOD + CLOUDS, GOOD + TABLES, FLOATS, BOTH])
def test_what_the_reader_takes_is_valid(validator, text):
    validator.validate(tomllib.loads(text))


WRONG = [
    ("[lattice]", "[latice]"),
    ("radius = 0.3", "radios = 0.3"),
    ("radius = 0.3", ""),
    ("radius = 0.3", 'radius = "wide"'),
    ("radius = 0.3", 'radius = 0.3\ncsv = "debris.csv"'),
    ("[3.0, 0.4, 0.0]", "[3.0, 0.4]"),
    ("half_count = 6", "half_count = 6.5"),
    ('"ant-system"', '"ants"'),
    ("[start]", 'mode = "floating"\n[start]'),
    ("seed = 5", "seed = true"),
    ("[lattice]", '[[obstacles]]\nmesh = "station.stl"\n[lattice]'),
    ("rho = 0.7", "patience = 3"),
    ("rho = 0.7", "rho = 1.0"),
    ("divisions = 12", "divisions = 1"),
]


@pytest.mark.parametrize(("right", "wrong"), WRONG, ids=[w for _, w in WRONG])
def test_wrong_scenarios_are_not(validator, right, wrong):
    assert right in GOOD
    data = tomllib.loads(GOOD.replace(right, wrong))
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(data)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [('"ant-system"', '"tree-planner"'), ("ants = 8", "cycle = 8"), ("checks", "check"),
     ('name = "ant-system"\n', "")],
    ids=str,
)  # fmt: skip
def test_wrong_parts_of_a_portfolio_are_not_valid(validator, right, wrong):
    assert right in BOTH
    text = BOTH.replace(right, wrong)
    with pytest.raises(jsonschema.ValidationError):
        validator.validate(tomllib.loads(text))
    with pytest.raises(fp.InvalidInput, match="planner"):
        from_mapping(ScenarioFile, tomllib.loads(text))


def test_a_portfolio_is_read_with_the_settings_of_both():
    table = from_mapping(ScenarioFile, tomllib.loads(BOTH)).planner
    lattice, trees = fp.AntSystem(ants=8), fp.TreePlanner(checks=20_000)
    assert (table.planner(), table.seed) == (fp.Portfolio(lattice, trees), 5)


def test_every_table_says_what_it_is(validator):
    tables = validator.schema["$defs"]
    for name, table in tables.items():
        described = {key for key, entry in table["properties"].items() if "description" in entry}
        assert table["description"].endswith((".", "`."))
        assert set(table["properties"]) - described <= {"name"}, name
    assert set(validator.schema["properties"]) == {each.name for each in fields(ScenarioFile)}
    position = tables["EndEffectorTable"]["properties"]["position"]
    assert position["description"] == "(3,) wanted for the frame's origin, world [m]."

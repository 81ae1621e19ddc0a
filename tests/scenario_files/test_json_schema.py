"""The JSON Schema of scenario files accepts what the reader accepts, and finds mistakes."""

import json
import sys
from dataclasses import fields

import jsonschema
import pytest
from typer.testing import CliRunner

from ffsr_plan.cli import app
from ffsr_plan.core.bundled_files import folder
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


@pytest.mark.parametrize("text", [GOOD, GOOD + CLOUDS, GOOD + TABLES, FLOATS])
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


def test_every_table_says_what_it_is(validator):
    tables = validator.schema["$defs"]
    for name, table in tables.items():
        described = {key for key, entry in table["properties"].items() if "description" in entry}
        assert table["description"].endswith((".", "`."))
        assert described == set(table["properties"]) - {"name"}, name
    assert set(validator.schema["properties"]) == {each.name for each in fields(ScenarioFile)}
    position = tables["EndEffectorTable"]["properties"]["position"]
    assert position["description"] == "(3,) wanted for the frame's origin, world [m]."

"""Scenario files with bodies that move."""

import sys

import numpy as np
import pytest

import ffsr_plan as fp
from tests.scenario_files.test_json_schema import validator  # noqa: F401 - a fixture
from tests.scenario_files.test_scenario import GOOD, write

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

BODIES = """
[pace]
duration = 100.0
ramp = 0.25
[[bodies]]
name = "debris"
position = [2.0, -30.0, 0.0]
drift = { velocity = [0.0, 0.1, 0.0] }
shapes = [{ ball = { radius = 0.2 } }, { center = [0.5, 0.0, 0.0], radius = 0.1 }]
[[bodies]]
position = [2.0, 30.0, 0.0]
attitude = [0.1, 0.2, 0.3]
spin = { rate = [0.0, 0.0, 0.1] }
shapes = [{ ball = { radius = 1.0 } }]
[[bodies]]
name = "target"
position = [9.0, 30.0, 0.0]
tumble = { inertia = [1.0, 2.0, 2.5], rate = [0.0, 0.05, 0.01] }
shapes = [{ box = { size = [1.0, 1.0, 1.0] } }]
[[bodies]]
track = { csv = "track.csv" }
shapes = [{ box = { size = [1.0, 1.0, 1.0] } }]
"""
TRACK = "t,x,y,z,qx,qy,qz,qw\n0,50,0,0,0,0,0,1\n200,60,0,0,0,0,0,1\n"


def loaded(folder, text):
    (folder / "track.csv").write_text(TRACK)
    return fp.load_scenario(write(folder, GOOD + text))


def test_bodies_are_those_of_python(tmp_path, validator):  # noqa: F811
    validator.validate(tomllib.loads(GOOD + BODIES))
    problem = loaded(tmp_path, BODIES)
    assert (problem.duration, problem.ramp) == (100.0, 0.25)
    assert problem.scene.bodies == (
        fp.MovingBody(
            [fp.Ball(0.2), fp.Ball(0.1, (0.5, 0.0, 0.0))],
            fp.Drift((0.0, 0.1, 0.0)),
            (2.0, -30.0, 0.0),
            name="debris",
        ),
        fp.MovingBody([fp.Ball(1.0)], fp.Spin((0.0, 0.0, 0.1)), (2.0, 30.0, 0.0), (0.1, 0.2, 0.3)),
        fp.MovingBody(
            [fp.Box((1.0, 1.0, 1.0))],
            fp.Tumble((1.0, 2.0, 2.5), (0.0, 0.05, 0.01)),
            (9.0, 30.0, 0.0),
            name="target",
        ),
        fp.MovingBody(
            [fp.Box((1.0, 1.0, 1.0))],
            fp.Track([0, 200], [[50, 0, 0], [60, 0, 0]], np.tile([0.0, 0.0, 0.0, 1.0], (2, 1))),
        ),
    )


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("duration = 100.0\nramp = 0.25", "", "duration"),
        ("duration = 100.0", "duration = 300.0", "at most 200 s"),
        ("drift = { velocity = [0.0, 0.1, 0.0] }", "", r"bodies\.0: .*one of drift, spin"),
        ("drift = {", "spin = { rate = [0, 0, 1] }\ndrift = {", "one of drift, spin"),
        ("velocity =", "velocty =", "velocity"),
        ("inertia = [1.0, 2.0, 2.5]", "inertia = [1.0, 2.0, 9.5]", "bodies.2.*inertia"),
        ('csv = "track.csv"', 'csv = "none.csv"', "none.csv"),
        ("shapes = [{ ball = { radius = 0.2", "shapes = [] # [{ ball", "bodies.0.*shapes"),
    ],
)
def test_a_body_that_is_wrong_is_named(tmp_path, old, new, words):
    assert BODIES.count(old) == 1
    with pytest.raises(fp.InvalidInput, match=f"(?s){words}"):
        loaded(tmp_path, BODIES.replace(old, new))

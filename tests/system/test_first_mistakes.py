"""What a new user ran into: results that could not be kept, numbers that are none, slips of pen."""

import json

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.scene import generators
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

GOOD = inertial(2.0, (0.1, 0.2, 0.25))
NAN = float("nan")


@pytest.fixture(scope="module")
def plan():
    return fp.plan(fp.load_scenario("fig2b"), fp.LatticeOptimum())


def test_plans_with_cycles_without_a_path_are_saved(tmp_path):
    found = fp.plan(fp.load_scenario("debris"), fp.MaxMinAntSystem(ants=2), seed=0, refine=False)
    assert np.isinf(found.history.iteration_best).any()
    found.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == found
    json.dumps(found.to_dict(), allow_nan=False)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("configurations", lambda d: [[NAN] * 13 for _ in d["configurations"]]),
        ("configurations", lambda d: [[NAN, *q[1:]] for q in d["configurations"]]),
        ("clearances", lambda d: [NAN for _ in d["clearances"]]),
        ("nodes", lambda d: [n + 0.5 for n in d["nodes"]]),
        ("optimum", lambda d: 1e9),
        ("trails", lambda d: {**d["trails"], "layer": "abc"}),
        ("trails", lambda d: {**d["trails"], "layer": [1.5]}),
        ("trails", lambda d: {k: [10**9] for k in d["trails"]}),
        ("history", lambda d: {**d["history"], "best": "abc"}),
        ("history", lambda d: {**d["history"], "best": [1.0, 2.0]}),
    ],
)
def test_a_dictionary_with_what_no_plan_holds_is_refused(plan, field, value):
    data = plan.to_dict()
    data[field] = value(data)
    with pytest.raises(fp.InvalidInput):
        fp.Plan.from_dict(data)


def test_what_is_not_a_number_does_not_verify(plan):
    for name in ("configurations", "clearances"):
        wrong = fp.Plan.from_dict(plan.to_dict())
        values = np.array(getattr(wrong, name))
        values[3] = NAN
        object.__setattr__(wrong, name, values)
        assert not wrong.verify(5).ok


def test_too_many_truss_spheres_are_refused_with_a_radius():
    with pytest.raises(fp.InvalidInput, match=r"truss radius.*m or more"):
        generators.truss((0, 0, 0), (1000, 0, 0), width=0.5, bays=3, radius=1e-6)


def test_limits_beyond_all_measure_are_refused(plan):
    with pytest.raises(fp.InvalidInput, match=r"joint_acceleration.*1e"):
        plan.timed(joint_acceleration=1e15, thruster_acceleration=1.0)
    with pytest.raises(fp.InvalidInput, match=r"thruster_acceleration.*1e"):
        plan.timed(joint_acceleration=1.0, thruster_acceleration=1e300)


def arm(text):
    return urdf(
        link("base", GOOD, box((0.5, 0.5, 0.5))), link("arm", GOOD, box((0.2, 0.2, 0.2))), text
    )


HINGE = joint("j", "revolute", "base", "arm", (1, 0, 0))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("collision>", "colision>", "link '.*': got 'colision'.*did you mean 'collision'"),
        ("<axis", "<axes", "joint 'j': got 'axes'.*did you mean 'axis'"),
        ("</inertial>", "</inertial>" + GOOD, "<inertial>: got '2 of them'"),
        ("</joint>", "<limit lower='0' upper='1' effort='1' velocity='1'/></joint>", "<limit>"),
        ("<mass value='2.0'", "<mass value='1e30'", "mass: got .*at most 1e"),
    ],
)
def test_a_part_misspelt_or_given_twice_is_named(old, new, message):
    text = arm(HINGE)
    assert robot_from_urdf(text, "made").joint_names == ("j",)
    assert old in text
    with pytest.raises(fp.InvalidInput, match=message):
        robot_from_urdf(text.replace(old, new), "made")


def test_parts_that_other_tools_add_are_left_to_them():
    text = arm(HINGE).replace("</joint>", "<hardwareInterface>e</hardwareInterface></joint>")
    robot = robot_from_urdf(text.replace("</link>", "<drake:x xmlns:drake='d'/></link>"), "made")
    assert robot.nd == 1


@pytest.mark.parametrize("path", [None, 3, np.ones((3, 4))])
def test_what_is_no_path_is_refused_as_such(path):
    for read in (fp.Scene.from_csv, fp.Scene.from_numpy):
        with pytest.raises(fp.InvalidInput, match="a path"):
            read(path)


def test_complex_numbers_are_no_places(tmp_path):
    np.save(tmp_path / "a.npy", np.ones((3, 4), dtype=complex))
    with pytest.raises(fp.InvalidInput, match="real numbers"):
        fp.Scene.from_numpy(tmp_path / "a.npy")


def test_only_a_plan_can_be_played():
    problem, refused = fp.load_scenario("fig2b"), pytest.raises(fp.InvalidInput, match="a Plan")
    with fp.LiveView(problem, open_browser=False) as view, refused:
        view.finish(None)

"""Tables with a unit in every header, and dictionaries of plans."""

import csv
import json
import re

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf


@pytest.fixture(scope="module")
def plan():
    """A revolute, a prismatic and a continuous joint past half a turn, on a path with corners."""
    body = inertial(1.0, (0.05, 0.06, 0.07), (0.1, 0.0, 0.0))
    robot = robot_from_urdf(
        urdf(
            link("base", inertial(9.0, (0.4, 0.5, 0.6)), box((0.4, 0.4, 0.4))),
            link("wrist", body, box((0.1, 0.1, 0.1))),
            link("hand", body, box((0.1, 0.1, 0.1), (0.2, 0.0, 0.0))),
            link("tray", body, box((0.1, 0.1, 0.1))),
            joint("yaw, left", "revolute", "base", "wrist", (0.0, 0.5, 0.0), axis=(0.0, 0.6, 0.8)),
            joint("spin", "continuous", "wrist", "hand", (0.2, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
            joint("slide", "prismatic", "base", "tray", (0.0, -0.5, 0.0), axis=(0.0, -1.0, 0.0)),
        ),
        "made",
    )
    start = robot.configuration(joints={"yaw, left": 0.3, "spin": 2.8, "slide": 0.1})
    goal = robot.configuration(
        (6.0, 0.0, 0.0), (0.5, 0.2, -0.3), {"yaw, left": -0.5, "spin": -2.9, "slide": 0.4}
    )
    problem = fp.Problem(
        robot, fp.Scene([[3.0, 0.0, 0.0]], [0.3]), start, goal, mode="attitude-held", delta=0.5,
        lattice=fp.Lattice(6, fp.Axis(6, 0.4)),
    )  # fmt: skip
    return fp.plan(problem, fp.LatticeOptimum())


@pytest.fixture(scope="module")
def flight(plan):
    return plan.timed(
        corners="rest",
        joint_acceleration=0.1,
        thruster_acceleration=0.05,
        turn_acceleration=0.02,
    )


def read(path):
    """Columns by header, read by Python's csv module."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    values = np.array(rows[1:], dtype=float)
    assert len(set(rows[0])) == len(rows[0])
    return dict(zip(rows[0], values.T, strict=True))


def vectors(table, header):
    return np.column_stack([table[header.format(axis)] for axis in "xyz"])


def unit(robot, name, turning, sliding):
    return sliding if robot.prismatic[robot.joint_names.index(name)] else turning


@pytest.mark.parametrize("samples", [None, 50])
def test_a_path_read_back_is_the_plan_in_full_precision(plan, tmp_path, samples):
    robot = plan.problem.robot
    plan.to_csv(tmp_path / "path.csv", samples)
    table = read(tmp_path / "path.csv")
    s = table["s [1]"]
    assert np.array_equal(s, np.linspace(0.0, 1.0, samples or 7))
    q = plan.at(s)
    assert np.array_equal(vectors(table, "base_{} [m]"), q[:, :3])
    assert np.array_equal(
        np.column_stack([table[f"base_q{axis} [1]"] for axis in "xyzw"]), q[:, 3:7]
    )
    angles = np.column_stack([table[f"{name} [rad]"] for name in ("alpha", "beta", "gamma")])
    turned = rotations.from_angles(angles)
    assert np.allclose(rotations.angle_between(turned, q[:, 3:7]), 0.0, atol=1e-9)
    joints = [table[f"{n} position [{unit(robot, n, 'rad', 'm')}]"] for n in robot.joint_names]
    again = robot.assemble(q[:, :3], q[:, 3:7], np.column_stack(joints))
    assert np.allclose(again, q, atol=1e-12)
    assert np.abs(np.diff(joints, axis=1)).max() < 1.0  # no jump at half a turn


def test_a_trajectory_read_back_is_the_timed_plan(plan, flight, tmp_path):
    robot = plan.problem.robot
    flight.to_csv(tmp_path / "trajectory.csv", rate=2.0)
    table = read(tmp_path / "trajectory.csv")
    t = table["t [s]"]
    assert np.allclose(np.diff(t)[:-1], 0.5)
    assert t[0] == 0.0
    assert t[-1] == flight.duration
    states = flight.at(t)
    for header, values in (
        ("base_v{} (world axes) [m/s]", states.base_velocity),
        ("base_w{} (base axes) [rad/s]", states.velocities[:, 3:6]),
        ("base_a{} (world axes) [m/s^2]", states.base_acceleration),
        ("base_dw{} (base axes) [rad/s^2]", states.accelerations[:, 3:6]),
        ("thrust_{} (world axes) [N]", states.thrust),
        ("wheel_torque_{} (base axes) [N m]", states.wheel_torque),
        ("wheel_momentum_{} (base axes) [N m s]", states.wheel_momentum),
    ):
        assert np.array_equal(vectors(table, header), values)
        assert np.any(values != 0.0)
    for k, name in enumerate(robot.joint_names):
        position = table[f"{name} position [{unit(robot, name, 'rad', 'm')}]"]
        assert np.array_equal(position, states.joints[:, k])
        assert np.abs(np.diff(position)).max() < 1.0  # no jump at half a turn
        for quantity, values, units in (
            ("velocity", states.velocities[:, 6 + k], ("rad/s", "m/s")),
            ("acceleration", states.accelerations[:, 6 + k], ("rad/s^2", "m/s^2")),
            ("torque", states.torques[:, k], ("N m", "N")),
        ):
            due = unit(robot, name, *units)
            what = "force" if due == "N" else quantity
            assert np.array_equal(table[f"{name} {what} [{due}]"], values)
    q = plan.at(table["s [1]"])
    assert np.allclose(vectors(table, "base_{} [m]"), q[:, :3], atol=1e-12)


def test_every_header_ends_in_a_unit(plan, flight, tmp_path):
    plan.to_csv(tmp_path / "a.csv")
    flight.to_csv(tmp_path / "b.csv", rate=0.1)
    headers = [*read(tmp_path / "a.csv"), *read(tmp_path / "b.csv")]
    units = {re.fullmatch(r"[^\[\]]+ \[([^\[\]]+)\]", header)[1] for header in headers}
    assert units == {
        "1", "m", "rad", "s", "m/s", "rad/s", "m/s^2", "rad/s^2", "N", "N m", "N m s"
    }  # fmt: skip


def test_tables_replace_whole_files_and_say_where_they_cannot(plan, flight, tmp_path):
    target = tmp_path / "path.csv"
    target.write_text("something else\n" * 1000)
    plan.to_csv(target)
    assert len(read(target)["s [1]"]) == 7
    assert [p.name for p in tmp_path.iterdir()] == ["path.csv"]
    for place in (target / "inside.csv", tmp_path / "no" / "where.csv", tmp_path):
        for write in (plan.to_csv, lambda path: flight.to_csv(path, rate=1.0), plan.save):
            with pytest.raises(fp.InvalidInput, match="can be written"):
                write(place)
    assert not list(tmp_path.parent.glob("*.part"))


@pytest.mark.parametrize("rate", [0.0, -1.0, np.inf, "fast", 1e9])
def test_rates_that_cannot_be_are_refused(flight, tmp_path, rate):
    with pytest.raises(fp.InvalidInput, match="rate"):
        flight.to_csv(tmp_path / "t.csv", rate)


@pytest.mark.parametrize("samples", [1, 0, 2.5, 10**9])
def test_numbers_of_samples_that_cannot_be_are_refused(plan, tmp_path, samples):
    with pytest.raises(fp.InvalidInput, match="samples"):
        plan.to_csv(tmp_path / "t.csv", samples)


def test_a_dictionary_goes_through_json_and_gives_the_same_plan(plan, tmp_path):
    data = plan.to_dict()
    again = fp.Plan.from_dict(json.loads(json.dumps(data, allow_nan=False)))
    assert again == plan
    assert fp.Plan.from_dict(data) == plan
    plan.save(tmp_path / "plan.json")
    saved = json.loads((tmp_path / "plan.json").read_text())
    saved.pop("sha256")
    assert saved == json.loads(json.dumps(data))


@pytest.mark.parametrize("data", [None, [], {}, {"format": "ffsr-plan/3"}, {"format": "other"}])
def test_dictionaries_that_are_no_plan_are_refused(data):
    with pytest.raises(fp.InvalidInput, match="plan"):
        fp.Plan.from_dict(data)


def test_a_dictionary_with_impossible_fields_is_refused(plan):
    for field, value in (("clearances", [0.1]), ("length", "long"), ("nodes", [99] * 7)):
        with pytest.raises(fp.InvalidInput):
            fp.Plan.from_dict(plan.to_dict() | {field: value})

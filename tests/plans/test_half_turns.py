"""Held half turns: one sense, the same for the caller's numbers, the plan and its file."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

BODY = inertial(4.0, (0.2, 0.3, 0.4))


@pytest.fixture(scope="module")
def wheel():
    """A box that turns a rod about its own z axis without end."""
    return robot_from_urdf(
        urdf(
            link("base", BODY, box((0.3, 0.4, 0.5))),
            link("rod", BODY, box((0.6, 0.1, 0.1), (0.3, 0, 0))),
            joint("spin", "continuous", "base", "rod", (0.0, 0.0, 0.4)),
        ),
        "wheel",
    )


def half_turn(robot, rng):
    start = np.array(robot.configuration(attitude=rng.uniform(-3, 3, 3)))
    axis = rng.normal(size=3)
    goal = start.copy()
    goal[0] = 1.0
    goal[3:7] = rotations.multiply(start[3:7], np.append(axis / np.linalg.norm(axis), 0.0))
    return start, goal


def test_checked_configurations_turn_like_the_callers(wheel):
    rng = np.random.default_rng(1)
    for _ in range(2000):
        start, goal = half_turn(wheel, rng)
        checked = [wheel.check_configuration("q", q) for q in (start, goal)]
        twice = [wheel.check_configuration("q", q) for q in checked]
        assert all(np.array_equal(a, b) for a, b in zip(checked, twice, strict=True))
        halves = [
            Motion(wheel, "attitude-held", a, b, np.stack([a[:3], b[:3]])).attitudes_at(
                np.array([0.5])
            )
            for a, b in ((start, goal), checked)
        ]
        assert rotations.angle_between(*halves) < 1e-12


def test_a_plan_read_from_its_file_turns_the_same_way(wheel, tmp_path):
    rng, path = np.random.default_rng(2), tmp_path / "plan.json"
    for _ in range(60):
        start, goal = half_turn(wheel, rng)
        problem = fp.Problem(wheel, fp.Scene(), start, goal, "attitude-held", fp.Lattice(2))
        plan = fp.plan(problem, fp.LatticeOptimum())
        plan.save(path)
        loaded = fp.Plan.load(path)
        assert loaded == plan
        s = np.linspace(0.0, 1.0, 9)
        assert np.array_equal(loaded.at(s), plan.at(s))
    assert loaded.verify(50).ok
    assert plan.length == pytest.approx(np.hypot(1.0, np.pi))


def test_half_a_turn_of_a_continuous_joint_is_positive(wheel):
    rng = np.random.default_rng(3)
    for begin in rng.uniform(-np.pi, np.pi, 500):
        for turn in (np.pi, -np.pi):
            ends = [wheel.configuration(joints={"spin": v}) for v in (begin, begin + turn)]
            assert wheel.joint_change(*ends) == pytest.approx(np.pi)
    for turn in (3.14, -3.14, 0.2):
        ends = [wheel.configuration(joints={"spin": v}) for v in (0.0, turn)]
        assert wheel.joint_change(*ends) == pytest.approx(turn)


def test_cosine_and_sine_of_few_digits_begin_at_the_start(wheel):
    start = np.array(wheel.configuration(joints={"spin": 0.7}))
    start[7:9] = np.round(start[7:9], 7)
    goal = wheel.configuration((1, 0, 0), joints={"spin": -0.4})
    problem = fp.Problem(wheel, fp.Scene(), start, goal, lattice=fp.Lattice(2))
    assert np.hypot(*problem.start[7:9]) == pytest.approx(1.0, abs=1e-15)
    plan = fp.plan(problem, fp.LatticeOptimum())
    assert np.max(np.abs(plan.configurations[0] - problem.start)) < 1e-15
    assert plan.verify(20).ok

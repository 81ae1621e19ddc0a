"""Nothing actuates the base: momentum is zero and the centre of mass at rest."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.urdf_builders import random_configuration, random_robot, random_scene

seeds = st.integers(0, 100_000)


def floating(seed, mode="free-floating"):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    positions = np.tile(start[:3], (2, 1))
    return Motion(robot, mode, start, goal, positions)


def along(motion, times):
    return motion.at(np.zeros(len(times), dtype=int), np.asarray(times, dtype=float))


@given(seeds)
def test_the_centre_of_mass_stays_put(seed):
    motion = floating(seed)
    data = motion.robot.model.createData()
    q = along(motion, np.linspace(0, 1, 9))
    centers = [np.array(pin.centerOfMass(motion.robot.model, data, one)) for one in q]
    assert np.ptp(centers, axis=0) == pytest.approx(np.zeros(3), abs=1e-12)


@given(seeds)
def test_linear_and_angular_momentum_are_zero(seed):
    motion, step = floating(seed), 1e-4
    model, data = motion.robot.model, motion.robot.model.createData()
    before, here, after = along(motion, [0.4 - step, 0.4, 0.4 + step])
    v = pin.difference(model, before, after) / (2 * step)
    pin.computeCentroidalMomentum(model, data, here, v)
    total = np.concatenate([data.hg.linear, data.hg.angular])
    pin.computeCentroidalMap(model, data, here)
    scale = np.abs(data.Ag) @ np.abs(v)
    assert np.all(np.abs(total) <= 1e-5 * np.maximum(scale, 1e-3))


@given(seeds)
def test_the_attitude_is_that_of_the_free_flying_base(seed):
    times = np.linspace(0, 1, 5)
    floats, flies = (along(floating(seed, m), times) for m in ("free-floating", "free-flying"))
    assert np.allclose(floats[:, 3:], flies[:, 3:], atol=1e-12)


@given(seeds)
def test_the_generalized_jacobian_is_that_of_the_floating_motion(seed):
    motion, step = floating(seed), 1e-5
    robot, model = motion.robot, motion.robot.model
    data, frame = model.createData(), model.frames[model.nframes - 1].name
    before, here, after = along(motion, [0.5 - step, 0.5, 0.5 + step])
    places = []
    for q in (before, after):
        pin.framesForwardKinematics(model, data, q)
        places.append(np.array(data.oMf[model.getFrameId(frame)].translation))
    rates = motion.joint_values[1] - motion.joint_values[0]
    expected = (fp.momentum.generalized_jacobian(robot, here, frame) @ rates)[:3]
    assert (places[1] - places[0]) / (2 * step) == pytest.approx(expected, abs=1e-6)


def arms_that_swing(robot, **changes):
    start = robot.configuration((1, 2, 0), (0.3, 0, 0), {"left_1": -0.5, "left_2": -1.0})
    goal = robot.configuration((9, 9, 9), joints={"left_1": 0.9, "right_1": 0.5})
    wanted = {
        "scene": fp.Scene([[2.2, 3.4, 0.0]], [0.2]),
        "start": start,
        "goal": goal,
        "mode": "free-floating",
        "lattice": fp.Lattice(10),
        **changes,
    }
    return fp.Problem(robot, **wanted)


@pytest.mark.parametrize("planner", [fp.LatticeOptimum(), fp.MaxMinAntSystem(cycles=5)])
def test_a_plan_without_thrusters_is_certified_and_verified(robot, planner, tmp_path):
    plan = fp.plan(arms_that_swing(robot), planner)
    report = plan.verify(200)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    assert report.center_drift <= 1e-12
    assert 0.0 < plan.certificate.least_clearance <= report.least_clearance
    assert np.linalg.norm(plan.configurations[-1, :2] - (1, 2)) > 0.05  # the base was moved
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan


def test_the_goals_position_and_attitude_are_not_demanded(robot):
    plan = fp.plan(arms_that_swing(robot), fp.LatticeOptimum())
    elsewhere = robot.configuration((0, 0, 0), (1, 1, 1), {"left_1": 0.9, "right_1": 0.5})
    again = fp.plan(arms_that_swing(robot, goal=elsewhere), fp.LatticeOptimum())
    assert np.array_equal(plan.configurations, again.configurations)
    assert plan.objective == again.objective


def test_a_base_that_flies_is_not_passed_off_as_one_that_floats(robot):
    problem = arms_that_swing(robot)
    plan = fp.plan(problem, fp.LatticeOptimum())
    still = np.tile(problem.start[:3], (11, 1))
    motion = Motion(robot, "free-flying", problem.start, problem.goal, still)
    report = replace(plan, motion=motion).verify(20)
    assert not report.ok
    assert report.center_drift > 0.01
    assert any("without thrusters" in p for p in report.problems)


def test_no_thrusters_no_lateral_axis(robot):
    with pytest.raises(fp.InvalidInput, match="lateral axis, no thrusters"):
        arms_that_swing(robot, lattice=fp.Lattice(10, fp.Axis(2, 0.1)))


@given(seeds)
@settings(max_examples=25)
def test_plans_of_random_robots_verify(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    scene = random_scene(rng, 3, -2.5, 2.5, (0.05, 0.2))
    problem = fp.Problem(robot, scene, start, goal, "free-floating", fp.Lattice(4))
    try:
        plan = fp.plan(problem, fp.LatticeOptimum())
    except fp.PlanningError:
        return
    report = plan.verify(100)
    assert report.ok, report.problems


def test_a_scenario_that_floats_has_no_goal_position(tmp_path):
    text = """
    [robot]
    urdf = "planar_dual_arm"
    mode = "free-floating"
    [goal]
    joints = { left_1 = 0.9 }
    [lattice]
    divisions = 10
    """
    path = tmp_path / "floats.toml"
    path.write_text(text)
    assert fp.plan(fp.load_scenario(path)).verify(50).ok
    path.write_text(text.replace("[goal]", "[goal]\n    position = [1.0, 0.0, 0.0]"))
    with pytest.raises(fp.InvalidInput, match=r"goal.position.*free-floating"):
        fp.load_scenario(path)

"""Angular momentum of wheels that hold the attitude."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics import wheel_momentum as wheels
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.wheel_momentum import rest_to_rest, wheel_momentum
from ffsr_plan.plans import plan_data
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import (
    box,
    inertial,
    joint,
    link,
    random_configuration,
    random_robot,
    urdf,
)

seeds = st.integers(0, 10_000)


def held_motion(seed, edges=5):
    """A random robot along a random bent path, its arms and its attitude changing."""
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    way = np.linspace(start[:3], goal[:3], edges + 1)
    way[1:-1] += rng.normal(size=(edges - 1, 3))
    return Motion(robot, "attitude-held", start, goal, way)


def robots_momentum(motion, s, step=1e-4):
    """(3,) momentum of base and arms per unit of s, world axes, from finite differences."""
    model, data = motion.robot.model, motion.robot.model.createData()
    parameters = np.array([s - step, s, s + step]) * motion.edges
    edge = np.full(3, int(s * motion.edges))
    poses = []
    for q in motion.at(edge, parameters - edge):
        pin.forwardKinematics(model, data, q)
        poses.append([pin.SE3(data.oMi[j]) for j in range(1, model.njoints)])
    masses = np.array([body.mass for body in list(model.inertias)[1:]])[:, None]
    points = np.array([
        [pose.act(model.inertias[j].lever) for j, pose in enumerate(each, start=1)]
        for each in poses
    ])  # fmt: skip
    arms = points - np.sum(masses * points, axis=1, keepdims=True) / masses.sum()
    speeds = (arms[2] - arms[0]) / (2 * step)
    total = np.sum(masses * np.cross(arms[1], speeds), axis=0)
    for j, (before, now, after) in enumerate(zip(*poses, strict=True), start=1):
        spin = pin.log3(after.rotation @ before.rotation.T) / (2 * step)
        inertia = now.rotation @ model.inertias[j].inertia @ now.rotation.T
        total += inertia @ spin
    return total


@given(seeds)
@settings(max_examples=30)
def test_wheels_store_minus_the_momentum_of_finite_differences(seed):
    motion = held_motion(seed)
    times = np.array([0.9, 2.3, 3.1])
    found = wheel_momentum(motion, 4.0, times)
    _, rate = rest_to_rest(times / 4.0)
    expected = [
        -robots_momentum(motion, s, 1e-4) * r / 4.0
        for s, r in zip(found.parameters, rate, strict=True)
    ]
    assert np.allclose(found.world, expected, rtol=1e-5, atol=1e-6)
    pose = rotations.slerp(motion.attitudes[0], motion.attitudes[-1], found.parameters)
    assert np.allclose(
        np.einsum("nij,nj->ni", rotations.matrix(pose), found.vectors), found.world, atol=1e-12
    )


def test_the_quintic_law_rests_at_both_ends():
    u = np.linspace(0.0, 1.0, 101)
    s, rate = rest_to_rest(u)
    ahead, behind = rest_to_rest(u[1:-1] + 1e-6)[0], rest_to_rest(u[1:-1] - 1e-6)[0]
    assert s[0] == rate[0] == rate[-1] == 0.0
    assert s[-1] == 1.0
    assert np.allclose(rate[1:-1], (ahead - behind) / 2e-6, atol=1e-9)
    assert rate.max() == pytest.approx(15 / 8)


@given(seeds, st.floats(1e-3, 1e6))
@settings(max_examples=20)
def test_momentum_goes_as_one_over_the_duration(seed, duration):
    motion = held_motion(seed)
    u = np.linspace(0.0, 1.0, 9)
    slow, unit = wheel_momentum(motion, duration, u * duration), wheel_momentum(motion, 1.0, u)
    assert np.allclose(slow.vectors * duration, unit.vectors, rtol=1e-9, atol=1e-9)
    assert slow.peak * duration == pytest.approx(unit.peak, rel=1e-9)


def test_nothing_is_stored_without_motion_of_arms_or_attitude():
    motion = held_motion(3)
    found = wheel_momentum(motion, 10.0)
    assert np.all(found.vectors[[0, -1]] == 0.0)
    assert found.peak > 0.01
    q = random_configuration(motion.robot, np.random.default_rng(1))
    way = np.random.default_rng(2).normal(size=(6, 3))
    still = Motion(motion.robot, "attitude-held", q, q, way)
    assert wheel_momentum(still, 10.0).peak < 1e-15


@given(seeds)
@settings(max_examples=20)
def test_turning_the_frame_of_the_whole_motion_turns_the_vector(seed):
    """In world axes; in base axes nothing changes. A translation changes neither."""
    motion, rng = held_motion(seed), np.random.default_rng(seed)
    turn = rotations.from_angles(rng.uniform(-1.5, 1.5, 3))
    rotation, shift = rotations.matrix(turn), rng.normal(size=3)
    ends = motion.configurations()[[0, -1]]
    ends[:, :3] = ends[:, :3] @ rotation.T + shift
    ends[:, 3:7] = rotations.multiply(turn, ends[:, 3:7])
    way = motion.positions @ rotation.T + shift
    turned = wheel_momentum(Motion(motion.robot, motion.mode, *ends, way), 7.0)
    found = wheel_momentum(motion, 7.0)
    assert np.allclose(turned.vectors, found.vectors, atol=1e-12)
    assert np.allclose(turned.world, found.world @ rotation.T, atol=1e-12)


def test_a_turn_without_arms_stores_inertia_times_rate():
    """Closed form: 2 kg m^2 turned by 1.2 rad in 10 s, at most 15/8 of the mean rate."""
    robot = robot_from_urdf(urdf(link("base", inertial(9.0, (1.0, 1.5, 2.0)), box((1, 1, 1)))), "b")
    start, goal = robot.configuration(), robot.configuration((3, 0, 0), attitude=(1.2, 0, 0))
    way = np.linspace(start[:3], goal[:3], 5)
    found = wheel_momentum(Motion(robot, "attitude-held", start, goal, way), 10.0)
    assert np.allclose(found.axis_peaks, [0.0, 0.0, 2.0 * 0.12 * 15 / 8], atol=1e-12)
    assert found.vectors[500, 2] < 0.0  # the wheels spin against the base


def test_one_rotating_arm_stores_its_reduced_inertia_times_rate():
    """Closed form: two bodies about their common centre of mass, the base at rest."""
    robot = robot_from_urdf(
        urdf(
            link("base", inertial(6.0, (1.0, 1.0, 1.0))),
            link("arm", inertial(3.0, (0.01, 0.2, 0.2), (0.5, 0, 0))),
            joint("j", "continuous", "base", "arm", (0, 0, 0)),
        ),
        "made",
    )  # fmt: skip
    start, goal = robot.configuration(), robot.configuration((1, 0, 0), joints={"j": 2.0})
    motion = Motion(robot, "attitude-held", start, goal, np.linspace(start[:3], goal[:3], 3))
    reduced = 0.2 + 6.0 * 3.0 / 9.0 * 0.5**2
    found = wheel_momentum(motion, 4.0, [2.0])
    assert np.allclose(found.vectors, [[0.0, 0.0, -reduced * 0.5 * 15 / 8]], atol=1e-12)


@pytest.fixture(scope="module")
def held_plan(robot):
    start = robot.configuration(joints={"left_1": -0.6, "right_2": 0.4})
    goal = robot.configuration((4, 0, 0), (0.8, 0, 0), {"left_1": 0.7, "right_1": -0.5})
    problem = fp.Problem(
        robot, fp.Scene([[2.0, 0.2, 0.0]], [0.2]), start, goal, mode="attitude-held",
        lattice=fp.Lattice(8, fp.Axis(12, 0.15)), delta=0.5,
    )  # fmt: skip
    return fp.plan(problem, fp.LatticeOptimum())


def test_plans_say_what_the_wheels_store_and_verification_agrees(held_plan):
    found = held_plan.wheel_momentum(duration=60.0)
    assert found.times[-1] == 60.0
    assert found.vectors.shape == found.world.shape == (len(found.times), 3)
    assert found.peak == pytest.approx(np.linalg.norm(found.axis_peaks), rel=1e-9)  # about z alone
    report = held_plan.verify(50)
    assert report.ok, report.problems
    assert report.momentum_residual is None
    assert report.wheel_momentum_error < 1e-9


@pytest.mark.parametrize("change", [lambda v: -v, lambda v: v * (1 + 1e-8)])
def test_verification_notices_a_wrong_wheel_momentum(held_plan, monkeypatch, change):
    right = wheels.momentum_along
    monkeypatch.setattr(wheels, "momentum_along", lambda *given: change(right(*given)))
    report = held_plan.verify(5)
    assert "the wheels must store another momentum" in " ".join(report.problems)


def test_verification_notices_world_axes_passed_off_as_the_bases(monkeypatch):
    robot, rng = random_robot(1), np.random.default_rng(1)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    lattice = fp.Lattice(4, fp.Axis(1, 0.2))
    plan = fp.plan(fp.Problem(robot, fp.Scene(), start, goal, "attitude-held", lattice))
    assert plan.verify(5).ok

    def forged(*given):
        right = wheel_momentum(*given)
        return right._replace(vectors=right.world)

    monkeypatch.setattr(plan_data, "wheel_momentum", forged)
    assert not plan.verify(5).ok


def test_without_wheels_nothing_is_stored_and_the_mode_is_named(fig2a_plan):
    assert fig2a_plan.verify(2).wheel_momentum_error is None
    with pytest.raises(fp.InvalidInput, match="'attitude-held'; other modes have no wheels"):
        fig2a_plan.wheel_momentum(duration=60.0)


@pytest.mark.parametrize(
    ("duration", "times"),
    [(0.0, None), (-1.0, None), (np.inf, None), ("60", None),
     (5.0, [6.0]), (5.0, [-0.1]), (5.0, []), (5.0, 2.0), (5.0, [np.nan])],
)  # fmt: skip
def test_durations_and_times_that_cannot_be_are_refused(held_plan, duration, times):
    with pytest.raises(fp.InvalidInput):
        held_plan.wheel_momentum(duration, times)

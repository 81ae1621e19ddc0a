"""Points of smooth curves: derivatives, momentum, continuity, and what belongs to each mode."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.curves.smooth_curve import SmoothCurve
from tests.helpers.curved_flights import MODES, random_curve
from tests.helpers.urdf_builders import random_robot

STEP = 1e-4


def differences(curve, s):
    """First differences of the base position and of attitudes (body axes), over 2 STEP."""
    before, after = (curve.at(s + d).configurations for d in (-STEP, STEP))
    turned = rotations.multiply(rotations.inverse(before[:, 3:7]), after[:, 3:7])
    return (after[:, :3] - before[:, :3]) / (2 * STEP), rotations.log(turned) / (2 * STEP)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("straight", [False, True])
def test_derivatives_are_those_of_differences(mode, seed, straight):
    curve = SmoothCurve(random_curve(seed, mode, robot=random_robot(seed), straight=straight))
    s = np.linspace(0.05, curve.pieces - 0.05, 83)
    here, before, after = (curve.at(s + d) for d in (0.0, -STEP, STEP))
    size = 1.0 + np.abs(here.rates).max() + np.abs(here.base).max()
    for first in ("rates", "base"):
        found = getattr(here, first)
        change = (getattr(after, first)[:, 0] - getattr(before, first)[:, 0]) / (2 * STEP)
        assert found[:, 1] == pytest.approx(change, abs=1e-3 * size)  # it bends at knots
    joints = (after.joints - before.joints) / (2 * STEP)
    assert here.rates[:, 0] == pytest.approx(joints, abs=1e-6 * size)
    moved, turned = differences(curve, s)
    if mode == "free-floating":
        assert not here.base.any()
    else:
        assert here.base[:, 0] == pytest.approx(moved, abs=1e-6 * size)
    if mode == "attitude-held":
        assert here.turn[:, 0] == pytest.approx(turned, abs=1e-6 * size)
        change = (after.turn[:, 0] - before.turn[:, 0]) / (2 * STEP)
        assert here.turn[:, 1] == pytest.approx(change, abs=1e-3 * size)
    else:
        assert not here.turn.any()


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
@pytest.mark.parametrize("seed", range(8))
def test_momentum_is_conserved_along_a_curve(mode, seed):
    """By Pinocchio's centroidal momentum at the velocities of the curve."""
    robot = random_robot(seed)
    curve = SmoothCurve(random_curve(seed, mode, robot=robot))
    s = np.linspace(0.1, curve.pieces - 0.1, 31)
    points, data = curve.at(s), robot.model.createData()
    moved, turned = differences(curve, s)
    for k, q in enumerate(points.configurations):
        velocity = np.concatenate([moved[k], turned[k], points.rates[k, 0]])
        velocity[:3] = rotations.matrix(q[3:7]).T @ velocity[:3]
        found = pin.computeCentroidalMomentum(robot.model, data, q, velocity)
        size = robot.mass * (1.0 + np.abs(velocity).max())
        assert np.linalg.norm(found.angular) < 1e-6 * size
        if mode == "free-floating":
            assert np.linalg.norm(found.linear) < 1e-6 * size


@pytest.mark.parametrize("mode", MODES)
def test_straight_joints_and_their_attitudes_are_those_of_the_motion(mode):
    curve = random_curve(1, mode, straight=True)
    m = curve.edges
    edge, time = np.repeat(np.arange(m), 9), np.tile(np.linspace(0, 1, 9), m)
    motion = fp.Motion(
        curve.robot, mode, curve.configurations()[0],
        curve.robot.assemble(np.zeros(3), curve.attitudes[-1], curve.joint_values[-1]),
        np.zeros((m + 1, 3)),
    )  # fmt: skip
    if mode != "attitude-held":  # there the base may turn unevenly
        wanted = motion.attitudes_at((edge + time) / m)
        assert rotations.angle_between(curve.attitudes_at(edge, time), wanted).max() < 1e-12
    assert curve.joints_at(edge, time) == pytest.approx(motion.joints_at(edge, time), abs=1e-13)


def test_parameters_outside_the_curve_are_refused():
    curve = SmoothCurve(random_curve(0, "free-flying"))
    for wrong in ([-0.1], [curve.pieces + 0.1], [np.nan], 3.0):
        with pytest.raises(fp.InvalidInput, match="s"):
            curve.at(np.array(wrong))

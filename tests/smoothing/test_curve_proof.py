"""What is proven of a curve holds: on dense samples by other code, and at the limits."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.smoothing.curve_proof import prove_curve
from tests.helpers.curved_flights import MODES
from tests.helpers.dense_curve import flown
from tests.helpers.dense_flight import least_gap

STEPS = 60  # of a piece


class Planned(NamedTuple):
    """As much of a plan as `least_gap` looks at."""

    problem: fp.Problem


def random_flight(seed, mode):
    """A problem whose obstacles lie beside a bent way, and control points on that way."""
    rng, robot = np.random.default_rng(seed), fp.load_robot("planar_dual_arm")
    m = 6
    joints = np.cumsum(0.15 * rng.normal(size=(m + 1, robot.nd)), axis=0) + 0.3
    positions = np.cumsum(rng.uniform([0.1, -0.2, 0.0], [0.4, 0.2, 0.0], (m + 1, 3)), axis=0)
    quats = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, np.sin(0.4), np.cos(0.4)]])
    start, goal = robot.assemble(positions[[0, -1]], quats, joints[[0, -1]])
    centers = rng.uniform([-2.0, -2.5, 0.0], [4.0, 2.5, 0.0], (8, 3))
    scene = fp.Scene(centers, rng.uniform(0.05, 0.3, 8))
    problem = fp.Problem(robot, scene, start, goal, mode)
    motion = fp.Motion(robot, mode, start, goal, positions, joints)
    return problem, motion, control_points_on(motion, np.arange(m + 1.0))


@pytest.mark.parametrize("mode", MODES)
def test_verdicts_and_proven_clearances_are_those_of_dense_samples(mode):
    """Pieces proven free touch nothing anywhere; of those refused, one does in every scene."""
    proven = 0
    for seed in range(30):
        problem, motion, control = random_flight(seed, mode)
        proof = prove_curve(problem, CurvedMotion(motion, control), problem.tolerance)
        path = flown(problem, control, STEPS * motion.edges)
        for k in range(motion.edges):
            gap, touching = least_gap(Planned(problem), path[k * STEPS : (k + 1) * STEPS + 1])
            if k not in proof.refused:
                assert gap > 0.0
                assert not touching
            else:
                assert k in proof.outside or touching or gap < 5e-3
        if not len(proof.refused):
            gap, _ = least_gap(Planned(problem), path)
            least = proof.least_clearance()
            assert least <= gap + 1e-9
            assert least >= 0.9 * gap - 1e-3
            proven += 1
    assert proven >= 4


def test_pieces_that_leave_joint_limits_or_the_window_are_named():
    problem, motion, control = random_flight(0, "free-flying")
    problem = replace(problem, scene=fp.Scene())
    assert not len(prove_curve(problem, CurvedMotion(motion, control), 1e-4).outside)
    high = control.joint_values.copy()
    high[3, 2] = problem.robot.upper[2] + 3.0
    bent = control._replace(joint_values=high)
    outside = prove_curve(problem, CurvedMotion(motion, bent), 1e-4).outside
    assert set(outside) <= {1, 2, 3, 4}
    assert {2, 3} <= set(outside)
    low = np.minimum(control.positions.min(axis=0), problem.goal[:3])
    top = np.maximum(control.positions.max(axis=0), problem.goal[:3])
    tight = replace(problem, window=(low, top))
    assert not len(prove_curve(tight, CurvedMotion(motion, control), 1e-4).outside)
    away = control.positions.copy()
    away[2, 1] += 10.0
    moved = control._replace(positions=away)
    assert {1, 2} <= set(prove_curve(tight, CurvedMotion(motion, moved), 1e-4).outside)


def test_links_that_touch_on_a_curve_are_found():
    """Both arms folded onto each other between two ends at which they are apart."""
    problem, motion, control = random_flight(3, "free-flying")
    problem, robot = replace(problem, scene=fp.Scene()), problem.robot
    joints, rng = control.joint_values.copy(), np.random.default_rng(0)
    while True:
        joints[3] = rng.uniform(robot.lower, robot.upper).clip(-3.0, 3.0)
        joints[2:5] = joints[3]  # the curve passes through it
        q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), joints[3])
        if len(fp.self_collisions(robot, q)):
            break
    curve = CurvedMotion(motion, control._replace(joint_values=joints))
    assert len(prove_curve(problem, curve, 1e-4).refused)

"""Goal attitudes are reached again by curves that cut the corners of the joints' path."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.smoothing.goal_attitude import curve_to_attitude


def bent(robot, seed, still=()):
    rng = np.random.default_rng(seed)
    joints = np.cumsum(0.2 * rng.normal(size=(9, robot.nd)), axis=0).clip(-1.5, 1.5)
    joints[:, list(still)] = 0.0
    positions = np.zeros((9, 3))
    start, goal = robot.assemble(positions[[0, -1]], np.eye(4)[[3, 3]], joints[[0, -1]])
    motion = fp.Motion(robot, "free-flying", start, goal, positions, joints)
    return motion, control_points_on(motion, np.arange(9.0))


@pytest.mark.parametrize("seed", range(8))
def test_the_attitude_of_the_path_is_met_by_joints_that_hardly_differ(robot, seed):
    motion, control = bent(robot, seed, still=(2,))
    goal = motion.attitudes[-1]
    missed = rotations.angle_between(CurvedMotion(motion, control).attitudes[-1], goal)
    found = curve_to_attitude(motion, control, goal)
    assert rotations.angle_between(found.attitudes[-1], goal) < 1e-8
    moved = np.abs(found.control.joint_values - control.joint_values)
    assert 1e-6 < moved.max() < 100.0 * missed
    assert not moved[[0, -1]].any()
    assert not moved[:, 2].any()  # a joint at rest stays so
    assert np.all(found.control.joint_values <= robot.upper)


def test_an_attitude_that_small_changes_cannot_reach_is_given_up(robot):
    motion, control = bent(robot, 0, still=(1, 2, 3))
    sideways = rotations.multiply(motion.attitudes[-1], rotations.exp(np.array([0.3, 0.0, 0.0])))
    assert curve_to_attitude(motion, control, sideways) is None


def test_control_points_at_a_limit_end_the_search_for_others(robot):
    """Those beyond it, as of a spline through the nodes, stay where they are."""
    motion, control = bent(robot, 1)
    beyond = control.joint_values.copy()
    beyond[4] = robot.upper + 0.1
    goal = motion.attitudes[-1]
    found = curve_to_attitude(motion, control._replace(joint_values=beyond), goal)
    assert found is None or np.all(found.control.joint_values[4] <= beyond[4])

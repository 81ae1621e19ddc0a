"""Straight runs: positions along them, and rates on tiny edges."""

import numpy as np

import ffsr_plan as fp
from ffsr_plan.trajectory.straight_runs import straight_runs


def motion_through(joints):
    robot = fp.load_robot("planar_dual_arm")
    values = np.zeros((len(joints), robot.nd))
    values[:, 0] = joints
    start, goal = (robot.configuration(joints={"left_1": q}) for q in (joints[0], joints[-1]))
    return fp.Motion(robot, "free-flying", start, goal, np.zeros((len(joints), 3)), values)


def test_rates_on_tiny_edges_have_no_rounding_error_of_the_sum():
    """Far along the path x is large, so that differences of it are coarse."""
    way = np.resize([0.0, 1.5], 81)
    motion = motion_through([*way, way[-1] + 3e-12, 0.5])
    runs = straight_runs(motion)
    steps = np.abs(np.diff(motion.joint_values[:, 0]))
    tiny = int(np.argmin(np.where(steps > 0.0, steps, np.inf)))
    run = int(np.flatnonzero(runs.first == tiny)[0])
    edge, _, scale = runs.locate(np.array([run]), runs.corners[[tiny]])
    assert edge[0] == tiny
    assert abs(scale[0] / steps[tiny] - 1.0) < 1e-12
    assert abs((runs.corners[tiny + 1] - runs.corners[tiny]) / steps[tiny] - 1.0) > 1e-6

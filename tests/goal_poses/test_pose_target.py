"""The pose error at the end of a joint path, and its Jacobian."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.goal_poses.pose_error import (
    end_configuration,
    end_of_path,
    pose_error,
    pose_jacobian,
)
from ffsr_plan.goal_poses.pose_target import pose_target
from tests.helpers.frame_poses import angles_of, some_goal

seeds = st.integers(0, 100_000)


@pytest.mark.parametrize("mode", list(Mode))
@given(seed=seeds)
@settings(max_examples=12)
def test_the_jacobian_is_that_of_finite_differences(mode, seed):
    robot, start, frame, (position, rotation), base = some_goal(seed, mode)
    rng = np.random.default_rng(seed)
    aside, turned = position + rng.normal(size=3), angles_of(rotation) + rng.uniform(-0.5, 0.5, 3)
    base["mode"] = Mode.parse("mode", mode)
    target = pose_target(robot, frame, aside, turned, start=start, **base)
    begin, change = robot.joint_values(start), rng.uniform(-1, 1, robot.nd)
    change = np.clip(begin + change, robot.lower + 1e-3, robot.upper - 1e-3) - begin
    steps = 1e-5 * np.eye(robot.nd)

    def error(joint_values):
        return pose_error(target, end_configuration(target, joint_values))

    differences = [
        (error(begin + change + step) - error(begin + change - step)) / 2e-5 for step in steps
    ]
    jacobian = pose_jacobian(target, begin, change, end_of_path(target, begin, change))
    assert jacobian == pytest.approx(np.array(differences).T, abs=2e-5)

"""Poses and velocities relative to the base, against Pinocchio."""

import numpy as np
import pinocchio as pin
from hypothesis import given
from hypothesis import strategies as st

from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.robots.kinematics import Tree
from tests.helpers.random_robots import random_tree
from tests.helpers.urdf_builders import random_robot

COUNT = 3


@given(st.integers(0, 100_000), st.sampled_from([random_tree, random_robot]))
def test_poses_and_velocities_are_pinocchios(seed, make):
    rng, robot = np.random.default_rng(seed), make(seed)
    values, rates = rng.uniform(-3, 3, (COUNT, robot.nd)), rng.normal(size=(COUNT, robot.nd))
    tree = Tree(robot.model)
    poses = tree.poses(values)
    velocities = tree.velocities(poses, rates)
    data = robot.model.createData()
    for k in range(COUNT):
        q = robot.assemble(np.zeros(3), IDENTITY, values[k])
        pin.forwardKinematics(robot.model, data, q, np.concatenate([np.zeros(6), rates[k]]))
        for n, (pose, twist) in enumerate(zip(list(data.oMi)[1:], list(data.v)[1:], strict=True)):
            turn = pose.rotation
            assert np.allclose(poses.rotations[k, n], turn, rtol=0, atol=1e-12)
            assert np.allclose(poses.origins[k, n], pose.translation, rtol=0, atol=1e-12)
            assert np.allclose(velocities.angular[k, n], turn @ twist.angular, rtol=0, atol=1e-12)
            assert np.allclose(velocities.linear[k, n], turn @ twist.linear, rtol=0, atol=1e-12)


def test_a_robot_without_joints_is_its_base(point):
    poses = Tree(point.model).poses(np.zeros((COUNT, 0)))
    assert np.array_equal(poses.rotations, np.tile(np.eye(3), (COUNT, 1, 1, 1)))
    assert np.array_equal(poses.origins, np.zeros((COUNT, 1, 3)))

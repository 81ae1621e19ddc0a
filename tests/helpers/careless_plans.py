"""Plans of random robots in empty scenes that ignore their own links."""

import numpy as np

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.urdf_builders import random_robot

MODES = ("free-flying", "attitude-held", "free-floating")


def careless_plan(seed, mode, step=0.5, divisions=2):
    """A plan of a random robot in an empty scene that ignores its own links."""
    rng, robot = np.random.default_rng(seed), random_robot(seed)
    robot.collision_model.removeAllCollisionPairs()
    begin = rng.uniform(-1.0, 1.0, robot.nd)
    change = np.clip(step * rng.normal(size=robot.nd), -1.9, 1.9)
    places = np.zeros(3), np.zeros(3) if mode == "free-floating" else rng.normal(size=3)
    turned = rotations.from_angles(rng.uniform(-0.5, 0.5, 3))
    ends = [
        robot.assemble(place, turn, values)
        for place, turn, values in zip(
            places, (rotations.IDENTITY, turned), (begin, begin + change), strict=True
        )
    ]
    problem = fp.Problem(robot, fp.Scene(), *ends, mode, fp.Lattice(divisions))
    return fp.plan(problem, fp.LatticeOptimum(), refine=False), rng


def placed(plan, s):
    """Shapes of a robot with their poses (N, 4, 4) at path parameters (N,)."""
    robot, q = plan.problem.robot, plan.at(s)
    bodies = Bodies(robot.urdf)
    joints = dict(zip(robot.joint_names, robot.joint_values(q).T, strict=True))
    poses = bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)
    return [(shape, poses[shape.link] @ shape.placement) for shape in bodies.shapes]

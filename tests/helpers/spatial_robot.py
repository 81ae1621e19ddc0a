"""A robot whose arms can rotate its base about every axis, and its posture axes.

By the area law a small loop of the joints in the plane of two posture axes rotates the base by the
area of the loop times the curvature of the connection there. The posture `REST` is chosen such that
the curvatures of the three pairs of axes are linearly independent (`curvatures`).
"""

import math
from functools import cache
from itertools import combinations

import numpy as np

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.momentum import connections
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, capsule, inertial, joint, link, sphere, urdf

BUS, LIMB, REACH = 0.5, 0.6, 0.45  # edge of the bus, length of a limb, shoulder from the middle [m]
BUS_MASS, LIMB_MASS = 20.0, 4.0  # kg
REST = {
    "left_1": 1.2,
    "left_2": 0.2,
    "left_3": -1.4,
    "right_1": 1.2,
    "right_2": -0.2,
    "right_3": 1.4,
}
AXES = ({"left_1": 1, "right_1": -1}, {"left_2": 1, "right_2": 1}, {"left_3": 1, "right_3": 1})


@cache
def spatial_robot():
    """A cubic bus with two arms: shoulder about z and y, elbow about y."""
    cube = BUS_MASS * BUS**2 / 6.0
    rod = LIMB_MASS * LIMB**2 / 12.0
    limb = (
        inertial(LIMB_MASS, (0.01, rod, rod), (LIMB / 2, 0.0, 0.0)),
        capsule(0.04, LIMB - 0.08, (LIMB / 2, 0.0, 0.0), (0.0, np.pi / 2, 0.0)),
    )
    parts = [link("base", inertial(BUS_MASS, (cube,) * 3), box((BUS,) * 3))]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        names = [f"{side}_yoke", f"{side}_upper", f"{side}_fore"]
        parts += [link(names[0], inertial(0.5, (0.001,) * 3), sphere(0.05))]
        parts += [link(name, *limb) for name in names[1:]]
        places = (0.0, sign * REACH, 0.0), (0.0, 0.0, 0.0), (LIMB, 0.0, 0.0)
        aims = (0.0, 0.0, sign * np.pi / 2), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        axes = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0)
        for k in range(3):
            parent = "base" if k == 0 else names[k - 1]
            parts.append(
                joint(f"{side}_{k + 1}", "revolute", parent, names[k], places[k], aims[k], axes[k])
            )
    return robot_from_urdf(urdf(*parts), "spatial")


def spatial_problem(degrees, axis, divisions=60, levels=4, spacing=0.3):
    """Rotation about an axis (3,) in the base's axes, joints from `REST` to `REST`."""
    robot = spatial_robot()
    attitude = rotations.exp(math.radians(degrees) * np.array(axis) / np.linalg.norm(axis))
    goal = robot.configuration((0, 0, 0), tuple(rotations.to_angles(attitude)), REST)
    postures = [fp.PostureAxis(along, levels, spacing) for along in AXES]
    return fp.Problem(
        robot,
        fp.Scene(),
        robot.configuration(joints=REST),
        goal,
        lattice=fp.Lattice(divisions, postures=postures),
        reach_attitude=True,
    )


def curvatures(robot, joint_values, directions):
    """(3 pairs, 3) rotation of the base for each unit of area of a small loop [rad].

    In the base's axes: dA(u, v) + A u x A v for the pairs of directions (3, nd), as the base turns
    by R' = R [A theta'].
    """
    h = 1e-5

    def change(u, v):  # of A v along u
        ends = connections(robot, joint_values + h * np.array([[1.0], [-1.0]]) * u)
        return (ends[0] - ends[1]) @ v / (2.0 * h)

    connection = connections(robot, joint_values[None])[0]
    return np.array(
        [
            change(u, v) - change(v, u) + np.cross(connection @ u, connection @ v)
            for u, v in combinations(directions, 2)
        ]
    )

"""Plans flown by a small integrator and sampled densely, by neither the planner nor `verify`.

Attitudes follow from Pinocchio's centroidal map by Runge-Kutta steps, distances to spheres from the
URDF's text (`urdf_distances`), contacts of links from Coal's collision test.
"""

import numpy as np
import pinocchio as pin

from tests.helpers.urdf_distances import least_distance


def turned(quat, vector):
    x, y, z, w = quat
    twice = 2.0 * np.cross([x, y, z], vector)
    return vector + w * twice + np.cross([x, y, z], twice)


def rate(robot, data, joints, steps):
    """(3,) angular velocity of the base in its axes at zero angular momentum."""
    q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), joints)
    angular = pin.computeCentroidalMap(robot.model, data, q)[3:]
    return -np.linalg.solve(angular[:, 3:6], angular[:, 6:] @ steps)


def slope(quat, omega):
    x, y, z, w = quat
    a, b, c = omega
    return 0.5 * np.array(
        [
            w * a + y * c - z * b,
            w * b + z * a - x * c,
            w * c + x * b - y * a,
            -x * a - y * b - z * c,
        ]
    )


def center(robot, data, joints):
    """(3,) centre of mass relative to the base, in its axes."""
    q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), joints)
    return np.array(pin.centerOfMass(robot.model, data, q))


def flown(plan, samples=24):
    """Configurations (N, nq) all along a plan, from its corners alone; at least so many an edge."""
    problem, robot = plan.problem, plan.problem.robot
    data, quat = robot.model.createData(), np.array(problem.start[3:7])
    joints, places = plan.motion.joint_values, plan.motion.positions
    anchor = problem.start[:3] + turned(quat, center(robot, data, joints[0]))
    found = []
    for k in range(len(joints) - 1):
        steps = joints[k + 1] - joints[k]
        count = max(samples, int(np.ceil(np.abs(steps).max() / 0.02)))
        for i in range(count):
            t, h = i / count, 1.0 / count
            here = joints[k] + t * steps
            place = places[k] + t * (places[k + 1] - places[k])
            if problem.mode == "free-floating":
                place = anchor - turned(quat, center(robot, data, here))
            found.append(robot.assemble(place, quat, here))
            omegas = [rate(robot, data, here + s * h * steps, steps) for s in (0.0, 0.5, 1.0)]
            a = slope(quat, omegas[0])
            b = slope(quat + 0.5 * h * a, omegas[1])
            c = slope(quat + 0.5 * h * b, omegas[1])
            d = slope(quat + h * c, omegas[2])
            quat = quat + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            quat /= np.linalg.norm(quat)
    found.append(plan.configurations[-1])
    return np.array(found), quat


def least_gap(plan, configurations):
    """Least distance to an obstacle [m], and whether any links touch."""
    problem, robot = plan.problem, plan.problem.robot
    geometry, data = robot.collision_model, robot.model.createData()
    shapes = geometry.createData()
    least, touching = np.inf, False
    for q in configurations:
        values = dict(zip(robot.joint_names, robot.joint_values(q), strict=True))
        gap = least_distance(
            robot.urdf, q[:3], q[3:7], values, problem.scene.centers, problem.scene.radii
        )
        least = min(least, gap)
        touching |= pin.computeCollisions(robot.model, data, geometry, shapes, q, True)
    return least, touching

"""Random robots on random curves, and the travel of their points, sampled along them.

The positions of points come from `Tree`, which is tested against Pinocchio, and polylines are never
longer than the paths themselves.
"""

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.travel_bound import TravelBound
from ffsr_plan.robots.kinematics import turned
from tests.helpers.random_robots import random_tree

MODES = ("free-flying", "attitude-held", "free-floating")
SAMPLES = 24
ROUNDING = 1e-12


def random_curve(seed, mode, edges=6, robot=None, straight=False):
    """A random tree, or a robot, on a curve whose joints bend a little or a lot."""
    rng = np.random.default_rng(seed)
    robot = random_tree(seed) if robot is None else robot
    size = 10.0 ** rng.uniform(-2.0, 0.3)
    joints = rng.uniform(-1.5, 1.5, robot.nd) + size * rng.normal(size=(edges + 1, robot.nd))
    positions = np.cumsum(rng.normal(size=(edges + 1, 3)) * 10.0 ** rng.uniform(-2, 0), axis=0)
    turn = rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.0)
    quats = rotations.exp(np.stack([rng.normal(size=3)] * 2))
    quats[1] = rotations.multiply(quats[0], rotations.exp(turn))
    start, goal = robot.assemble(positions[[0, -1]], quats, joints[[0, -1]])
    shares = None
    if mode == "attitude-held" and rng.random() < 0.5:
        shares = np.append(np.append(0.0, np.sort(rng.random(edges - 1))), 1.0)
    motion = Motion(robot, mode, start, goal, positions, None if straight else joints, shares)
    return CurvedMotion(motion, control_points_on(motion, np.arange(edges + 1.0)))


def places(curve, begin, end, in_base=False):
    """(m, SAMPLES + 1, P, 3) points whose hulls hold the shapes, over one part of every piece."""
    points, m = TravelBound(curve.robot).points, curve.edges
    edge = np.repeat(np.arange(m), SAMPLES + 1)
    time = np.tile(np.linspace(begin, end, SAMPLES + 1), m)
    poses = curve.robot.tree.poses(curve.joints_at(edge, time))
    links = points["link"]
    found = poses.origins[:, links] + turned(poses.rotations[:, links], points["place"])
    if not in_base:
        q = curve.at(edge, time)
        found = found @ np.swapaxes(rotations.matrix(q[:, 3:7]), -1, -2) + q[:, None, :3]
    return found.reshape(m, SAMPLES + 1, -1, 3)


def shares_of_the_bound(curve, begin, end, in_base=False):
    """(m, g) longest sampled path of a shape's points over its bound, for a part of every piece."""
    way = np.linalg.norm(np.diff(places(curve, begin, end, in_base), axis=1), axis=-1).sum(axis=1)
    travel = EdgeTravel(curve).over(begin, end, in_base)[0]
    bounds = travel.bounds(np.arange(curve.edges), np.zeros((curve.edges, 3)))
    return np.maximum.reduceat(way, travel.first, axis=-1) / (bounds + ROUNDING)

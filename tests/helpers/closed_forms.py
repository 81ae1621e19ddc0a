"""Distances in closed form, independent of Coal: by scalar loops, and for arrays."""

import math

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.solid_distances import sphere_distance


def shape_distance(shape, pose, center, radius):
    """Signed distance of a Coal sphere, capsule or box at `pose` (SE3) to a sphere."""
    local = pose.rotation.T @ (np.asarray(center) - pose.translation)
    if isinstance(shape, coal.Sphere):
        return math.dist(local, (0, 0, 0)) - shape.radius - radius
    if isinstance(shape, coal.Capsule):
        level = min(max(local[2], -shape.halfLength), shape.halfLength)
        return math.dist(local, (0, 0, level)) - shape.radius - radius
    outside = [max(abs(x) - h, 0.0) for x, h in zip(local, shape.halfSide, strict=True)]
    inside = max(abs(x) - h for x, h in zip(local, shape.halfSide, strict=True))
    return math.hypot(*outside) + min(inside, 0.0) - radius


def clearance(robot, scene, q):
    """Least signed distance over all links and spheres."""
    data, geometry = robot.model.createData(), robot.collision_model.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.collision_model, geometry, q)
    return min(
        shape_distance(g.geometry, pose, center, radius)
        for g, pose in zip(robot.collision_model.geometryObjects, geometry.oMg, strict=True)
        for center, radius in zip(scene.centers, scene.radii, strict=True)
    )


def clearances(robot, scene, q):
    """(N,) clearances of (N, nq) configurations, with the URDF reader of the verification."""
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    values = robot.joint_values(q)
    joints = {name: values[:, k] for k, name in enumerate(robot.joint_names)}
    poses = bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)
    each = [
        sphere_distance(s, poses[s.link] @ s.placement, scene.centers, scene.radii)
        for s in bodies.shapes
    ]
    return np.min(each, axis=(0, 2))

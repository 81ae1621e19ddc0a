"""Distances of a robot's boxes, spheres and capsules to spheres, from the URDF text alone.

Written apart from the package: poses by 4 x 4 matrices, distances by the textbook. Shapes of other
kinds are left out. All poses of a robot are taken at once: N rotations are (N, 3, 3).
"""

from xml.etree import ElementTree

import numpy as np


def numbers(element, name, default):
    return np.array((element.get(name) or default).split(), dtype=float)


def rotation(roll, pitch, yaw):
    (a, b, c), (x, y, z) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, a, -x], [0, x, a]])
    about_y = np.array([[b, 0, y], [0, 1, 0], [-y, 0, b]])
    about_z = np.array([[c, -z, 0], [z, c, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def frame(rotated, moved):
    """(..., 4, 4) of rotations (..., 3, 3) and translations (..., 3)."""
    shape = np.broadcast_shapes(np.shape(rotated)[:-2], np.shape(moved)[:-1])
    result = np.zeros((*shape, 4, 4))
    result[..., :3, :3], result[..., :3, 3], result[..., 3, 3] = rotated, moved, 1.0
    return result


def origin(element):
    found = element.find("origin")
    if found is None:
        return np.eye(4)
    return frame(rotation(*numbers(found, "rpy", "0 0 0")), numbers(found, "xyz", "0 0 0"))


def of_joint(joint, values):
    """(N, 4, 4) displacement by values (N,) [rad or m]."""
    found = joint.find("axis")
    axis = np.array([1.0, 0, 0]) if found is None else numbers(found, "xyz", "1 0 0")
    axis = axis / np.linalg.norm(axis)
    if joint.get("type") == "prismatic":
        return frame(np.eye(3), values[:, None] * axis)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(values)[:, None, None], np.cos(values)[:, None, None]
    return frame(np.eye(3) + sine * cross + (1 - cosine) * cross @ cross, np.zeros(3))


def link_frames(root, base, values):
    """Frames (N, 4, 4) of all links by name, of bases (N, 4, 4) and values (N,) by joint."""
    joints = root.findall("joint")
    children = {joint.find("child").get("link") for joint in joints}
    (top,) = {link.get("name") for link in root.findall("link")} - children
    frames = {top: base}
    while len(frames) < len(root.findall("link")):
        for joint in joints:
            parent, child = (joint.find(end).get("link") for end in ("parent", "child"))
            if parent in frames and child not in frames:
                moved = of_joint(joint, values.get(joint.get("name"), np.zeros(1)))
                frames[child] = frames[parent] @ origin(joint) @ moved
    return frames


def to_shape(geometry, points):
    """Signed distances (...) of points (..., 3) in the shape's frame; inf for other shapes."""
    shape = geometry[0]
    if shape.tag == "sphere":
        return np.linalg.norm(points, axis=-1) - float(shape.get("radius"))
    if shape.tag == "capsule":
        half = 0.5 * float(shape.get("length"))
        beyond = points[..., 2] - np.clip(points[..., 2], -half, half)
        aside = np.hypot(points[..., 0], points[..., 1])
        return np.hypot(aside, beyond) - float(shape.get("radius"))
    if shape.tag == "box":
        beyond = np.abs(points) - 0.5 * numbers(shape, "size", "")
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return outside + np.minimum(beyond.max(axis=-1), 0.0)
    return np.full(points.shape[:-1], np.inf)


def rotations_of(quats_xyzw):
    """(N, 3, 3) of unit quaternions (N, 4)."""
    x, y, z, w = quats_xyzw.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def least_distances(urdf, positions, quats_xyzw, values, centers, radii):
    """Least distances (N,) [m] of the robot at N poses to spheres (K, 3), (K,).

    `values` are (N,) for each joint by name [rad or m].
    """
    root, least = ElementTree.fromstring(urdf), np.full(len(positions), np.inf)
    frames = link_frames(root, frame(rotations_of(quats_xyzw), positions), values)
    for link in root.findall("link"):
        for collision in link.findall("collision"):
            placed = frames[link.get("name")] @ origin(collision)
            local = (centers - placed[:, None, :3, 3]) @ placed[:, :3, :3]
            distances = to_shape(collision.find("geometry"), local) - radii
            np.minimum(least, np.min(distances, axis=1, initial=np.inf), out=least)
    return least

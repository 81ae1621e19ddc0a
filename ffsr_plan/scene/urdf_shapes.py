"""The collision shapes of a URDF as obstacles at rest: another robot, or a target satellite."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.collision_shapes import origin
from ffsr_plan.robots.loading import load_robot
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Capsule, Cylinder, Hull, ObstacleShape


def robot_of(source: str | Path | SpaceRobot, options: Mapping[str, Any]) -> SpaceRobot:
    """The robot, loaded unless it is one.

    Args:
        source: name of a bundled robot, path of a URDF, or a robot.
        options: of `load_robot`.

    Raises:
        InvalidInput: what `load_robot` refuses, or options beside a robot, which is loaded already.
    """
    if not isinstance(source, SpaceRobot):
        return load_robot(source, **options)
    if options:
        allowed = "no options of load_robot, as the robot is loaded already"
        raise InvalidInput(", ".join(options), list(options.values()), allowed)
    return source


def shapes_of(robot: SpaceRobot, q: Array, name: str) -> Iterator[ObstacleShape]:
    """The collision shapes of a robot at one configuration; cylinders are cylinders.

    Args:
        robot: the robot.
        q: (nq,) its configuration.
        name: that the names of the shapes begin with.
    """
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    links = {link.get("name"): link for link in ElementTree.fromstring(robot.urdf).iter("link")}
    for shape in robot.collision_model.geometryObjects:
        link, number = robot.link_of(shape), int(shape.name.rpartition("_")[2])
        title = f"{name}, {link}" if name else link
        element = links[link].findall("collision")[number]
        cylinder = element.find("geometry/cylinder")
        if cylinder is None:
            yield _placed(shape.geometry, data.oMi[shape.parentJoint] * shape.placement, title)
            continue
        pose = data.oMf[shape.parentFrame] * origin(element)
        size = float(cylinder.get("radius", "")), float(cylinder.get("length", ""))
        yield Cylinder(*size, pose.translation, _quaternion(pose), title)


def _placed(solid: coal.CollisionGeometry, pose: pin.SE3, name: str) -> ObstacleShape:
    """A Coal solid as an obstacle."""
    place, turn = pose.translation, _quaternion(pose)
    if isinstance(solid, coal.Box):
        return Box(2.0 * solid.halfSide, place, turn, name)
    if isinstance(solid, coal.Sphere):
        return Ball(solid.radius, place, name)
    if isinstance(solid, coal.Capsule):
        return Capsule(solid.radius, 2.0 * solid.halfLength, place, turn, name)
    points = np.array([solid.point(k) for k in range(solid.num_points)])
    return Hull(points, place, turn, name)


def _quaternion(pose: pin.SE3) -> Array:
    quat = pin.Quaternion(pose.rotation).normalized().coeffs()
    return np.asarray(quat if quat[3] >= 0.0 else -quat)

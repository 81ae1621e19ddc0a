"""Robots, obstacles and trajectories as MuJoCo models (MJCF): keyframes and controls over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_text
from ffsr_plan.formats.values.data_files import extra
from ffsr_plan.formats.values.plain_obstacles import obstacles_of
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    Hull,
    ObstacleShape,
)
from ffsr_plan.trajectory.trajectory import Trajectory

_OBSTACLE, _LINK = "0.93 0.35 0.28 1", "0.8 0.8 0.84 1"
_SERVO_RATE = 50.0  # [1/s] of the critically damped servos, far below 1 / _TIME_STEP
_TIME_STEP = 0.002  # [s]
_ROOM = 2.0  # [m] around the way of the base that the viewer shows
_PREFIX = "obstacle_"


def write_mjcf(
    path: str | Path, robot: SpaceRobot, scene: Scene, trajectory: Trajectory | None = None
) -> None:
    """Write one self-contained MJCF file: robot, obstacles, and a keyframe for each time.

    The base has a free joint, there is no gravity, and each joint has a position servo, whose
    control in a keyframe is the joint's value. Links have their collision shapes, which touch
    nothing: contacts are for `certify`. Masses, inertias and joints are those of the URDF.

    Args:
        path: the file, replaced if it exists; it ends in `.xml`.
        robot: the robot.
        scene: obstacles at rest; bodies that move, zones and growth are not in the format.
        trajectory: with base positions and attitudes, such as `TrajectoryReport.with_base` gives;
            None for none.

    Raises:
        InvalidInput: another kind of argument, joints that robot or trajectory lack, a trajectory
            without base, or a file that cannot be written.
    """
    target = checked_path("path", path, ".xml")
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    root = ElementTree.Element("mujoco", model=robot.name)
    settings = {"angle": "radian", "autolimits": "false", "balanceinertia": "false"}
    ElementTree.SubElement(root, "compiler", settings)
    options = {"gravity": "0 0 0", "integrator": "implicitfast", "timestep": repr(_TIME_STEP)}
    ElementTree.SubElement(root, "option", options)
    visual = ElementTree.SubElement(root, "visual")
    ElementTree.SubElement(visual, "headlight", ambient="0.4 0.4 0.4")
    view = ElementTree.SubElement(root, "statistic")
    assets = ElementTree.SubElement(root, "asset")
    world = ElementTree.SubElement(root, "worldbody")
    for k, shape in enumerate(obstacles_of(scene)):
        _obstacle(world, assets, shape, f"{_PREFIX}{k}")
    base = _bodies(world, assets, robot)
    servos = ElementTree.SubElement(root, "actuator")
    for name, inertia in zip(robot.joint_names, _felt_inertias(robot).tolist(), strict=True):
        gains = {"kp": repr(_SERVO_RATE**2 * inertia), "kv": repr(2.0 * _SERVO_RATE * inertia)}
        ElementTree.SubElement(servos, "position", {"name": name, "joint": name, **gains})
    if trajectory is not None:
        _keyframes(root, robot, trajectory)
        _show_start(base, view, trajectory)
    ElementTree.indent(root)
    write_text("path", target, ElementTree.tostring(root, encoding="unicode") + "\n")


def read_mjcf(path: str | Path, interpolation: str | None = None) -> Trajectory:
    """Read the keyframes of an MJCF file as a trajectory.

    Hinges and slides are its joints; a free joint is the base, if there is one. Other kinds of
    joints are refused. Velocities are taken where any is not zero.

    Args:
        path: the file; it ends in `.xml`.
        interpolation: `linear` or `cubic`; by default cubic where there are velocities.

    Raises:
        InvalidInput: a file that MuJoCo cannot read, or with fewer than two keyframes.
    """
    mujoco, model, what = _loaded(path)
    if model.nkey < 2:
        raise InvalidInput(f"{what}, keyframes", int(model.nkey), "at least two")
    kinds = mujoco.mjtJoint
    joints, rates, base = dict[str, Array](), dict[str, Array](), dict[str, Array]()
    for k in range(model.njnt):
        name = model.joint(k).name or f"joint_{k}"
        at, dof = int(model.jnt_qposadr[k]), int(model.jnt_dofadr[k])
        kind = int(model.jnt_type[k])
        if kind in (int(kinds.mjJNT_HINGE), int(kinds.mjJNT_SLIDE)):
            joints[name], rates[name] = model.key_qpos[:, at], model.key_qvel[:, dof]
        elif kind == int(kinds.mjJNT_FREE) and not base:
            quats = model.key_qpos[:, [at + 4, at + 5, at + 6, at + 3]]
            base = {"base_positions": model.key_qpos[:, at : at + 3], "base_attitudes": quats}
            if np.any(model.key_qvel[:, dof : dof + 3]):
                base["base_velocities"] = model.key_qvel[:, dof : dof + 3]
        else:
            raise InvalidInput(
                f"{what}, joint '{name}'", "its kind", "one free joint, hinges, slides"
            )
    moving = any(np.any(each) for each in rates.values())
    return Trajectory(
        model.key_time,
        joints,
        velocities=rates if moving else None,
        **base,
        interpolation=interpolation or ("cubic" if moving else "linear"),
        source=what,
    )


def read_mjcf_scene(path: str | Path) -> Scene:
    """Read the geoms of an MJCF file that are fixed to the world as obstacles.

    Meshes become their convex hulls, as in MuJoCo; planes and height fields are refused.

    Args:
        path: the file; it ends in `.xml`.

    Raises:
        InvalidInput: a file that MuJoCo cannot read, or a geom of another kind.
    """
    mujoco, model, what = _loaded(path)
    shapes = list[ObstacleShape]()
    for k in range(model.ngeom):
        if model.body_weldid[model.geom_bodyid[k]] == 0:
            shapes.append(_shape_of(mujoco, model, k, what))
    return Scene(shapes=shapes)


def _loaded(path: str | Path) -> tuple[Any, Any, str]:
    """MuJoCo, the model of a file, and its name in errors."""
    target, what = checked_path("model", path, ".xml"), f"model '{path}'"
    mujoco = extra("mujoco")
    try:
        return mujoco, mujoco.MjModel.from_xml_path(str(target)), what
    except ValueError as error:
        raise InvalidInput(what, str(error), "an MJCF file that MuJoCo reads") from None


def _shape_of(mujoco: Any, model: Any, number: int, what: str) -> ObstacleShape:  # noqa: ANN401
    """A geom as an obstacle."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    size, kind, kinds = model.geom_size[number], int(model.geom_type[number]), mujoco.mjtGeom
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, data.geom_xmat[number])
    name = str(model.geom(number).name)
    place, turn = data.geom_xpos[number].copy(), quat[[1, 2, 3, 0]]
    if kind == int(kinds.mjGEOM_BOX):
        return Box(2.0 * size, place, turn, name)
    if kind == int(kinds.mjGEOM_SPHERE):
        return Ball(float(size[0]), place, name)
    if kind == int(kinds.mjGEOM_CAPSULE):
        return Capsule(float(size[0]), 2.0 * float(size[1]), place, turn, name)
    if kind == int(kinds.mjGEOM_CYLINDER):
        return Cylinder(float(size[0]), 2.0 * float(size[1]), place, turn, name)
    if kind == int(kinds.mjGEOM_ELLIPSOID):
        return Ellipsoid(size, place, turn, name)
    if kind == int(kinds.mjGEOM_MESH):
        mesh = model.geom_dataid[number]
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        corners = model.mesh_vert[first : first + count].astype(np.float64)
        return Hull(corners, place, turn, name)
    raise InvalidInput(f"{what}, geom '{name}'", kind, "boxes, spheres and other convex geoms")


def _obstacle(
    world: ElementTree.Element, assets: ElementTree.Element, shape: ObstacleShape, name: str
) -> None:
    """Add an obstacle to the world."""
    kind, size = _kind(shape)
    attributes = {"name": name, "type": kind, "rgba": _OBSTACLE, **_pose(shape)}
    if isinstance(shape, Hull):
        attributes["mesh"] = name
        _mesh(assets, name, shape.points)
    else:
        attributes["size"] = _row(size)
    _untouchable(ElementTree.SubElement(world, "geom", attributes))


def _kind(shape: ObstacleShape) -> tuple[str, Array]:
    """MuJoCo's word for a shape, and its half sizes."""
    if isinstance(shape, Box):
        return "box", 0.5 * shape.size
    if isinstance(shape, Ball):
        return "sphere", np.array([shape.radius])
    if isinstance(shape, (Capsule, Cylinder)):
        return shape.word, np.array([shape.radius, 0.5 * shape.length])
    if isinstance(shape, Ellipsoid):
        return "ellipsoid", shape.semi_axes
    return "mesh", np.zeros(0)


def _bodies(
    world: ElementTree.Element, assets: ElementTree.Element, robot: SpaceRobot
) -> ElementTree.Element:
    """Add the tree of the robot's bodies, one for each joint, the base on a free joint.

    Returns:
        The base.
    """
    model = robot.model
    elements: dict[int, ElementTree.Element] = {0: world}
    for j in range(1, model.njoints):
        parent, place = elements[model.parents[j]], model.jointPlacements[j]
        name = robot.name if j == 1 else f"body_{model.names[j]}"
        body = ElementTree.SubElement(parent, "body", {"name": name, **_placement(place)})
        elements[j] = body
        if j == 1:
            ElementTree.SubElement(body, "freejoint", name="base_joint")
        else:
            k = j - 2
            kind = "slide" if robot.prismatic[k] else "hinge"
            joint = {"name": str(model.names[j]), "type": kind, "axis": _row(_axis(robot, j))}
            if np.isfinite(robot.lower[k]):
                limits = np.array([robot.lower[k], robot.upper[k]])
                joint |= {"range": _row(limits), "limited": "true"}
            ElementTree.SubElement(body, "joint", joint)
        _inertial(body, model.inertias[j])
    for number, shape in enumerate(robot.collision_model.geometryObjects):
        _link_shape(elements[shape.parentJoint], assets, shape, f"shape_{number}")
    return elements[1]


def _felt_inertias(robot: SpaceRobot) -> Array:
    """(nd,) inertias that the joints' motors feel while all else is free to move [kg m^2 or kg]."""
    inverse = pin.computeMinverse(robot.model, robot.model.createData(), robot.neutral())
    return np.asarray(1.0 / np.diag(inverse)[6:])


def _axis(robot: SpaceRobot, joint: int) -> Array:
    """(3,) axis of a joint in its own frame."""
    velocity = np.zeros(robot.model.nv)
    velocity[robot.model.joints[joint].idx_v] = 1.0
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.neutral(), velocity)
    parent = data.v[robot.model.parents[joint]]
    own = data.v[joint] - data.liMi[joint].actInv(parent)
    return np.asarray(own.linear if robot.prismatic[joint - 2] else own.angular)


def _inertial(body: ElementTree.Element, inertia: pin.Inertia) -> None:
    rows = inertia.inertia
    moments = np.array([rows[0, 0], rows[1, 1], rows[2, 2], rows[0, 1], rows[0, 2], rows[1, 2]])
    ElementTree.SubElement(
        body, "inertial", pos=_row(inertia.lever), mass=repr(float(inertia.mass)),
        fullinertia=_row(moments),
    )  # fmt: skip


def _link_shape(
    body: ElementTree.Element, assets: ElementTree.Element, shape: pin.GeometryObject, name: str
) -> None:
    """Add a collision shape of a link to its body."""
    solid, kind = shape.geometry, type(shape.geometry).__name__
    attributes = {"name": name, "rgba": _LINK, **_placement(shape.placement)}
    if kind == "Box":
        attributes |= {"type": "box", "size": _row(np.asarray(solid.halfSide))}
    elif kind == "Sphere":
        attributes |= {"type": "sphere", "size": repr(float(solid.radius))}
    elif kind in ("Capsule", "Cylinder"):
        sizes = np.array([solid.radius, solid.halfLength])
        attributes |= {"type": kind.casefold(), "size": _row(sizes)}
    else:
        _mesh(assets, name, np.asarray(solid.points()))
        attributes |= {"type": "mesh", "mesh": name}
    _untouchable(ElementTree.SubElement(body, "geom", attributes))


def _untouchable(geom: ElementTree.Element) -> None:
    geom.set("contype", "0")
    geom.set("conaffinity", "0")
    geom.set("mass", "0")


def _mesh(assets: ElementTree.Element, name: str, points: Array) -> None:
    """Add the hull of points as a mesh whose frame is that of the points."""
    ElementTree.SubElement(assets, "mesh", name=name, vertex=_row(points.ravel()), inertia="shell")


def _keyframes(root: ElementTree.Element, robot: SpaceRobot, trajectory: Trajectory) -> None:
    """Add a keyframe for each time, with the controls that hold it."""
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    places, turns = trajectory.base_positions, trajectory.base_attitudes
    if places is None or turns is None:
        allowed = "one with base positions and attitudes, as `TrajectoryReport.with_base` gives"
        raise InvalidInput("trajectory", trajectory, allowed)
    values = trajectory.joint_array(robot.joint_names)
    qpos = np.hstack([places, turns[:, [3, 0, 1, 2]], values])
    frames = ElementTree.SubElement(root, "keyframe")
    moving = bool(trajectory.velocities)
    rates = trajectory.joint_array(robot.joint_names, True) if moving else np.zeros_like(values)
    pushed = trajectory.base_velocities
    base = np.zeros((len(values), 6))
    if pushed is not None:
        base[:, :3] = pushed
    qvel = np.hstack([base, rates])
    for k, time in enumerate(trajectory.times.tolist()):
        key = {"name": f"t_{k}", "time": repr(time), "qpos": _row(qpos[k]), "ctrl": _row(values[k])}
        if np.any(qvel):
            key["qvel"] = _row(qvel[k])
        ElementTree.SubElement(frames, "key", key)


def _show_start(
    base: ElementTree.Element, view: ElementTree.Element, trajectory: Trajectory
) -> None:
    """Let a model be reset to where the base starts, and be seen with all of the base's way."""
    places, turns = trajectory.base_positions, trajectory.base_attitudes
    if places is not None and turns is not None:
        base.set("pos", _row(places[0]))
        base.set("quat", _row(turns[0, [3, 0, 1, 2]]))
        low, high = places.min(axis=0), places.max(axis=0)
        view.set("center", _row(0.5 * (low + high)))
        view.set("extent", repr(float(np.linalg.norm(high - low)) + _ROOM))


def _pose(shape: ObstacleShape) -> dict[str, str]:
    return {"pos": _row(shape.position), "quat": _row(shape.attitude[[3, 0, 1, 2]])}


def _placement(place: pin.SE3) -> dict[str, str]:
    quat = pin.Quaternion(place.rotation).coeffs()[[3, 0, 1, 2]]
    return {"pos": _row(place.translation), "quat": _row(quat)}


def _row(values: Array) -> str:
    return " ".join(map(repr, np.asarray(values, dtype=np.float64).ravel().tolist()))

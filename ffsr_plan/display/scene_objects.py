"""What a picture shows, whether of a plan or of a colony at work: robot, obstacles, trails."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pinocchio as pin

from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.display.meshcat_objects import instances, ribbon, solids
from ffsr_plan.lattice.layered_lattice import path_frame
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

FEW, NEAR = 60, 0.8  # obstacles that are all drawn solid; beyond that, only those so near [m]
TRACK, TIPS = (1.0, 0.86, 0.25), (0.35, 0.92, 0.85)
_TRIANGLES = 90_000  # of near and of far obstacles; where they are many, they are less round
_START, _GOAL, _OBSTACLE, _FAR = 0x4FB3D9, 0x58C27D, 0xAEB4BF, 0x8FA0BF
_GLOW = np.array([(0.09, 0.06, 0.20), (0.42, 0.12, 0.43), (0.86, 0.32, 0.26), (0.99, 0.72, 0.20)])


def set_up(
    viewer: Any,  # noqa: ANN401 - meshcat has no types
    problem: Problem,
    configurations: Array,
) -> dict[str, float]:
    """Light, background, and the path frame turned so that the travel runs from left to right.

    Args:
        viewer: meshcat's root.
        problem: what is shown.
        configurations: (N, nq) between which the camera is to see all.

    Returns:
        What the page needs to place the camera.
    """
    for name in ("/Grid", "/Axes"):
        viewer[name].set_property("visible", False)
    viewer["/Background"].set_property("top_color", [0.05, 0.07, 0.13])
    viewer["/Background"].set_property("bottom_color", [0.01, 0.015, 0.03])
    viewer["/Lights/AmbientLight/<object>"].set_property("intensity", 0.45)
    viewer["/Lights/FillLight/<object>"].set_property("intensity", 0.5)
    fov = 40.0
    viewer["/Cameras/default/rotated/<object>"].set_property("fov", fov)
    axes = view_axes(problem)
    scene = problem.scene
    shapes = shape_placements(problem.robot, configurations).positions
    points = [np.vstack([configurations[:, :3], shapes.reshape(-1, 3)]) @ axes.T]
    points += [scene.centers @ axes.T + s * scene.radii[:, None] for s in (-1.0, 1.0)]
    cloud = np.vstack(points)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    root = np.eye(4)
    root[:3, :3] = axes
    root[:3, 3] = -0.5 * (low + high)
    viewer.set_transform(root)
    margin = 0.8  # beyond the middles of the links
    width, height = high[0] - low[0] + margin, high[1] - low[1] + margin
    return {"width": width, "height": height, "fov": fov, "elevation": math.radians(62.0)}


def view_axes(problem: Problem) -> Array:
    """(3, 3) rows: directions in the world that appear to the right, to the back and upwards."""
    if np.linalg.norm(problem.base_displacement) < 1e-9:
        return np.eye(3)
    frame = path_frame(problem.base_displacement)
    return np.array([frame[:, 2], frame[:, 0], frame[:, 1]])


def add_obstacles(viewer: Any, scene: Scene, near: Flags) -> None:  # noqa: ANN401 - meshcat
    """Spheres; those not `near` (N,) are faint, so that the motion can be seen among many."""
    import meshcat.geometry as mg

    solid = mg.MeshPhongMaterial(color=_OBSTACLE, shininess=60)
    faint = mg.MeshPhongMaterial(color=_FAR, opacity=0.13, depthWrite=False, shininess=10)
    for name, chosen, material in (("near", near, solid), ("far", ~near, faint)):
        if chosen.any():
            share = math.sqrt(_TRIANGLES / np.count_nonzero(chosen) / 3.0)
            rings = int(np.clip(share, 6, 28))
            spheres = instances(scene.centers[chosen], scene.radii[chosen], rings, material)
            viewer[name].set_object(spheres)


def add_ends(viewer: Any, robot: SpaceRobot, start: Array, goal: Array) -> None:  # noqa: ANN401
    """The robot at the start (nq,), and ghosts of it at start and goal (nq,)."""
    add_robot(viewer["robot"], robot, start)
    for name, colour, q in (("start", _START, start), ("goal", _GOAL, goal)):
        add_robot(viewer["ghosts"][name], robot, q, colour)


def add_robot(
    viewer: Any,  # noqa: ANN401 - meshcat has no types
    robot: SpaceRobot,
    q: Array,
    ghost: int | None = None,
) -> None:
    """Visual shapes (of a link without any, its collision shapes), one node a joint, at `q`."""
    import meshcat.geometry as mg

    visible = list(robot.visual_model.geometryObjects)
    seen = {shape.parentFrame for shape in visible}
    visible += [g for g in robot.collision_model.geometryObjects if g.parentFrame not in seen]
    for k, shape in enumerate(visible):
        red, green, blue, _ = (round(255 * float(c)) for c in shape.meshColor)
        material = (
            mg.MeshPhongMaterial(color=(red << 16) + (green << 8) + blue, shininess=50)
            if ghost is None
            else mg.MeshPhongMaterial(color=ghost, opacity=0.28, depthWrite=False)
        )
        node = viewer[f"joint_{shape.parentJoint}"][str(k)]
        for part, (geometry, placement) in enumerate(solids(shape)):
            node[str(part)].set_object(geometry, material)
            node[str(part)].set_transform(shape.placement.homogeneous @ placement)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    for joint in range(1, robot.model.njoints):
        viewer[f"joint_{joint}"].set_transform(data.oMi[joint].homogeneous)


def add_trails(viewer: Any, segments: Array, strength: Array, up: Array) -> None:  # noqa: ANN401
    """Trails (k, 2, 3) [m] as ribbons facing `up`; width and glow by strength (k,), 0 .. 1."""
    wide = 0.008 + 0.035 * strength**2
    colours = np.stack(
        [np.interp(strength, np.linspace(0, 1, len(_GLOW)), c) for c in _GLOW.T], axis=1
    )
    raised = segments - (0.01 - 0.004 * strength)[:, None, None] * up  # strong above faint
    _add_ribbon(viewer, ribbon(raised, wide, colours, up))


def add_track(
    viewer: Any,  # noqa: ANN401 - meshcat has no types
    points: Array,
    width: float,
    colour: tuple[float, float, float],
    up: Array,
) -> None:
    """A ribbon of one width [m] and colour through points (N, 3) [m], facing `up`."""
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    count = len(pieces)
    _add_ribbon(viewer, ribbon(pieces, np.full(count, width), np.tile(colour, (count, 1)), up))


def _add_ribbon(viewer: Any, mesh: Any) -> None:  # noqa: ANN401 - meshcat has no types
    import meshcat.geometry as mg

    material = mg.MeshBasicMaterial(vertexColors=True, side=2, transparent=False)
    viewer.set_object(mesh, material)

"""Meshcat scene of a problem: light, camera, robot, obstacles, zones, trails and tracks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.display.scenes.body_tracks import BodyTrack, body_mesh, key_rows
from ffsr_plan.display.scenes.debris_track import DebrisTrack
from ffsr_plan.display.scenes.meshcat_objects import (
    MeshcatNode,
    instances,
    lines,
    ribbon,
    solids,
    triangle_mesh,
)
from ffsr_plan.display.scenes.projection import ShownProblem, view_axes, visible_shapes
from ffsr_plan.display.scenes.shape_outlines import ROUND, joined, mesh_of
from ffsr_plan.display.scenes.shown_space import farthest_shown, shown_space
from ffsr_plan.display.scenes.zone_outlines import dashed, lines_of, sides_of
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

TRACK, TIPS = (1.0, 0.86, 0.25), (0.35, 0.92, 0.85)  # colours of the base's and the tips' tracks
_MARGIN = 0.3  # around the scene [m]
_SHARE_OF_DASHES = 0.05  # of the longest edge of a zone: the least extent for which it is dashed
_TRIANGLES = 90_000  # of solid and of faint obstacles each; more obstacles are drawn less round
_ZONE, _ZONE_LINES = 0x8FA0BF, 0xB9C6DE
_MOVING, _WAY = 0xE07BB0, (0.42, 0.23, 0.33)  # colours of bodies that move, and of their ways
START, GOAL, _OBSTACLE, _FAINT = 0x4FB3D9, 0x58C27D, 0xAEB4BF, 0x8FA0BF
_GLOW = np.array([(0.14, 0.10, 0.29), (0.42, 0.12, 0.43), (0.86, 0.32, 0.26), (0.99, 0.72, 0.20)])


def set_up(
    viewer: MeshcatNode,
    problem: ShownProblem,
    centers: Array,
    radii: Array,
    tracks: Sequence[BodyTrack],
    debris: DebrisTrack,
) -> dict[str, Any]:
    """Set light and background, and rotate the scene so that the path runs from left to right.

    Args:
        viewer: meshcat's root.
        problem: what is shown.
        centers: (..., g, 3) centres of spheres around the robot in the world [m], all of which the
            camera has to see.
        radii: (g,) their radii [m].
        tracks: bodies that move, which the camera sees where they are near all else.
        debris: the debris.

    Returns:
        Size (3) of what is shown to the right, upwards and towards the viewer [m], the distance
        up to which something is drawn [m], field of view [degrees] and elevation of the camera
        [rad], from which the page's script computes where the camera is and how far it sees; and
        the placement (4, 4) of the world in the scene.
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
    shown = shown_space(scene, centers, radii, axes, tracks)
    root = np.eye(4)
    root[:3, :3] = axes
    root[:3, 3] = -shown.mean(axis=0)
    viewer.set_transform(root)
    return {
        "size": (np.ptp(shown, axis=0) + _MARGIN).tolist(),
        "fov": fov,
        "elevation": math.radians(62.0),
        "reach": farthest_shown(scene, shown, axes, tracks, debris.corners()),
        "root": root.tolist(),
    }


def add_obstacles(viewer: MeshcatNode, scene: Scene, drawn_solid: Flags) -> None:
    """Add the spheres and shapes of a scene; those not `drawn_solid` (N + S,) are faint."""
    import meshcat.geometry as mg

    solid = mg.MeshPhongMaterial(color=_OBSTACLE, shininess=60)
    faint = mg.MeshPhongMaterial(color=_FAINT, opacity=0.13, depthWrite=False, shininess=10)
    count = len(scene.radii)
    for name, chosen, material in (("near", drawn_solid, solid), ("far", ~drawn_solid, faint)):
        balls, bodies = chosen[:count], np.flatnonzero(chosen[count:])
        if balls.any():
            rings = int(np.clip(math.sqrt(_TRIANGLES / np.count_nonzero(balls) / 3.0), 6, 28))
            spheres = instances(scene.centers[balls], scene.radii[balls], rings, material)
            viewer[name].set_object(spheres)
        if len(bodies):
            rings = int(np.clip(math.sqrt(_TRIANGLES / len(bodies) / 4.0), 6, ROUND))
            mesh = joined([mesh_of(scene.shapes[k], rings) for k in bodies])
            viewer[f"{name}_shapes"].set_object(triangle_mesh(*mesh), material)


def add_bodies(viewer: MeshcatNode, tracks: Sequence[BodyTrack], up: Array) -> None:
    """Add bodies that move, where they are in the first frame, and the ways of their middles.

    Args:
        viewer: the node that receives them, the k-th body as its child k.
        tracks: the bodies.
        up: (3,) direction that the ways face.
    """
    import meshcat.geometry as mg

    material = mg.MeshPhongMaterial(color=_MOVING, shininess=60)
    count = sum(len(track.body.shapes) for track in tracks)
    rings = int(np.clip(math.sqrt(_TRIANGLES / max(count, 1) / 4.0), 6, ROUND))
    for k, track in enumerate(tracks):
        node = viewer[str(k)]
        node["shapes"].set_object(triangle_mesh(*body_mesh(track.body, rings)), material)
        node.set_transform(_pose(track, 0))
        if track.moves_away:
            middles = track.middles()
            way = middles[key_rows(middles, 1e-2)]
            add_track(viewer["ways"][str(k)], way, 0.014, _WAY, up)


def add_debris(viewer: MeshcatNode, debris: DebrisTrack, row: int = 0, faint: bool = False) -> None:
    """Add all spheres of debris, where they are in one frame (row).

    Args:
        viewer: the node that receives them.
        debris: the debris.
        row: the frame.
        faint: whether they are transparent.
    """
    import meshcat.geometry as mg

    if not debris:
        return
    look = {"opacity": 0.2, "depthWrite": False} if faint else {"shininess": 60}
    rings = int(np.clip(math.sqrt(_TRIANGLES / len(debris.radii) / 3.0), 6, 28))
    spheres = instances(
        debris.centers(row), debris.radii, rings, mg.MeshPhongMaterial(color=_MOVING, **look)
    )
    viewer.set_object(spheres)


def add_body_ghosts(viewer: MeshcatNode, tracks: Sequence[BodyTrack], rows: Sequence[int]) -> None:
    """Add transparent copies of bodies that move, where they are in some frames (rows)."""
    import meshcat.geometry as mg

    material = mg.MeshPhongMaterial(color=_MOVING, opacity=0.2, depthWrite=False)
    for k, track in enumerate(tracks):
        mesh = triangle_mesh(*body_mesh(track.body, 12))
        for row in rows:
            node = viewer[str(k)][str(row)]
            node.set_object(mesh, material)
            node.set_transform(_pose(track, row))


def _pose(track: BodyTrack, row: int) -> Array:
    """(4, 4) placement of a body's axes in the world in one frame."""
    placed = np.eye(4)
    placed[:3, :3] = rotations.matrix(track.attitudes[row])
    placed[:3, 3] = track.positions[row]
    return placed


def add_zones(viewer: MeshcatNode, scene: Scene, centers: Array, radii: Array) -> None:
    """Add keep-in zones: their sides, hardly visible, and dashed lines along their edges.

    Args:
        viewer: the node that receives them.
        scene: has the zones.
        centers: (..., g, 3) as of `set_up`: planes are drawn about all that is shown.
        radii: (g,) likewise.
    """
    import meshcat.geometry as mg

    if not scene.keep_in:
        return
    low, high = shown_space(scene, centers, radii)
    material = mg.MeshBasicMaterial(
        color=_ZONE, opacity=0.07, transparent=True, depthWrite=False, side=2
    )
    stroke = mg.LineBasicMaterial(color=_ZONE_LINES, opacity=0.8, transparent=True)
    for k, zone in enumerate(scene.keep_in):
        sides = sides_of(zone, low, high)
        if len(sides):
            corners = sides.reshape(-1, 3)
            mesh = triangle_mesh(corners, np.arange(len(corners)).reshape(-1, 3))
            viewer[str(k)]["sides"].set_object(mesh, material)
            segments = lines_of(zone, low, high).segments
            longest = float(np.max(np.linalg.norm(np.diff(segments, axis=1), axis=2)))
            extent = max(float(np.max(high - low)), _SHARE_OF_DASHES * longest)
            viewer[str(k)]["edges"].set_object(lines(dashed(segments, extent), stroke))


def add_ends(
    viewer: MeshcatNode, robot: SpaceRobot, start: Array, goal: Array, shapes: str = "visual"
) -> None:
    """Add the robot at the start (nq,), and transparent copies of it at start and goal (nq,)."""
    add_robot(viewer["robot"], robot, start, shapes=shapes)
    for name, colour, q in (("start", START, start), ("goal", GOAL, goal)):
        add_robot(viewer["ghosts"][name], robot, q, colour, shapes)


def add_robot(
    viewer: MeshcatNode,
    robot: SpaceRobot,
    q: Array,
    ghost: int | None = None,
    shapes: str = "visual",
) -> None:
    """Add a robot, one meshcat node for each joint and below it the shapes of its link.

    Args:
        viewer: the node that receives the robot.
        robot: the robot.
        q: (nq,) configuration.
        ghost: colour 0xRRGGBB of a transparent copy; by default the robot's own colours.
        shapes: which are shown, see `visible_shapes`.
    """
    import meshcat.geometry as mg

    for k, shape in enumerate(visible_shapes(robot, shapes)):
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
    place_robot(viewer, robot, q)


def place_robot(viewer: MeshcatNode, robot: SpaceRobot, q: Array) -> None:
    """Move a robot that was added before to a configuration (nq,)."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    for joint in range(1, robot.model.njoints):
        viewer[f"joint_{joint}"].set_transform(data.oMi[joint].homogeneous)


def glow(strength: Array) -> Array:
    """(k, 3) colours of trails of strength (k,) in [0, 1], from dark violet to yellow."""
    stops = np.linspace(0.0, 1.0, len(_GLOW))
    return np.stack([np.interp(strength, stops, channel) for channel in _GLOW.T], axis=1)


def add_trails(viewer: MeshcatNode, segments: Array, strength: Array, up: Array) -> None:
    """Add trails as ribbons whose width and colour show their strength.

    Args:
        viewer: the node that receives them.
        segments: (k, 2, 3) ends in the world [m].
        strength: (k,) in [0, 1].
        up: (3,) direction that the ribbons face.
    """
    widths = 0.008 + 0.035 * strength**2
    raised = segments - (0.01 - 0.004 * strength)[:, None, None] * up  # strong above faint
    _add_ribbon(viewer, ribbon(raised, widths, glow(strength), up))


def add_track(
    viewer: MeshcatNode,
    points: Array,
    width: float,
    colour: tuple[float, float, float],
    up: Array,
) -> None:
    """Add a ribbon of one width [m] and colour through points (N, 3) [m], facing `up` (3,)."""
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    count = len(pieces)
    _add_ribbon(viewer, ribbon(pieces, np.full(count, width), np.tile(colour, (count, 1)), up))


def _add_ribbon(viewer: MeshcatNode, mesh: MeshcatNode) -> None:
    import meshcat.geometry as mg

    material = mg.MeshBasicMaterial(vertexColors=True, side=2, transparent=False)
    viewer.set_object(mesh, material)

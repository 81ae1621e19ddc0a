"""A plan as one self-contained meshcat page: robot, obstacles, ants' trails, and a play bar."""

from __future__ import annotations

import base64
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.attitude import angle_between
from ffsr_plan.collision import ObstacleQuery
from ffsr_plan.inputs import Array
from ffsr_plan.lattice import path_frame
from ffsr_plan.placements import shape_placements
from ffsr_plan.result import proven
from ffsr_plan.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.result import Plan

SECONDS = 12.0  # how long the motion is shown; a plan has no time law of its own
_FRAMES_PER_EDGE = 8
_TRIANGLES = 90_000  # of near and of far obstacles; where they are many, they are less round
_START, _GOAL, _OBSTACLE, _FAR = 0x4FB3D9, 0x58C27D, 0xAEB4BF, 0x8FA0BF
_FEW, _NEAR = 60, 0.8  # obstacles that are all drawn solid; beyond that, only those so near [m]
_TRACK, _TIPS = (1.0, 0.86, 0.25), (0.35, 0.92, 0.85)
_GLOW = np.array([(0.09, 0.06, 0.20), (0.42, 0.12, 0.43), (0.86, 0.32, 0.26), (0.99, 0.72, 0.20)])


class CommandLog:
    """Stands in for meshcat's window: keeps the commands, in order, instead of sending them.

    meshcat names its objects by the clock and the machine; here they are numbered, so that the same
    plan gives the same page.
    """

    def __init__(self) -> None:
        self.commands: list[str] = []
        self._names: dict[str, str] = {}

    def send(self, command: Any) -> None:  # noqa: ANN401 - meshcat has no types
        """Keep a command, packed as meshcat would send it."""
        import umsgpack

        packed = umsgpack.packb(self._renumber(command.lower()))
        self.commands.append(base64.b64encode(packed).decode())

    def _renumber(self, value: Any) -> Any:  # noqa: ANN401 - any part of a command
        if isinstance(value, dict):
            return {key: self._name(entry) if key in ("uuid", "geometry", "material")
                    and isinstance(entry, str) else self._renumber(entry)
                    for key, entry in value.items()}  # fmt: skip
        if isinstance(value, list):
            return [self._renumber(entry) for entry in value]
        return value

    def _name(self, uuid: str) -> str:
        return self._names.setdefault(uuid, f"n{len(self._names)}")


def page(plan: Plan, title: str = "") -> str:
    """The HTML text of the page; without a title, robot and mode stand there."""
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    frames = plan.at(np.linspace(0.0, 1.0, plan.problem.lattice.divisions * _FRAMES_PER_EDGE + 1))
    view = _set_up(viewer, plan)
    _add_obstacles(viewer["obstacles"], plan)
    _add_robot(viewer["robot"], plan.problem.robot, plan.configurations[0])
    for name, colour, q in (
        ("start", _START, plan.configurations[0]),
        ("goal", _GOAL, plan.configurations[-1]),
    ):
        _add_robot(viewer["ghosts"][name], plan.problem.robot, q, colour)
    _add_tracks(viewer, plan, frames)
    _animate(viewer, plan.problem.robot, frames)
    query = ObstacleQuery(plan.problem.robot, plan.problem.scene)
    clearances = query.distances(frames)
    gap = "lattice gap" if plan.optimum_is_exact else "gap to a lower bound"
    data = {
        "title": title or f"{plan.problem.robot.name}, {plan.problem.mode}",
        "subtitle": f"{plan.planner.name}: L {plan.length:.3f} m, F {plan.objective:.2f}, "
        f"δ {plan.problem.delta:g}, {gap} {plan.gap:.2%}, "
        f"proven clearance {proven(plan.certificate.least_clearance)}",
        "commands": log.commands,
        "seconds": SECONDS,
        "clearances": [round(float(c), 5) if np.isfinite(c) else None for c in clearances],
        "turns": np.degrees(angle_between(frames[0, 3:7], frames[:, 3:7])).round(3).tolist(),
        "view": view,
        "ants": bool(len(plan.trails.layer)),
    }
    return _fill_template(data)


def _fill_template(data: dict[str, Any]) -> str:
    import meshcat

    bundle = Path(meshcat.__file__).parent / "viewer" / "dist" / "main.min.js"
    script = bundle.read_text(encoding="utf-8").replace("</script", "<\\/script")
    template = (Path(__file__).parent / "page.html").read_text(encoding="utf-8")
    text = json.dumps(data, ensure_ascii=False).replace("</", "<\\/")
    return template.replace("/*DATA*/", text).replace("/*MESHCAT*/", script)


def _set_up(viewer: Any, plan: Plan) -> dict[str, float]:  # noqa: ANN401 - meshcat has no types
    """Light, background, and the path frame turned so that the travel runs from left to right.

    Returns what the page needs to place the camera.
    """
    for name in ("/Grid", "/Axes"):
        viewer[name].set_property("visible", False)
    viewer["/Background"].set_property("top_color", [0.05, 0.07, 0.13])
    viewer["/Background"].set_property("bottom_color", [0.01, 0.015, 0.03])
    viewer["/Lights/AmbientLight/<object>"].set_property("intensity", 0.45)
    viewer["/Lights/FillLight/<object>"].set_property("intensity", 0.5)
    fov = 40.0
    viewer["/Cameras/default/rotated/<object>"].set_property("fov", fov)
    axes = _view_axes(plan)
    scene = plan.problem.scene
    shapes = shape_placements(plan.problem.robot, plan.configurations).positions
    points = [np.vstack([plan.configurations[:, :3], shapes.reshape(-1, 3)]) @ axes.T]
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


def _view_axes(plan: Plan) -> Array:
    """Rows: directions in the world that appear to the right, to the back and upwards."""
    if np.linalg.norm(plan.problem.travel) < 1e-9:
        return np.eye(3)
    frame = path_frame(plan.problem.travel)
    return np.array([frame[:, 2], frame[:, 0], frame[:, 1]])


def _add_obstacles(viewer: Any, plan: Plan) -> None:  # noqa: ANN401 - meshcat
    """Spheres; where they are many, those far from the motion are faint, so that it can be seen."""
    import meshcat.geometry as mg

    scene = plan.problem.scene
    near = plan.obstacles_near(_NEAR if len(scene) > _FEW else np.inf)
    solid = mg.MeshPhongMaterial(color=_OBSTACLE, shininess=60)
    faint = mg.MeshPhongMaterial(color=_FAR, opacity=0.13, depthWrite=False, shininess=10)
    for name, chosen, material in (("near", near, solid), ("far", ~near, faint)):
        if chosen.any():
            share = math.sqrt(_TRIANGLES / np.count_nonzero(chosen) / 3.0)
            rings = int(np.clip(share, 6, 28))
            spheres = _instances(scene.centers[chosen], scene.radii[chosen], rings, material)
            viewer[name].set_object(spheres)


def _instances(centers: Array, radii: Array, rings: int, material: Any) -> Any:  # noqa: ANN401
    """All spheres as copies of one: thousands are drawn in one go, and turn without stutter."""
    import meshcat.geometry as mg

    class Instances(mg.Mesh):  # type: ignore[misc]  # what three.js reads, meshcat does not know
        _type = "InstancedMesh"

        def lower(self) -> Any:  # noqa: ANN401
            placed = np.zeros((len(radii), 4, 4))
            placed[:, [0, 1, 2], [0, 1, 2]] = radii[:, None]
            placed[:, 3, :3], placed[:, 3, 3] = centers, 1.0  # by columns
            data = super().lower()
            data["object"] |= {
                "count": len(radii),
                "instanceMatrix": {"array": np.round(placed, 6).ravel().tolist()},
                "frustumCulled": False,  # it would be judged by the one sphere at the origin
            }
            return data

    return Instances(_sphere(1.0, rings), material)


def _add_robot(
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
        for part, (geometry, placement) in enumerate(_solids(shape)):
            node[str(part)].set_object(geometry, material)
            node[str(part)].set_transform(shape.placement.homogeneous @ placement)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    for joint in range(1, robot.model.njoints):
        viewer[f"joint_{joint}"].set_transform(data.oMi[joint].homogeneous)


def _solids(shape: pin.GeometryObject) -> list[tuple[Any, Array]]:
    """Meshcat geometries of a shape, each with its placement in the shape's frame."""
    import meshcat.geometry as mg

    solid: Any = shape.geometry
    if isinstance(solid, coal.Box):
        return [(mg.Box([float(2.0 * h) for h in solid.halfSide]), np.eye(4))]
    if isinstance(solid, coal.Sphere):
        return [(_sphere(float(solid.radius)), np.eye(4))]
    if isinstance(solid, (coal.Cylinder, coal.Capsule)):
        upright = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])  # y to z
        half, radius = float(solid.halfLength), float(solid.radius)
        parts = [(mg.Cylinder(2.0 * half, radius), upright)]
        if isinstance(solid, coal.Capsule):
            parts += [(_sphere(radius), _translation([0.0, 0.0, z])) for z in (-half, half)]
        return parts
    if isinstance(solid, coal.Convex):
        corners = np.array(solid.points())
        faces = [solid.polygons(k) for k in range(solid.num_polygons)]
        loose = corners[[[t[0], t[1], t[2]] for t in faces]].reshape(-1, 3)  # so edges stay sharp
        return [(mg.TriangularMeshGeometry(loose, np.arange(len(loose)).reshape(-1, 3)), np.eye(4))]
    faces = [solid.tri_indices(k) for k in range(solid.num_tris)]
    triangles = np.array([[t[0], t[1], t[2]] for t in faces])
    vertices = np.array(solid.vertices()) * np.asarray(shape.meshScale)
    return [(mg.TriangularMeshGeometry(vertices, triangles), np.eye(4))]


def _add_tracks(viewer: Any, plan: Plan, frames: Array) -> None:  # noqa: ANN401 - meshcat
    """Ribbons in the plane of the path: ants' trails by pheromone, base origin, arm tips."""
    import meshcat.geometry as mg

    up = _view_axes(plan)[2]
    flat = {"side": 2, "transparent": False}
    segments, strength = plan.trail_segments()
    if len(segments):
        wide = 0.008 + 0.035 * strength**2
        colours = np.stack(
            [np.interp(strength, np.linspace(0, 1, len(_GLOW)), c) for c in _GLOW.T], axis=1
        )
        raised = segments - (0.01 - 0.004 * strength)[:, None, None] * up  # strong above faint
        ribbon = _ribbon(raised, wide, colours, up)
        viewer["trails"].set_object(ribbon, mg.MeshBasicMaterial(vertexColors=True, **flat))
    tracks = {"base": (frames[:, :3], 0.035, _TRACK)}
    for name, points in _tips(plan.problem.robot, frames).items():
        tracks[name] = (points, 0.014, _TIPS)
    for name, (points, width, colour) in tracks.items():
        pieces = np.stack([points[:-1], points[1:]], axis=1)
        count = len(pieces)
        ribbon = _ribbon(pieces, np.full(count, width), np.tile(colour, (count, 1)), up)
        material = mg.MeshBasicMaterial(vertexColors=True, **flat)
        viewer["tracks"][name].set_object(ribbon, material)


def _ribbon(segments: Array, widths: Array, colours: Array, up: Array) -> Any:  # noqa: ANN401
    """One mesh of flat quads along segments (k, 2, 3), facing `up`."""
    import meshcat.geometry as mg

    along = segments[:, 1] - segments[:, 0]
    sideways = np.cross(up, along)
    size = np.linalg.norm(sideways, axis=1, keepdims=True)
    sideways = 0.5 * widths[:, None] * sideways / np.maximum(size, 1e-9)
    corners = np.stack(
        [
            segments[:, 0] - sideways,
            segments[:, 0] + sideways,
            segments[:, 1] + sideways,
            segments[:, 1] - sideways,
        ],
        axis=1,
    )
    first = 4 * np.arange(len(segments))[:, None]
    faces = np.concatenate([first + np.array(corner) for corner in ([0, 1, 2], [0, 2, 3])])
    return mg.TriangularMeshGeometry(
        corners.reshape(-1, 3), faces, color=np.repeat(colours, 4, axis=0)
    )


def _tips(robot: SpaceRobot, frames: Array) -> dict[str, Array]:
    """Tracks of the last shape of each arm."""
    parents = set(robot.model.parents[2:])
    leaves = [j for j in range(2, robot.model.njoints) if j not in parents]
    shapes = {g.parentJoint: g for g in robot.collision_model.geometryObjects}
    data = robot.model.createData()
    tracks: dict[str, list[Array]] = {robot.model.names[j]: [] for j in leaves if j in shapes}
    for q in frames:
        pin.forwardKinematics(robot.model, data, q)
        for j in leaves:
            if j in shapes:
                tracks[robot.model.names[j]].append(
                    data.oMi[j].act(np.array(shapes[j].placement.translation))
                )
    return {name: np.array(points) for name, points in tracks.items()}


def _animate(viewer: Any, robot: SpaceRobot, frames: Array) -> None:  # noqa: ANN401 - meshcat
    from meshcat.animation import Animation, AnimationClip, AnimationTrack

    joints = range(1, robot.model.njoints)
    positions: dict[int, list[list[float]]] = {j: [] for j in joints}
    turns: dict[int, list[list[float]]] = {j: [] for j in joints}
    data = robot.model.createData()
    for q in frames:
        pin.forwardKinematics(robot.model, data, q)
        for j in joints:
            positions[j].append(data.oMi[j].translation.tolist())
            turns[j].append(pin.Quaternion(data.oMi[j].rotation).coeffs().tolist())
    times = list(range(len(frames)))
    clips = {}
    for j in joints:
        tracks = {
            "position": AnimationTrack("position", "vector3", times, positions[j]),
            "quaternion": AnimationTrack("quaternion", "quaternion", times, turns[j]),
        }
        clips[viewer["robot"][f"joint_{j}"].path] = AnimationClip(
            tracks, fps=(len(frames) - 1) / SECONDS
        )
    viewer.set_animation(Animation(clips), play=False)


def _sphere(radius: float, rings: int = 28) -> Any:  # noqa: ANN401 - meshcat has no types
    import meshcat.geometry as mg

    class Sphere(mg.Sphere):  # type: ignore[misc]  # round enough to be seen close up
        def lower(self, object_data: Any) -> Any:  # noqa: ANN401
            return super().lower(object_data) | {
                "widthSegments": rings * 10 // 7,
                "heightSegments": rings,
            }

    return Sphere(radius)


def _translation(vector: Any) -> Array:  # noqa: ANN401 - any three numbers
    placement = np.eye(4)
    placement[:3, 3] = vector
    return placement

"""Obstacles as primitives in YAML or JSON: robometrics, MotionBenchMaker, planning scene messages.

robometrics has cuboids, cylinders and spheres by name, each with a pose of seven numbers, the
scalar of the quaternion first. MotionBenchMaker has collision objects as MoveIt's messages have
them, the scalar last.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats.values.data_files import field_of, read_data, write_data
from ffsr_plan.formats.values.plain_obstacles import obstacles_of
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Cylinder, Hull, ObstacleShape

_KINDS = {1: "box", 2: "sphere", 3: "cylinder"}  # of shape_msgs/SolidPrimitive
_WORDS = {"cuboid": "box", **{word: word for word in _KINDS.values()}}
_ORIGIN = {"position": [0.0, 0.0, 0.0], "orientation": [0.0, 0.0, 0.0, 1.0]}


def read_primitives(path: str | Path, *, problem: int = 0) -> Scene:
    """Read obstacles.

    Read are `obstacles` of robometrics with `cuboid`, `cylinder` and `sphere`, also within one of
    the problems of a data set; and `collision_objects` with `primitives` and `primitive_poses`,
    also within `world` or `scene`. Meshes that lie in the file become their convex hulls; others
    are refused. All poses have to be in one frame, which is the world.

    Args:
        path: the file; it ends in .yaml, .yml or .json.
        problem: number of the problem in a data set, from 0 on, over all its sets.

    Raises:
        InvalidInput: names the file, the field, its value and what is allowed.
    """
    what, data = f"scene '{path}'", read_data("scene", path)
    chosen = whole_number("problem", problem, at_least=0)
    sets = _problems(data)
    if sets:
        if chosen >= len(sets):
            raise InvalidInput("problem", chosen, f"a number from 0 to {len(sets) - 1}")
        data = sets[chosen]
    for name in ("scene", "planning_scene", "world"):
        if isinstance(data, dict) and isinstance(data.get(name), dict):
            data = data[name]
    if isinstance(data, dict) and "collision_objects" in data:
        listed = field_of(what, data, "collision_objects", list, [])
        return Scene(shapes=[s for k, each in enumerate(listed) for s in _object(what, k, each)])
    given = field_of(what, data, "obstacles", dict)
    return Scene(shapes=list(_named(what, given)))


def write_primitives(path: str | Path, scene: Scene) -> None:
    """Write obstacles as robometrics has them: `cuboid`, `cylinder` and `sphere`.

    Args:
        path: the file, replaced if it exists; it ends in .yaml, .yml or .json.
        scene: the obstacles.

    Raises:
        InvalidInput: obstacles that are no boxes, cylinders, balls or spheres, or a file that
            cannot be written.
    """
    tables: dict[str, dict[str, Any]] = {}
    for k, shape in enumerate(obstacles_of(scene)):
        kind, table = _table(shape)
        held = tables.setdefault(kind, {})
        name = shape.name if shape.name and shape.name not in held else f"{kind}_{k}"
        held[name] = table
    write_data(path, {"obstacles": tables})


def _table(shape: ObstacleShape) -> tuple[str, dict[str, Any]]:
    """Kind and table of a shape."""
    quat = shape.attitude[[3, 0, 1, 2]].tolist()
    pose = [*shape.position.tolist(), *quat]
    if isinstance(shape, Box):
        return "cuboid", {"dims": shape.size.tolist(), "pose": pose}
    if isinstance(shape, Cylinder):
        return "cylinder", {"radius": shape.radius, "height": shape.length, "pose": pose}
    if isinstance(shape, Ball):
        return "sphere", {"radius": shape.radius, "position": pose[:3]}
    raise InvalidInput("scene", repr(shape), "boxes, cylinders, balls and spheres")


def _problems(data: object) -> list[dict[str, Any]]:
    """The problems of a data set, of all its sets one after another; none of other files."""
    if isinstance(data, list):
        return [each for each in data if isinstance(each, dict)]
    if not isinstance(data, dict) or {"obstacles", "collision_objects", "world"} & data.keys():
        return []
    found = []
    for listed in data.values():
        if isinstance(listed, list):
            found += [each for each in listed if isinstance(each, dict) and "obstacles" in each]
    return found


def _named(what: str, tables: dict[str, Any]) -> Iterator[ObstacleShape]:
    """Shapes of robometrics' tables."""
    for word, listed in tables.items():
        if word not in _WORDS:
            raise InvalidInput(f"{what}, obstacles", word, ", ".join(_WORDS))
        for name, table in (listed or {}).items():
            where = f"{what}, {word} '{name}'"
            position, quat = _robometrics_pose(where, table)
            sizes = {"box": ("dims",), "cylinder": ("height", "radius"), "sphere": ("radius",)}
            kind = _WORDS[word]
            given = [field_of(where, table, size, object) for size in sizes[kind]]
            flat = given[0] if kind == "box" else given
            yield _shape(where, kind, flat, (position, quat), str(name))


def _robometrics_pose(where: str, table: dict[str, Any]) -> tuple[Array, Array]:
    """Position (3,) and attitude (4,) xyzw of a table."""
    if isinstance(table, dict) and "pose" not in table and "position" in table:
        return finite_array(f"{where}, position", table["position"], (3,)), rotations.IDENTITY
    pose = finite_array(f"{where}, pose", field_of(where, table, "pose", list), (7,))
    return pose[:3], _unit(f"{where}, pose", pose[[4, 5, 6, 3]])


def _object(what: str, number: int, table: object) -> Iterator[ObstacleShape]:
    """Shapes of a collision object."""
    where = f"{what}, collision_objects.{number}"
    name = str(field_of(where, table, "id", object, f"object_{number}"))
    outer = _pose(f"{where}, pose", field_of(where, table, "pose", dict, _ORIGIN))
    for kind in ("primitive", "mesh"):
        plural = "primitives" if kind == "primitive" else "meshes"
        solids = field_of(where, table, plural, list, [])
        poses = field_of(where, table, f"{kind}_poses", list, [])
        if len(poses) not in (len(solids), 0):
            raise InvalidInput(f"{where}, {kind}_poses", len(poses), f"{len(solids)} poses")
        for k, solid in enumerate(solids):
            at = f"{where}, {plural}.{k}"
            place, turn = _pose(at, poses[k] if poses else _ORIGIN)
            pose = (
                outer[0] + rotations.rotate(outer[1], place),
                rotations.multiply(outer[1], turn),
            )
            if kind == "mesh":
                yield Hull(_corners(at, solid), *pose, name)
            else:
                yield _primitive(at, solid, pose, name)


def _primitive(where: str, solid: object, pose: tuple[Array, Array], name: str) -> ObstacleShape:
    """A shape of a SolidPrimitive."""
    given = field_of(where, solid, "type", object)
    kind = _KINDS.get(given, "") if isinstance(given, int) else str(given).casefold()
    if kind not in _KINDS.values():
        raise InvalidInput(f"{where}, type", given, "box (1), sphere (2) or cylinder (3)")
    return _shape(where, kind, field_of(where, solid, "dimensions", list), pose, name)


def _shape(
    where: str, kind: str, sizes: object, pose: tuple[Array, Array], name: str
) -> ObstacleShape:
    """A shape; a cylinder's sizes are its height and its radius [m]."""
    count = {"box": 3, "sphere": 1, "cylinder": 2}[kind]
    lengths = finite_array(f"{where}, sizes", sizes, (count,))  # type: ignore[arg-type]
    try:
        if kind == "box":
            return Box(lengths, *pose, name)
        if kind == "sphere":
            return Ball(float(lengths[0]), pose[0], name)
        return Cylinder(float(lengths[1]), float(lengths[0]), *pose, name)
    except InvalidInput as error:
        raise InvalidInput(f"{where}: {error.what}", error.value, error.allowed) from None


def _corners(where: str, mesh: object) -> Array:
    """(n, 3) corners of a mesh that lies in the file."""
    corners = field_of(where, mesh, "vertices", list)
    rows = [[each[a] for a in "xyz"] if isinstance(each, dict) else each for each in corners]
    return finite_array(f"{where}, vertices", rows, (-1, 3))


def _pose(where: str, table: object) -> tuple[Array, Array]:
    """Position (3,) and attitude (4,) xyzw of a pose, as lists or as mappings."""
    place = field_of(where, table, "position", object, [0.0, 0.0, 0.0])
    turn = field_of(where, table, "orientation", object, [0.0, 0.0, 0.0, 1.0])
    if isinstance(place, dict):
        place = [place.get(axis, 0.0) for axis in "xyz"]
    if isinstance(turn, dict):
        turn = [turn.get(axis, 0.0) for axis in "xyzw"]
        turn = [0.0, 0.0, 0.0, 1.0] if not np.any(turn) else turn
    quat = finite_array(f"{where}, orientation", turn, (4,))
    return finite_array(f"{where}, position", place, (3,)), _unit(f"{where}, orientation", quat)


def _unit(what: str, quat: Array) -> Array:
    """A quaternion of norm one within a thousandth, normalised."""
    norm = float(np.linalg.norm(quat))
    if abs(norm - 1.0) > 1e-3:
        raise InvalidInput(what, quat.tolist(), f"a quaternion of norm one; this norm is {norm:g}")
    return np.asarray(quat / norm)

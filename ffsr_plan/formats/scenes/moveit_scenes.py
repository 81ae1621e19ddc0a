"""Obstacles in MoveIt's `.scene` texts, as its motion planning panel saves and loads them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text
from ffsr_plan.formats.values.plain_obstacles import obstacles_of
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Hull,
    ObstacleShape,
)

_SIDES = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2}
_CONE = 24  # points of the circle that stands for a cone's base
_COLOUR = "0.6 0.6 0.65 1"


def read_moveit_scene(path: str | Path) -> Scene:
    """Read a `.scene` text, of MoveIt 1 or 2.

    Boxes, spheres and cylinders are taken as they are. A cone becomes the hull of a circumscribed
    pyramid of 24 sides, a mesh its convex hull: both contain what they stand for.

    Args:
        path: the file; it ends in `.scene`.

    Returns:
        The obstacles; names are those of the objects.

    Raises:
        InvalidInput: names the file, the line, its content and what is allowed.
    """
    target = checked_path("scene", path, ".scene")
    return Scene(shapes=list(_Reader(f"scene '{path}'", read_text("scene", target)).shapes()))


def write_moveit_scene(path: str | Path, scene: Scene) -> None:
    """Write a `.scene` text that MoveIt 1 (from 1.1 on) and MoveIt 2 load.

    Spheres and balls are spheres there; a capsule is a cylinder and two spheres of one object, a
    hull is a mesh. What each obstacle comes from, zones, growth and bodies that move are not in it.

    Args:
        path: the file, replaced if it exists; it ends in `.scene`.
        scene: the obstacles.

    Raises:
        InvalidInput: zones, bodies that move or ellipsoids, which the format lacks, or a file that
            cannot be written.
    """
    target = checked_path("path", path, ".scene")
    lines = ["(noname)+"]
    shapes = obstacles_of(scene)
    for k, shape in enumerate(shapes):
        name = shape.name.strip() or f"obstacle_{k}"
        parts = list(_parts(shape))
        lines += [f"* {name}", _row(shape.position), _row(shape.attitude), str(len(parts))]
        for words, place in parts:
            lines += [*words, _row(place), "0 0 0 1", _COLOUR]
        lines += ["0"]
    write_text("path", target, "\n".join([*lines, ".", ""]))


def _parts(shape: ObstacleShape) -> Iterator[tuple[list[str], Array]]:
    """Lines of the shapes of an object, and their places in its frame [m]."""
    origin = np.zeros(3)
    if isinstance(shape, Box):
        yield ["box", _row(shape.size)], origin
    elif isinstance(shape, Ball):
        yield ["sphere", repr(shape.radius)], origin
    elif isinstance(shape, Cylinder):
        yield ["cylinder", f"{shape.radius!r} {shape.length!r}"], origin
    elif isinstance(shape, Capsule):
        yield ["cylinder", f"{shape.radius!r} {shape.length!r}"], origin
        for sign in (-0.5, 0.5):
            yield ["sphere", repr(shape.radius)], np.array([0.0, 0.0, sign * shape.length])
    elif isinstance(shape, Hull):
        faces = ConvexHull(shape.points).simplices
        head = ["mesh", f"{len(shape.points)} {len(faces)}"]
        yield [*head, *map(_row, shape.points), *(" ".join(map(str, f)) for f in faces)], origin
    else:
        allowed = "a box, ball, capsule, cylinder or hull"
        raise InvalidInput("scene", repr(shape), allowed)


def _row(values: Array) -> str:
    return " ".join(map(repr, values.tolist()))


class _Reader:
    """Reads the words of a text one after another."""

    def __init__(self, what: str, text: str) -> None:
        self._what, self._lines = what, text.splitlines()
        self._words = [
            (word, number)
            for number, line in enumerate(self._lines[1:], start=2)
            for word in ([f"*{line.strip()[1:].strip()}"] if _begins(line) else line.split())
        ]
        self._next = 0
        first = next((k for k, line in enumerate(self._lines[1:], 1) if _begins(line)), None)
        # the line below an object's name is its position, or in older texts the number of shapes
        self._new = first is not None and len(self._line(first + 1).split()) > 1

    def shapes(self) -> Iterator[ObstacleShape]:
        """All shapes."""
        while True:
            word = self._word("an object (*), or the end (.)")
            if word == ".":
                return
            if not word.startswith("*"):
                raise self._wrong(word, "an object (*), or the end (.)")
            yield from self._object(word[1:])

    def _object(self, name: str) -> Iterator[ObstacleShape]:
        place, turn = np.zeros(3), rotations.IDENTITY
        if self._new:
            place, turn = self._numbers(3), self._quaternion()
        for _ in range(self._count()):
            kind = self._word("a shape")
            make = self._shape(kind)
            own, turned = self._numbers(3), self._quaternion()
            self._numbers(4)  # its colour
            at = place + rotations.rotate(turn, own)
            yield make(at, rotations.multiply(turn, turned), name)
        if self._new:
            for _ in range(self._count()):
                self._word("the name of a subframe")
                self._numbers(7)

    def _shape(self, kind: str) -> _Maker:
        if kind == "mesh":
            corners, faces = self._count(), self._count()
            points = self._numbers(3 * corners).reshape(-1, 3)
            self._numbers(3 * faces)
            return _Maker(kind, points)
        if kind not in _SIDES:
            raise self._wrong(kind, f"{', '.join(_SIDES)} or mesh")
        return _Maker(kind, self._numbers(_SIDES[kind]))

    def _quaternion(self) -> Array:
        quat = self._numbers(4)
        norm = float(np.linalg.norm(quat))
        if abs(norm - 1.0) > 1e-3:
            raise self._wrong(_row(quat), "a quaternion x y z w of norm one")
        return np.asarray(quat / norm)

    def _numbers(self, count: int) -> Array:
        return np.array([self._number() for _ in range(count)])

    def _number(self) -> float:
        word = self._word("a number")
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            raise self._wrong(word, "a finite number")
        return value

    def _count(self) -> int:
        word = self._word("a number of shapes, corners or subframes")
        if not word.isdigit():
            raise self._wrong(word, "a number of shapes, corners or subframes")
        return int(word)

    def _word(self, wanted: str) -> str:
        if self._next == len(self._words):
            raise InvalidInput(self._what, "the end of the file", wanted)
        self._next += 1
        return self._words[self._next - 1][0]

    def _line(self, number: int) -> str:
        return self._lines[number] if number < len(self._lines) else ""

    def _wrong(self, value: str, allowed: str) -> InvalidInput:
        line = self._words[self._next - 1][1]
        return InvalidInput(f"{self._what}, line {line}", value, allowed)


class _Maker:
    """A shape without its place."""

    def __init__(self, kind: str, sizes: Array) -> None:
        self._kind, self._sizes = kind, sizes

    def __call__(self, place: Array, turn: Array, name: str) -> ObstacleShape:
        given = self._sizes
        if self._kind == "box":
            return Box(given, place, turn, name)
        if self._kind == "sphere":
            return Ball(float(given[0]), place, name)
        if self._kind == "cylinder":
            return Cylinder(float(given[0]), float(given[1]), place, turn, name)
        if self._kind == "cone":
            given = _cone(float(given[0]), float(given[1]))
        return Hull(given, place, turn, name)


def _cone(radius: float, length: float) -> Array:
    """Corners of a pyramid around a cone whose tip is at half its length along z."""
    angles = 2.0 * np.pi * np.arange(_CONE) / _CONE
    wide = radius / np.cos(np.pi / _CONE)
    circle = np.column_stack([wide * np.cos(angles), wide * np.sin(angles)])
    return np.vstack(
        [np.column_stack([circle, np.full(_CONE, -0.5 * length)]), [0, 0, 0.5 * length]]
    )


def _begins(line: str) -> bool:
    return line.lstrip().startswith("*")

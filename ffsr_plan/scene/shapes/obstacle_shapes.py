"""Convex obstacles of every shape, placed in the world: boxes, capsules, cylinders, hulls.

Each lies in a box along its own axes that is widened by a radius, its skin. Of boxes, balls and
capsules that is the shape itself; of the others it is a box around them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, number, text, unit_quaternion
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Numbers, Rule, Text, Vector
from ffsr_plan.core.settings import setting, settings
from ffsr_plan.meshes import mesh_files

_ORIGIN = (0.0, 0.0, 0.0)
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)
_MOST_POINTS = 100_000
LARGEST_SIZE = 1e4
"""Limit [m] of sizes: larger bodies count as touched while they are metres away, as the errors of
bounds on their distances grow with them."""


@dataclass(frozen=True)
class Attitude(Rule):
    """A unit quaternion (4,), or ZYX angles (3,) [rad] that become one."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        given: Any = value
        rows = isinstance(given, (list, tuple)) or (isinstance(given, np.ndarray) and given.ndim)
        if rows and len(given) == 3:
            return frozen(rotations.from_angles(finite_array(what, given, (3,))))
        try:
            return unit_quaternion(what, given)
        except InvalidInput as error:
            allowed = "three ZYX angles [rad], or a unit quaternion (x, y, z, w)"
            raise InvalidInput(error.what, error.value, allowed) from None

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        return {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 4}


@dataclass(frozen=True)
class Lengths(Rule):
    """Three lengths [m].

    Attributes:
        flat: whether they may be zero.
    """

    flat: bool = False

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        lengths = finite_array(what, value, (3,), LARGEST_SIZE)  # type: ignore[arg-type]
        if np.any(lengths < 0.0) or (not self.flat and np.any(lengths == 0.0)):
            least = "of at least 0" if self.flat else "above 0"
            raise InvalidInput(what, lengths.tolist(), f"three lengths {least} [m]")
        return lengths

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        least = {"minimum": 0.0} if self.flat else {"exclusiveMinimum": 0.0}
        items = {"type": "number", **least, "maximum": LARGEST_SIZE}
        return {"type": "array", "items": items, "minItems": 3, "maxItems": 3}


@dataclass(frozen=True)
class Points(Rule):
    """Points (n, 3) that span a volume, of which those on their convex hull are kept [m]."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array:
        """See `Rule.check`."""
        points = finite_array(what, value, (-1, 3), LARGEST_SIZE)  # type: ignore[arg-type]
        if not 4 <= len(points) <= _MOST_POINTS:
            raise InvalidInput(what, f"{len(points)} points", f"4 to {_MOST_POINTS} points")
        try:
            return frozen(mesh_files.hull(points, "", "")[0])
        except InvalidInput:
            raise InvalidInput(what, points.tolist(), "points that do not lie in a plane") from None

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        point = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
        return {"type": "array", "items": point, "minItems": 4}


Length = Annotated[float, Number(above=0.0, at_most=LARGEST_SIZE)]
Place = Annotated[Vector, Numbers(3, FARTHEST)]
Turn = Annotated[Vector, Attitude()]
Name = Annotated[str, Text()]


class ObstacleShape(Protocol):
    """A convex body at rest.

    Attributes:
        word: the kind of shape, in messages.
        position: (3,) origin of its axes in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes.
        name: by which errors name it; may be empty.
        middle: (3,) middle of the box around it, along its own axes [m].
        half_sides: (3,) of that box, without the skin [m].
        skin: radius by which the box is widened [m].
        is_box: whether the widened box is the shape itself.
    """

    word: ClassVar[str]
    is_box: ClassVar[bool]

    @property
    def position(self) -> Array: ...  # noqa: D102

    @property
    def attitude(self) -> Array: ...  # noqa: D102

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def middle(self) -> Array: ...  # noqa: D102

    @property
    def half_sides(self) -> Array: ...  # noqa: D102

    @property
    def skin(self) -> float: ...  # noqa: D102


class _Centred:
    """A shape whose middle is the origin of its axes."""

    @property
    def middle(self) -> Array:
        """(3,) zeros: the middle of the box around it, along its own axes [m]."""
        return np.zeros(3)


@settings
class Box(_Centred):
    """A box, whose sides may be zero: a flat panel is one.

    Attributes:
        size: (3,) lengths of its sides [m].
        position: (3,) its middle in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes, or (3,) ZYX angles [rad].
        name: by which errors name it.
    """

    word: ClassVar[str] = "box"
    is_box: ClassVar[bool] = True

    size: Annotated[Vector, Lengths(flat=True)]
    position: Place = setting(default=_ORIGIN)
    attitude: Turn = setting(default=_UPRIGHT)
    name: Name = ""

    @property
    def half_sides(self) -> Array:
        """(3,) half of its size [m]."""
        return 0.5 * self.size

    @property
    def skin(self) -> float:
        """Zero."""
        return 0.0


@settings
class Ball(_Centred):
    """A ball.

    Attributes:
        radius: [m].
        position: (3,) its centre in the world [m].
        name: by which errors name it.
    """

    word: ClassVar[str] = "ball"
    is_box: ClassVar[bool] = True

    radius: Length
    position: Place = setting(default=_ORIGIN)
    name: Name = ""

    @property
    def attitude(self) -> Array:
        """(4,) that of the world's axes."""
        return np.array(_UPRIGHT)

    @property
    def half_sides(self) -> Array:
        """(3,) zeros."""
        return np.zeros(3)

    @property
    def skin(self) -> float:
        """Its radius [m]."""
        return self.radius


@settings
class Capsule(_Centred):
    """A capsule along z of its axes: a cylinder with a hemisphere at each end.

    Attributes:
        radius: [m].
        length: of the cylinder, without the hemispheres [m].
        position: (3,) its middle in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes, or (3,) ZYX angles [rad].
        name: by which errors name it.
    """

    word: ClassVar[str] = "capsule"
    is_box: ClassVar[bool] = True

    radius: Length
    length: Length
    position: Place = setting(default=_ORIGIN)
    attitude: Turn = setting(default=_UPRIGHT)
    name: Name = ""

    @property
    def half_sides(self) -> Array:
        """(3,) of the segment in it [m]."""
        return np.array([0.0, 0.0, 0.5 * self.length])

    @property
    def skin(self) -> float:
        """Its radius [m]."""
        return self.radius


@settings
class Cylinder(_Centred):
    """A cylinder along z of its axes.

    Attributes:
        radius: [m].
        length: [m].
        position: (3,) its middle in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes, or (3,) ZYX angles [rad].
        name: by which errors name it.
    """

    word: ClassVar[str] = "cylinder"
    is_box: ClassVar[bool] = False

    radius: Length
    length: Length
    position: Place = setting(default=_ORIGIN)
    attitude: Turn = setting(default=_UPRIGHT)
    name: Name = ""

    @property
    def half_sides(self) -> Array:
        """(3,) of the box around it [m]."""
        return np.array([self.radius, self.radius, 0.5 * self.length])

    @property
    def skin(self) -> float:
        """Zero."""
        return 0.0


@settings
class Ellipsoid(_Centred):
    """An ellipsoid.

    Attributes:
        semi_axes: (3,) half of its extents along its axes [m].
        position: (3,) its middle in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes, or (3,) ZYX angles [rad].
        name: by which errors name it.
    """

    word: ClassVar[str] = "ellipsoid"
    is_box: ClassVar[bool] = False

    semi_axes: Annotated[Vector, Lengths()]
    position: Place = setting(default=_ORIGIN)
    attitude: Turn = setting(default=_UPRIGHT)
    name: Name = ""

    @property
    def half_sides(self) -> Array:
        """(3,) of the box around it [m]."""
        return self.semi_axes

    @property
    def skin(self) -> float:
        """Zero."""
        return 0.0


@settings
class Hull:
    """The convex hull of points.

    Attributes:
        points: (n, 3) along its axes [m]; those on the hull are kept.
        position: (3,) origin of its axes in the world [m].
        attitude: (4,) quaternion (x, y, z, w) of its axes, or (3,) ZYX angles [rad].
        name: by which errors name it.
    """

    word: ClassVar[str] = "hull"
    is_box: ClassVar[bool] = False

    points: Annotated[Vector, Points()]
    position: Place = setting(default=_ORIGIN)
    attitude: Turn = setting(default=_UPRIGHT)
    name: Name = ""

    @classmethod
    def from_mesh(
        cls,
        mesh: str | Path,
        *,
        scale: float = 1.0,
        position: ArrayLike = _ORIGIN,
        attitude: ArrayLike = _ORIGIN,
        name: str = "",
    ) -> Hull:
        """The convex hull of a mesh, which fills its hollows.

        Args:
            mesh: path of a .stl, .obj, .dae or .ply file.
            scale: metres per unit of length of the mesh, > 0.
            position: (3,) origin of the mesh in the world [m].
            attitude: of the mesh's axes: (3,) ZYX angles [rad], or (4,) quaternion.
            name: by which errors name it; the name of the file without one.

        Raises:
            InvalidInput: a mesh that cannot be read or is flat.
        """
        file = checked_path("mesh", mesh)
        corners = mesh_files.hull_corners(str(file.absolute()), [], "mesh")
        factor = number("scale", scale, above=0.0, at_most=1e9)
        return cls(factor * corners, position, attitude, text("name", name) or Path(mesh).name)

    @cached_property
    def middle(self) -> Array:
        """(3,) middle of the box around it, along its own axes [m]."""
        return frozen(0.5 * (self.points.min(axis=0) + self.points.max(axis=0)))

    @cached_property
    def half_sides(self) -> Array:
        """(3,) of the box around it [m]."""
        return frozen(np.abs(self.points - self.middle).max(axis=0))

    @property
    def skin(self) -> float:
        """Zero."""
        return 0.0


SHAPES: dict[str, type[Any]] = {
    each.word: each for each in (Box, Ball, Capsule, Cylinder, Ellipsoid, Hull)
}
"""The classes of convex bodies by their words."""


def placed_axes(shape: ObstacleShape) -> tuple[Array, Array]:
    """The box around a shape in the world.

    Args:
        shape: the shape.

    Returns:
        (3, 3) its axes as columns, and (3,) its middle [m].
    """
    turn = rotations.matrix(shape.attitude)
    return turn, shape.position + turn @ shape.middle

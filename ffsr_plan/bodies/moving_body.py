"""A body that moves: its shapes, and its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.body_motion import BodyMotion, Drift, Poses, Spin
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, content, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, text
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.scene.shapes.obstacle_shapes import SHAPES, Attitude, Ball, ObstacleShape
from ffsr_plan.scene.shapes.obstacle_tree import bounding_spheres

MOTIONS = (Drift, Spin, Tumble, Track, PoseFunction)
"""Classes of motions."""


@dataclass(frozen=True, eq=False, init=False)
class MovingBody:
    """A rigid body that moves among the obstacles at rest. Bodies do not see one another.

    Attributes:
        shapes: its shapes, placed along its own axes; their origin is its reference point, which of
            a `Tumble` is the centre of mass.
        motion: how it moves.
        position: (3,) of its reference point at time zero, world [m]; zeros where the motion tells
            poses in the world, as `Track` and `PoseFunction` do.
        attitude: (4,) of its axes at time zero (xyzw); the world's where the motion tells it.
        name: by which errors name it.
    """

    word: ClassVar[str] = "moving body"

    shapes: tuple[ObstacleShape, ...]
    motion: BodyMotion
    position: Array
    attitude: Array
    name: str

    def __init__(
        self,
        shapes: Sequence[ObstacleShape],
        motion: BodyMotion,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        name: str = "",
    ) -> None:
        """Check the body.

        Args:
            shapes: `Box`, `Ball`, `Capsule`, `Cylinder`, `Ellipsoid` or `Hull`, along its own axes.
            motion: `Drift`, `Spin`, `Tumble`, `Track` or `PoseFunction`.
            position: (3,) of its reference point at time zero, world [m].
            attitude: of its axes at time zero: (3,) ZYX angles [rad], or (4,) quaternion (xyzw).
            name: by which errors name it.

        Raises:
            InvalidInput: no shapes or motion, or a pose where the motion tells it.
        """
        kinds = ", ".join(each.__name__ for each in SHAPES.values())
        if not isinstance(shapes, (list, tuple)) or not shapes:
            raise InvalidInput("shapes", shapes, f"a list of {kinds}")
        for k, shape in enumerate(shapes):
            if not isinstance(shape, tuple(SHAPES.values())):
                raise InvalidInput(f"shapes.{k}", shape, f"an object of {kinds}")
        if not isinstance(motion, MOTIONS):
            names = ", ".join(each.__name__ for each in MOTIONS)
            raise InvalidInput("motion", motion, f"an object of {names}")
        place = finite_array("position", position, (3,), FARTHEST)
        turn = Attitude().check("attitude", attitude, {})
        if motion.tells_world_poses and (np.any(place != 0.0) or abs(float(turn[3])) < 1.0):
            what = type(motion).__name__
            raise InvalidInput("position", place.tolist(), f"no pose: the {what} tells it")
        object.__setattr__(self, "shapes", tuple(shapes))
        object.__setattr__(self, "motion", motion)
        object.__setattr__(self, "position", frozen(np.array(place)))
        object.__setattr__(self, "attitude", frozen(np.array(turn)))
        object.__setattr__(self, "name", text("name", name))

    def poses(self, times: ArrayLike) -> Poses:
        """Poses in the world.

        Args:
            times: (n,) [s], from zero to `motion.known_until`.

        Raises:
            InvalidInput: a time that the motion does not know.
        """
        given = finite_array("times", times, (-1,))
        if np.any((given < 0.0) | (given > self.motion.known_until)):
            allowed = f"times from 0 to {self.motion.known_until:g} s"
            raise InvalidInput("times", given.tolist(), allowed)
        moved = self.motion.poses(np.asarray(given))
        if self.motion.tells_world_poses:
            return moved
        start = np.tile(self.attitude, (len(given), 1))
        return Poses(self.position + moved.positions, rotations.multiply(start, moved.attitudes))

    def point(self, place: ArrayLike, time: float) -> Array:
        """Where a point that is fixed to it is at a time.

        Args:
            place: (3,) along its own axes [m].
            time: [s].

        Returns:
            (3,) world [m].
        """
        (position,), (turn,) = self.poses([time])
        own = finite_array("place", place, (3,), FARTHEST)
        return np.asarray(position + rotations.matrix(turn) @ own)

    def later(self, time: float) -> MovingBody:
        """The same body from a later instant on.

        Args:
            time: [s], which becomes time zero; its motion is known for longer.

        Raises:
            InvalidInput: a time from which on the motion is not known.
        """
        (place,), (turn,) = self.poses([time])
        if time >= self.motion.known_until:
            raise InvalidInput("time", time, f"less than {self.motion.known_until:g} s")
        motion = self.motion.later(time)
        if motion.tells_world_poses:
            return MovingBody(self.shapes, motion, name=self.name)
        return MovingBody(self.shapes, motion, place, turn, self.name)

    def shapes_at(self, time: float, title: str = "") -> tuple[Any, ...]:
        """Its shapes in the world at a time, named after it.

        Args:
            time: [s].
            title: its name where it has none.

        Returns:
            Shapes of the same classes.
        """
        (place,), (turn,) = self.poses([time])
        axes, own, placed = rotations.matrix(turn), self.name or title, []
        for shape in self.shapes:
            name = f"{own}, {shape.name}" if shape.name else own
            where = {"position": place + axes @ shape.position, "name": name}
            if not isinstance(shape, Ball):
                where["attitude"] = rotations.multiply(turn, shape.attitude)
            placed.append(replace(shape, **where))  # type: ignore[type-var]
        return tuple(placed)

    @cached_property
    def reach(self) -> float:
        """Bound on the distance of its points from the reference point, or from the axis [m]."""
        spheres, axis = bounding_spheres(self.shapes), self.motion.axis
        middles = spheres[:, :3]
        apart = middles if axis is None else np.cross(middles, axis)
        return float(np.max(np.linalg.norm(apart, axis=1) + spheres[:, 3]))

    @property
    def speed(self) -> float:
        """Bound on the speed of any of its points, at any time [m/s]."""
        path, turned = self.motion.speeds
        return path + turned * self.reach

    def travel(self, begin: float, end: float) -> float:
        """Bound on the way of any of its points between two times [m].

        Args:
            begin: [s].
            end: [s].
        """
        return self.motion.path(begin, end) + self.motion.turned(begin, end) * self.reach

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, MovingBody):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> object:
        return content((self.shapes, self.motion, self.position, self.attitude, self.name))

    def __repr__(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        count = counted(len(self.shapes), "shape")
        return f"MovingBody({name}{count}, {type(self.motion).__name__})"

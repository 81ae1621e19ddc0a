"""Distances of a robot to one body that moves, in whose axes its shapes rest."""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.body_motion import Poses
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import BOX

_ASIDE = 1e5  # [m]


def in_axes(placed: Placements, poses: Poses, shifts: Array) -> Placements:
    """Placements in the world, seen in the axes of a body.

    Args:
        placed: K placements.
        poses: of the body, K.
        shifts: (K, 3) displacements of the whole robot, world axes [m].
    """
    turns = rotations.matrix(poses.attitudes)
    frames, count = placed.frames.copy(), placed.frames.shape[1]
    moved = frames[..., 9:12] + (shifts - poses.positions)[:, None]
    frames[..., 9:12] = moved @ turns
    seen = np.swapaxes(turns, 1, 2)[:, None] @ placed.rotations
    frames[..., :9] = seen.reshape(-1, count, 9)
    return Placements(frames)


def moved_aside(placed: Placements, rows: Flags, shapes: Flags) -> Placements:
    """Placements with some shapes so far away that they are never the nearest.

    Args:
        placed: K placements.
        rows: (K,) the placements concerned.
        shapes: (g,) the shapes moved.
    """
    frames = placed.frames.copy()
    frames[np.flatnonzero(rows)[:, None], np.flatnonzero(shapes), 9] += _ASIDE
    return Placements(frames)


class BodyDistances:
    """Distances to a body from placements of the robot, each at its own time."""

    def __init__(
        self, robot: SpaceRobot, query: ObstacleQuery, placed: Placements, poses: Poses
    ) -> None:
        """See the placements in the axes of the body.

        Args:
            robot: the robot.
            query: distances to the body's shapes.
            placed: K placements.
            poses: of the body at the times of the placements, K.
        """
        self._query = query
        self._seen = in_axes(placed, poses, np.zeros((len(poses.positions), 3)))
        self._turns = rotations.matrix(poses.attitudes)
        shapes = robot.primitives
        around = np.linalg.norm(shapes.sizes, axis=1)
        around = np.where(shapes.kinds == BOX, around, shapes.sizes.sum(axis=1))
        self._middles = self._seen.positions.mean(axis=1) if len(around) else np.zeros((1, 3))
        reaches = np.linalg.norm(self._seen.positions - self._middles[:, None], axis=2) + around
        self._reaches = reaches.max(axis=1, initial=0.0) + query.radius

    def distances(self, rows: IntArray, offsets: Array) -> Array:
        """Distances of displaced placements.

        Args:
            rows: (k,) which of the K.
            offsets: (k, 3) displacements of the robot, world axes [m].

        Returns:
            (k,) distances [m].
        """
        return self._query.distances_at(self._seen, rows, self._shifts(rows, offsets))

    def least(self, rows: IntArray, offsets: Array, others: Array) -> Array:
        """The lesser of these distances and of others, measured only where it may be this one.

        Args:
            rows: (k,) which of the K.
            offsets: (k, 3) displacements of the robot, world axes [m].
            others: (k,) other distances [m].

        Returns:
            (k,) distances [m].
        """
        shifts, found = self._shifts(rows, offsets), np.array(others)
        apart = np.linalg.norm(self._middles[rows] + shifts, axis=1) - self._reaches[rows]
        near = np.flatnonzero(apart < others)
        if len(near):
            measured = self._query.distances_at(self._seen, rows[near], shifts[near])
            found[near] = np.minimum(measured, others[near])
        return found

    def _shifts(self, rows: IntArray, offsets: Array) -> Array:
        """(k, 3) displacements in the axes of the body [m]."""
        return np.asarray((offsets[:, None] @ self._turns[rows])[:, 0])

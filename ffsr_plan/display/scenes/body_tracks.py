"""Bodies that move, at the times of a picture's frames: their poses, and what pictures show."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.scenes.shape_outlines import ROUND, Mesh, joined, mesh_of
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import ObstacleShape

_INSTANTS = 60  # of a track, at most, that decide how much of the world a picture shows
_ROOM = 0.5  # extents of the rest by which bodies make a picture larger, at most
_NEARLY = 1e-4, 1e-3  # [m] and [rad] by which poses between key frames may be off
_CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))


class BodyTrack(NamedTuple):
    """A moving body at the times of N frames.

    Attributes:
        body: the body.
        name: its own, or `body` and its number.
        times: (N,) [s].
        positions: (N, 3) of its reference point, world [m].
        attitudes: (N, 4) of its axes in the world (xyzw).
        box: (2, 3) least and greatest coordinates of its shapes along its axes [m].
    """

    body: MovingBody
    name: str
    times: Array
    positions: Array
    attitudes: Array
    box: Array

    def points(self, local: Array) -> Array:
        """(N, k, 3) points (k, 3) of the body along its axes [m], in the world."""
        turned = local @ np.swapaxes(rotations.matrix(self.attitudes), 1, 2)
        return turned + self.positions[:, None]

    def middles(self) -> Array:
        """(N, 3) middle of its shapes in the world [m]."""
        return self.points(self.box.mean(axis=0)[None])[:, 0]

    def corners(self) -> Array:
        """(N, 8, 3) corners of the box around its shapes, in the world [m]."""
        return self.points(self.box[0] + _CORNERS * (self.box[1] - self.box[0]))

    def shapes(self, row: int) -> tuple[ObstacleShape, ...]:
        """Its shapes in the world in one frame."""
        return self.body.shapes_at(float(self.times[row]), self.name)

    @property
    def moves_away(self) -> bool:
        """Whether its middle goes farther than it is wide."""
        way = np.ptp(self.middles(), axis=0)
        return float(np.linalg.norm(way)) > 0.5 * float(np.linalg.norm(np.ptp(self.box, axis=0)))


def body_tracks(scene: Scene, times: Array | None) -> list[BodyTrack]:
    """The moving bodies of a scene at the times of frames.

    All pictures of scenes with bodies ask for them, so that none draws a body as if at rest.

    Args:
        scene: the obstacles.
        times: (N,) times of the frames [s]; None if they have none.

    Raises:
        InvalidInput: bodies move and there are no times, or times that a motion does not know.
    """
    if not scene.bodies:
        return []
    if times is None:
        raise InvalidInput("times", None, "a time [s] of each frame, as bodies of the scene move")
    tracks = []
    for k, body in enumerate(scene.bodies):
        poses, vertices = body.poses(times), body_mesh(body, ROUND).vertices
        box = np.stack([vertices.min(axis=0), vertices.max(axis=0)])
        name = body.name or f"body {k}"
        tracks.append(BodyTrack(body, name, np.asarray(times), *poses, box))
    return tracks


def body_mesh(body: MovingBody, rings: int) -> Mesh:
    """The mesh of all shapes of a body along its axes; `rings` as of `mesh_of`."""
    return joined([mesh_of(shape, rings) for shape in body.shapes])


def points_near(tracks: Sequence[BodyTrack], cloud: Array, axes: Array) -> Array:
    """Points of bodies that a picture has to hold: of those that come near all else.

    A body that comes from far away counts only where it is near: a picture of all its way would
    show nothing else.

    Args:
        tracks: the bodies.
        cloud: (n, d) all else that is shown, along the directions of the picture [m].
        axes: (d, 3) these directions.

    Returns:
        (k, d) points [m].
    """
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    room = _ROOM * float(np.max(high - low))
    low, high = low - room, high + room
    found = [np.zeros((0, len(axes)))]
    for track in tracks:
        rows = np.unique(np.linspace(0, len(track.times) - 1, _INSTANTS).round().astype(int))
        corners = track.corners()[rows] @ axes.T
        begins, ends = corners.min(axis=1), corners.max(axis=1)
        near = np.all((ends > low) & (begins < high), axis=1)
        found += [np.clip(bound[near], low, high) for bound in (begins, ends)]
    return np.vstack(found)


def key_rows(values: Array, nearly: float | None = None) -> IntArray:
    """Rows from which a player finds the other frames by interpolation.

    Args:
        values: (N, 3) positions [m], or (N, 4) attitudes (xyzw), in at least two frames.
        nearly: by which the others may be off; 0.1 mm or 1 mrad by default.

    Returns:
        Rising rows, the first and the last among them.
    """
    last, turns = len(values) - 1, values.shape[1] == 4
    most = _NEARLY[turns] if nearly is None else nearly
    stride = 1 << max(last - 1, 0).bit_length()
    while stride > 1:
        rows = np.unique(np.append(np.arange(0, last, stride), last))
        if _largest_error(values, rows) <= most:
            return rows
        stride //= 2
    return np.arange(last + 1)


def _largest_error(values: Array, rows: IntArray) -> float:
    """Largest distance, or angle of attitudes, of all values from those between the rows."""
    frames = np.arange(len(values))
    piece = np.clip(np.searchsorted(rows, frames, side="right") - 1, 0, len(rows) - 2)
    begin, end = values[rows[piece]], values[rows[piece + 1]]
    share = (frames - rows[piece]) / np.diff(rows)[piece]
    if values.shape[1] == 4:
        return float(np.max(rotations.angle_between(rotations.slerp(begin, end, share), values)))
    between = begin + share[:, None] * (end - begin)
    return float(np.max(np.linalg.norm(between - values, axis=1)))

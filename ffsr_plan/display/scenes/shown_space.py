"""The part of the world that a picture in three dimensions shows: the motion and what is near."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.display.scenes.body_tracks import BodyTrack, points_near
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.extents import extents
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace

_ROOM = 0.5  # extents of the motion that are shown of obstacles which reach far beyond it
_NEARBY = 10.0  # [m] from the motion, or an extent of it, in which obstacles are shown as a whole


def shown_space(
    scene: Scene,
    centers: Array,
    radii: Array,
    axes: Array | None = None,
    tracks: Sequence[BodyTrack] = (),
) -> Array:
    """The box in which the motion is seen: a picture of all that is far would show nothing else.

    Args:
        scene: obstacles and zones.
        centers: (..., g, 3) centres of spheres around the robot in the world [m].
        radii: (g,) their radii [m].
        axes: (3, 3) directions of the picture; those of the world without any.
        tracks: bodies that move.

    Returns:
        (2, 3) least and greatest coordinates along the axes [m].
    """
    along = np.eye(3) if axes is None else axes
    places, around = centers @ along.T, radii[:, None]
    ends = np.stack([(places + sign * around).reshape(-1, 3) for sign in (-1.0, 1.0)])
    low, high = ends[0].min(axis=0), ends[1].max(axis=0)
    others, extent = boxes_of(scene, along), float(np.max(high - low))
    nearby, room = max(extent, _NEARBY), _ROOM * extent
    whole = np.all((others[:, 0] > low - nearby) & (others[:, 1] < high + nearby), axis=1)
    touched = np.all((others[:, 1] > low - room) & (others[:, 0] < high + room), axis=1)
    cut = np.clip(others[touched & ~whole], low - room, high + room)
    cloud = np.vstack([low, high, others[whole].reshape(-1, 3), cut.reshape(-1, 3)])
    cloud = np.vstack([cloud, points_near(tracks, cloud, along)])
    return np.stack([cloud.min(axis=0), cloud.max(axis=0)])


def farthest_shown(
    scene: Scene, shown: Array, axes: Array, tracks: Sequence[BodyTrack], debris: Array
) -> float:
    """A bound on how far anything drawn is from the middle of what is shown [m].

    Args:
        scene: obstacles and zones.
        shown: (2, 3) as of `shown_space`.
        axes: (3, 3) directions of the picture.
        tracks: bodies that move.
        debris: (n, 3) the farthest places of debris [m].
    """
    middle, half = shown.mean(axis=0), 0.5 * np.ptp(shown, axis=0)
    ways = [track.corners().reshape(-1, 3) @ axes.T for track in tracks]
    points = np.vstack([boxes_of(scene, axes).reshape(-1, 3), *ways, debris @ axes.T])
    reach = np.max(np.abs(points - middle), axis=0, initial=0.0)
    return 2.0 * float(np.linalg.norm(np.maximum(reach, half)))  # planes go a little farther


def boxes_of(scene: Scene, axes: Array) -> Array:
    """(k, 2, 3) least and greatest coordinates of spheres, shapes and zones that end [m].

    Args:
        scene: obstacles and zones.
        axes: (3, 3) directions of the coordinates.
    """
    places, radii = scene.centers @ axes.T, scene.radii[:, None]
    spheres = np.stack([places - radii, places + radii], axis=1)
    zones = [zone for zone in scene.keep_in if not isinstance(zone, HalfSpace)]
    return np.concatenate([spheres, extents([*scene.shapes, *zones], axes)])

"""Distances of a robot to obstacles that are where they are at the time of each frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.scenes.body_tracks import BodyTrack
from ffsr_plan.display.scenes.picture_data import MotionFrames
from ffsr_plan.scene.scene import Scene


def clearances(frames: MotionFrames, scene: Scene, times: Array | None) -> Array:
    """Least distance of a link to an obstacle in each frame, bodies being where they are then.

    Args:
        frames: poses of the robot's links.
        scene: the obstacles.
        times: (N,) time of each frame [s]; None without bodies.

    Returns:
        (N,) distances [m]; infinite without obstacles.

    Raises:
        InvalidInput: bodies move and there are no times.
    """
    rows = np.arange(len(frames.configurations))
    query = ObstacleQuery(frames.robot, scene.at_rest)
    least = query.distances_at(frames.placements, rows, np.zeros((len(rows), 3)))
    return np.minimum.reduce([least, *body_distances(frames, scene, times)])


def body_distances(frames: MotionFrames, scene: Scene, times: Array | None) -> list[Array]:
    """Least distance of a link to each moving body in each frame.

    Args:
        frames: poses of the robot's links.
        scene: the obstacles.
        times: (N,) time of each frame [s]; None without bodies.

    Returns:
        (N,) distances [m] for each body.

    Raises:
        InvalidInput: bodies move and there are no times.
    """
    if not scene.bodies:
        return []
    if times is None:
        raise InvalidInput("times", None, "a time [s] of each frame, as bodies of the scene move")
    rows, still = np.arange(len(times)), np.zeros((len(times), 3))
    found = []
    for body, own in zip(scene.bodies, scene.body_scenes, strict=True):
        query, poses = ObstacleQuery(frames.robot, own), body.poses(times)
        seen = BodyDistances(frames.robot, query, frames.placements, poses)
        found.append(seen.distances(rows, still))
    return found


def nearest_passes(
    frames: MotionFrames, scene: Scene, tracks: list[BodyTrack]
) -> list[dict[str, Any]]:
    """Of each body its name, kind of motion, least distance [m] and the time of it [s].

    Args:
        frames: poses of the robot's links.
        scene: the obstacles, grown as clearances count.
        tracks: the bodies at the times of the frames.
    """
    if not tracks:
        return []
    passes = []
    for track, distances in zip(
        tracks, body_distances(frames, scene, tracks[0].times), strict=True
    ):
        row = int(np.argmin(distances))
        least, time = round(float(distances[row]), 4), round(float(track.times[row]), 4)
        kind = type(track.body.motion).__name__
        passes.append({"name": track.name, "motion": kind, "least": least, "time": time})
    return passes

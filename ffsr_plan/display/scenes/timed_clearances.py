"""Distances of a robot to obstacles that are where they are at the time of each frame."""

from __future__ import annotations

from typing import Any

import numpy as np

from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.debris.debris_distances import DebrisDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.display.scenes.body_tracks import BodyTrack
from ffsr_plan.display.scenes.debris_track import DebrisTrack, debris_track
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
    found = [least, *body_distances(frames, scene, times)]
    if scene.debris:
        found.append(debris_distances(frames, scene, times))
    return np.minimum.reduce(found)


def debris_distances(frames: MotionFrames, scene: Scene, times: Array | None) -> Array:
    """Least distance of a link to debris in each frame.

    Args:
        frames: poses of the robot's links.
        scene: the obstacles, debris among them.
        times: (N,) time of each frame [s].

    Returns:
        (N,) distances [m].

    Raises:
        InvalidInput: there are no times.
    """
    track = debris_track(scene, times)
    rows, far = np.arange(len(track.times)), np.full(len(track.times), np.inf)
    query = DebrisDistances(frames.robot, scene, float(np.mean(track.times)))
    where = rows, np.zeros((len(rows), 3)), track.times
    return query.least(frames.placements, *where, np.zeros(len(rows)), far)


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
    frames: MotionFrames, scene: Scene, tracks: list[BodyTrack], debris: DebrisTrack
) -> list[dict[str, Any]]:
    """Of each body its name, kind of motion, least distance [m] and the time of it [s].

    All debris together is one row.

    Args:
        frames: poses of the robot's links.
        scene: the obstacles, grown as clearances count.
        tracks: the bodies at the times of the frames.
        debris: the debris at these times.
    """
    found = body_distances(frames, scene, debris.times) if tracks else []
    named = [(track.name, type(track.body.motion).__name__) for track in tracks]
    if debris:
        found.append(debris_distances(frames, scene, debris.times))
        named.append((counted(len(debris.radii), "sphere") + " of debris", "Drift"))
    passes = []
    for (name, kind), distances in zip(named, found, strict=True):
        row = int(np.argmin(distances))
        least, time = round(float(distances[row]), 4), round(float(debris.times[row]), 4)
        passes.append({"name": name, "motion": kind, "least": least, "time": time})
    return passes

"""A trajectory at many times: base, end effector, and what a page shows of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.certification.end_effector import drifts
from ffsr_plan.certification.spans import Span
from ffsr_plan.core.arrays import Array, equal_by_content
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.trajectory.trajectory import Trajectory

SAMPLES = 400
"""Usual number of times at which a trajectory is looked at."""
_MOST_SAMPLES = 4000


@equal_by_content
class Samples(NamedTuple):
    """A trajectory at N times.

    Attributes:
        times: (N,) [s].
        configurations: (N, nq), base reaction included.
        turns: (N,) angle by which the base has turned since the start [rad].
        shifts: (N,) distance of the base origin from its start [m].
        drifts: (N,) distance of the end effector from where a base at rest would take it [m].
    """

    times: Array
    configurations: Array
    turns: Array
    shifts: Array
    drifts: Array


class ShownTrajectory(NamedTuple):
    """What a page shows.

    Attributes:
        title: heading.
        subtitle: below it.
        scene: the obstacles.
        trajectory: as it was given.
        spans: as the robot runs it.
        samples: base and end effector along it.
        frame: the end effector.
        proven_clearance: lower bound on the clearance [m].
    """

    title: str
    subtitle: str
    scene: Scene
    trajectory: Trajectory
    spans: Sequence[Span]
    samples: Samples
    frame: str
    proven_clearance: float


def configurations_at(spans: Sequence[Span], times: Array) -> Array:
    """(N, nq) configurations at times (N,) [s] within connected spans."""
    begins = np.array([span.times[0] for span in spans])
    which = np.maximum(np.searchsorted(begins, times, side="right") - 1, 0)
    found = np.empty((len(times), spans[0].motion.robot.model.nq))
    for k in np.unique(which).tolist():
        rows = which == k
        found[rows] = spans[k].at(times[rows])
    return found


def samples_of(robot: SpaceRobot, spans: Sequence[Span], frame: str) -> Samples:
    """A trajectory at all its times, and at as many between them as make the usual number.

    Args:
        robot: the robot.
        spans: the trajectory.
        frame: the end effector.
    """
    corners: Array = np.unique(np.concatenate([span.times for span in spans]))
    parts = max(1, -(-SAMPLES // (len(corners) - 1)))
    places = np.arange(parts * (len(corners) - 1) + 1) / parts
    times = np.interp(places, np.arange(len(corners)), corners)
    if len(times) > _MOST_SAMPLES:
        times = times[np.linspace(0, len(times) - 1, _MOST_SAMPLES).astype(np.int64)]
    q = configurations_at(spans, times)
    turns = np.asarray(angle_between(q[0, 3:7], q[:, 3:7]))
    shifts = np.asarray(np.linalg.norm(q[:, :3] - q[0, :3], axis=1))
    return Samples(times, q, turns, shifts, drifts(robot, frame, q))

"""Frames of a plan at equal steps: of time where it has one, else of the path parameter."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.display.scenes.picture_data import MotionFrames, motion_frames
from ffsr_plan.plans.plan_data import PlanData


class PlanSamples(NamedTuple):
    """N frames of a plan.

    Attributes:
        parameters: (N,) path parameters.
        times: (N,) [s]; None where the problem has no duration.
        frames: poses of the robot's links.
    """

    parameters: Array
    times: Array | None
    frames: MotionFrames


def sample_plan(plan: PlanData, count: int) -> PlanSamples:
    """A plan in `count` frames, at least two, from start to goal.

    Args:
        plan: the plan.
        count: number of frames, at equal steps of time where the problem has a duration.
    """
    pace = plan.problem.pace(plan.motion.edges)
    shares = np.linspace(0.0, 1.0, count)
    times = None
    if pace is not None:
        times = shares * pace.duration
        shares = np.clip(pace.places(times) / pace.edges, 0.0, 1.0)
    return PlanSamples(shares, times, motion_frames(plan.problem.robot, plan.at(shares)))


def times_of(plan: PlanData, parameters: Array) -> Array | None:
    """Times [s] at path parameters (N,); None where the problem has no duration.

    Args:
        plan: the plan.
        parameters: from 0 to 1.
    """
    pace = plan.problem.pace(plan.motion.edges)
    return None if pace is None else pace.instants(parameters * pace.edges)

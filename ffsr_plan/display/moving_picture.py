"""Animated GIF of a plan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import ffsr_plan.display.movie_frames as style
from ffsr_plan.core.checks import one_of, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.display.movie_files import write_movie
from ffsr_plan.display.movie_frames import (
    ASPECTS,
    BYTES_PER_PIXEL,
    PANEL,
    MovingScene,
    PanelCurve,
    Words,
    fixed_colours,
    pictures,
    robot_outlines,
)
from ffsr_plan.display.scenes.picture_data import trail_segments
from ffsr_plan.display.scenes.plan_samples import PlanSamples, sample_plan
from ffsr_plan.display.scenes.projection import SHAPES, VIEWS, view_axes
from ffsr_plan.display.scenes.timed_clearances import clearances

if TYPE_CHECKING:
    from ffsr_plan.core.arrays import Array
    from ffsr_plan.plans.plan_data import PlanData

_FRAME_TIME = 80  # duration of a frame [ms]
_CLOCK = 0.13  # widths of the curve that the time takes


def write_gif(
    plan: PlanData,
    path: str | Path,
    *,
    frames: int = 60,
    width: int = 720,
    view: str = "path",
    shapes: str = "visual",
) -> None:
    """Write a plan as an animated GIF that repeats for ever.

    It shows the robot, its obstacles, the ants' trails and the tracks of base and arm tips. A panel
    below holds a close-up with the rotation of the base, and the clearance. If all obstacles lie in
    the plane of the motion, a ring around each of them marks the proven clearance: no point of the
    robot ever enters it. Of shapes it is around where that plane cuts them. Where the problem has a
    duration, bodies move with the robot, and the time is written.

    Args:
        plan: the plan.
        path: file to write, `.gif`; an existing one is replaced.
        frames: number of pictures, at equal steps of the path parameter, or of time where the
            problem has a duration.
        width: of the picture [px].
        view: `path`, seen along the normal y' of the path frame, or `side`, along the lateral x'.
        shapes: of the robot, `visual` or `collision`; of meshes their convex outlines are drawn.

    Raises:
        InvalidInput: an argument that is not allowed, or a file that cannot be written.
    """
    target = checked_path("path", path, ".gif")
    count = whole_number("frames", frames, at_least=2, at_most=600)
    pixels = whole_number("width", width, at_least=300, at_most=4000)
    size = {"frames": count, "pixels": pixels * round(ASPECTS[1] * pixels + PANEL)}
    check_memory("frames", size, BYTES_PER_PIXEL, "fewer frames or a smaller width")
    rows = list(VIEWS[one_of("view", view, tuple(VIEWS))])
    scene = _scene(plan, count, view_axes(plan.problem)[rows], one_of("shapes", shapes, SHAPES))
    colours = fixed_colours(plan.problem, shapes)
    write_movie(target, pictures(scene, pixels), _FRAME_TIME, colours)


def _scene(plan: PlanData, count: int, axes: Array, shapes: str) -> MovingScene:
    """Everything that `count` frames show, seen along the view axes (3, 3)."""
    problem, least = plan.problem, plan.certificate.least_clearance
    samples = sample_plan(plan, count)
    frames, found = samples.frames, clearances(samples.frames, problem.obstacles, samples.times)
    levels = [(0.0, style.CONTACT), (least, style.CLEARANCE)]
    return MovingScene(
        problem=problem,
        title=f"{problem.robot.name}, {problem.mode}",
        frames=frames,
        axes=axes,
        robot=robot_outlines(frames, axes, shapes),
        curves=[PanelCurve(found, levels, style.CLEARANCE)],
        words=_words(plan, samples, found),
        trails=trail_segments(plan),
        ring=least if np.isfinite(least) else None,
        times=samples.times,
    )


def _words(plan: PlanData, samples: PlanSamples, found: Array) -> list[list[Words]]:
    """Rotation of the base and clearance in each frame; the time, if it has one."""
    attitudes, times = samples.frames.configurations[:, 3:7], samples.times
    by_arms = " by the arms" if plan.problem.mode.attitude_reacts and times is None else ""
    least = proven(plan.certificate.least_clearance)
    after = 0.0 if times is None else _CLOCK
    words = []
    for k, (attitude, clearance) in enumerate(zip(attitudes, found, strict=True)):
        rotation = float(np.degrees(angle_between(attitudes[0], attitude)))
        row = [Words(after, f"base rotated {rotation:.1f}°{by_arms}", style.ATTITUDE)]
        if np.isfinite(clearance):
            row.append(Words(0.46, f"clearance {clearance:.2f} m", style.STRONG))
            row.append(Words(0.74, f"proven ≥ {least}", style.CLEARANCE))
        if times is not None:
            digits = 1 if times[-1] < 100.0 else 0
            row.append(Words(0.0, f"{times[k]:.{digits}f} s", style.STRONG))
        words.append(row)
    return words

"""Page that plays a trajectory in its true time, the reaction of the base included."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.display.motion_page import (
    BYTES_PER_POSE,
    LARGEST_TURN,
    PlayedMotion,
    motion_page,
    time_axis,
)
from ffsr_plan.display.scenes.picture_data import Curve, MotionFrames, Quantity, motion_frames
from ffsr_plan.display.scenes.timed_clearances import clearances
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

if TYPE_CHECKING:
    from ffsr_plan.certification.trajectory_report import TrajectoryReport

_FRAMES, _MOST_FRAMES = 400, 4000
_LEAST_TRAVEL = 1e-9  # [rad or m] below which a joint does not move


class _Shown(NamedTuple):
    """What the page shows; see `ShownProblem`."""

    robot: SpaceRobot
    scene: Scene
    obstacles: Scene
    base_displacement: Array


def trajectory_page(report: TrajectoryReport, title: str = "") -> str:
    """HTML text of a page that plays a trajectory and needs no network.

    It plots clearance, rotation of the base, drift of the end effector and joints. `#t=3` at the
    end of its address opens it at that time after the start [s]; that of a contact is on the page.

    Args:
        report: what was found of the trajectory.
        title: heading; by default robot and mode.

    Returns:
        The text. Equal reports give equal text.
    """
    robot, scene = report.robot, report.scene
    begin, duration = float(report.trajectory.times[0]), report.trajectory.duration
    times = np.linspace(begin, begin + duration, _frame_count(report))
    size = {"frames": len(times), "joints and bodies": robot.nd + 1 + len(scene.bodies)}
    check_memory("page", size, BYTES_PER_POSE, "a trajectory that turns joints less often")
    frames = motion_frames(robot, report.at(times))
    q = frames.configurations
    shown = _Shown(robot, scene, scene, q[-1, :3] - q[0, :3])
    return motion_page(
        PlayedMotion(
            problem=shown,
            frames=frames,
            axis=time_axis(duration),
            charts=_charts(report, frames, times),
            bound="proven at least",
            title=title or f"{robot.name}, {report.mode}",
            subtitle=report.verdict(),
            times=times,
        )
    )


def _frame_count(report: TrajectoryReport) -> int:
    """The usual number, or more where joints go far between two frames."""
    joints = np.column_stack([np.zeros(report.trajectory.pieces + 1), *_moved(report).values()])
    turned = float(np.abs(np.diff(joints, axis=0)).max(axis=1, initial=0.0).sum())
    return int(min(max(_FRAMES, np.ceil(turned / LARGEST_TURN)), _MOST_FRAMES)) + 1


def _moved(report: TrajectoryReport) -> dict[str, Array]:
    """Values of the joints that move, by name."""
    joints = report.trajectory.joints
    return {n: np.asarray(v) for n, v in joints.items() if np.ptp(v) > _LEAST_TRAVEL}


def _charts(report: TrajectoryReport, frames: MotionFrames, times: Array) -> list[Quantity]:
    """Clearance, rotation of the base, drift of the end effector, and joints."""
    charts = []
    if len(report.scene):
        curve = Curve("clearance", "clearance", clearances(frames, report.scene, times))
        charts.append(Quantity("clearance", "clearance", "m", [curve], [report.proven_clearance]))
    samples = report.samples
    for name, text, unit, values in (
        ("attitude", "rotation of the base", "°", np.degrees(samples.turns)),
        ("drift", f"drift of {report.frame}", "m", samples.drifts),
    ):
        if values.max() > _LEAST_TRAVEL:
            curve = Curve(name, text, np.interp(times, samples.times, values))
            charts.append(Quantity(name, text, unit, [curve], []))
    values = report.robot.joint_values(frames.configurations)
    for slides, name, title, unit in (
        (False, "joints", "joints", "rad"),
        (True, "slides", "sliding joints", "m"),
    ):
        curves = [
            Curve(each, each, values[:, k])
            for k, each in enumerate(report.robot.joint_names)
            if each in _moved(report) and bool(report.robot.prismatic[k]) is slides
        ]
        if curves:
            charts.append(Quantity(name, title, unit, curves, []))
    return charts

"""Page that plays a trajectory in its true time, the reaction of the base included."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.certification.sampled_trajectory import ShownTrajectory, configurations_at
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

_FRAMES, _MOST_FRAMES = 400, 4000
_LEAST_TRAVEL = 1e-9  # [rad or m] below which a joint does not move


class _Problem(NamedTuple):
    """What the page shows; see `ShownProblem`."""

    robot: SpaceRobot
    scene: Scene
    obstacles: Scene
    base_displacement: Array


def trajectory_page(shown: ShownTrajectory) -> str:
    """HTML text of a page that plays a trajectory and needs no network.

    It plots clearance, rotation of the base, drift of the end effector and joints. `#t=3` at the
    end of its address opens it at that time after the start [s]; that of a contact is on the page.

    Args:
        shown: what is shown.

    Returns:
        The text. Equal trajectories give equal text.
    """
    robot, scene = shown.spans[0].motion.robot, shown.scene
    begin, duration = float(shown.trajectory.times[0]), shown.trajectory.duration
    times = np.linspace(begin, begin + duration, _frame_count(shown))
    size = {"frames": len(times), "joints and bodies": robot.nd + 1 + len(scene.bodies)}
    check_memory("page", size, BYTES_PER_POSE, "a trajectory that turns joints less often")
    frames = motion_frames(robot, configurations_at(shown.spans, times))
    q = frames.configurations
    floats = shown.spans[0].motion.mode.floats  # then the base's small way is no direction to view
    way = np.zeros(3) if floats else q[-1, :3] - q[0, :3]
    problem = _Problem(robot, scene, scene, way)
    return motion_page(
        PlayedMotion(
            problem=problem,
            frames=frames,
            axis=time_axis(duration),
            charts=_charts(shown, frames, times),
            bound="proven at least",
            title=shown.title,
            subtitle=shown.subtitle,
            times=times,
        )
    )


def _frame_count(shown: ShownTrajectory) -> int:
    """The usual number, or more where joints go far between two frames."""
    joints = np.column_stack([np.zeros(shown.trajectory.pieces + 1), *_moved(shown).values()])
    turned = float(np.abs(np.diff(joints, axis=0)).max(axis=1, initial=0.0).sum())
    return int(min(max(_FRAMES, np.ceil(turned / LARGEST_TURN)), _MOST_FRAMES)) + 1


def _moved(shown: ShownTrajectory) -> dict[str, Array]:
    """Values of the joints that move, by name."""
    joints = shown.trajectory.joints
    return {n: np.asarray(v) for n, v in joints.items() if np.ptp(v) > _LEAST_TRAVEL}


def _charts(shown: ShownTrajectory, frames: MotionFrames, times: Array) -> list[Quantity]:
    """Clearance, rotation of the base, drift of the end effector, and joints."""
    charts = []
    if len(shown.scene):
        curve = Curve("clearance", "clearance", clearances(frames, shown.scene, times))
        bounds = [shown.proven_clearance] if shown.proven_clearance > 0.0 else []
        charts.append(Quantity("clearance", "clearance", "m", [curve], bounds))
    samples = shown.samples
    for name, text, unit, values in (
        ("attitude", "rotation of the base", "°", np.degrees(samples.turns)),
        ("drift", f"drift of {shown.frame}", "m", samples.drifts),
    ):
        if values.max() > _LEAST_TRAVEL:
            curve = Curve(name, text, np.interp(times, samples.times, values))
            charts.append(Quantity(name, text, unit, [curve], []))
    values = frames.robot.joint_values(frames.configurations)
    for slides, name, title, unit in (
        (False, "joints", "joints", "rad"),
        (True, "slides", "sliding joints", "m"),
    ):
        curves = [
            Curve(each, each, values[:, k])
            for k, each in enumerate(frames.robot.joint_names)
            if each in _moved(shown) and bool(frames.robot.prismatic[k]) is slides
        ]
        if curves:
            charts.append(Quantity(name, title, unit, curves, []))
    return charts

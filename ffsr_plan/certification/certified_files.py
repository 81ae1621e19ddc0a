"""Trajectories in files judged for robots and scenes in files: what the command `certify` does."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.certification.bus_mass import on_bus
from ffsr_plan.certification.judgement import certify
from ffsr_plan.certification.trajectory_report import TrajectoryReport
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.formats.scenes.scene_files import read_scene
from ffsr_plan.formats.trajectory_files import read_trajectory
from ffsr_plan.robots.loading import load_robot
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


class RobotFile(NamedTuple):
    """A robot in a file, and what it is fixed to.

    Attributes:
        urdf: path of a URDF, or name of a bundled robot.
        srdf: path of an SRDF; None without.
        package_dirs: folders of ROS packages.
        locked: joints that are fixed, as texts `name=value` [rad or m].
        base_mass: of a bus that the root link is fixed to [kg]; None without.
        base_inertia: three principal moments of it as a text, by commas [kg m^2]; None for a radius
            of gyration of half a metre.
        visual: whether links without collision shapes take their visual ones.
        balance: whether inertia tensors that no body has are replaced by the nearest that one has.
    """

    urdf: str
    srdf: str | None = None
    package_dirs: Sequence[str] = ()
    locked: Sequence[str] = ()
    base_mass: float | None = None
    base_inertia: str | None = None
    visual: bool = False
    balance: bool = False

    def robot(self) -> SpaceRobot:
        """The robot.

        Raises:
            InvalidInput: what is wrong in the files or options.
        """
        robot = load_robot(
            self.urdf,
            self.package_dirs,
            srdf=self.srdf,
            locked=dict(map(_pair, self.locked)),
            collision="visual" if self.visual else "collision",
            inertia="balance" if self.balance else "exact",
        )
        if self.base_mass is None:
            if self.base_inertia is not None:
                raise InvalidInput("--base-inertia", self.base_inertia, "--base-mass as well")
            return robot
        moments = None
        if self.base_inertia is not None:
            moments = [_number("--base-inertia", each) for each in self.base_inertia.split(",")]
        return on_bus(robot, self.base_mass, moments)


def certify_files(
    trajectory: str | Path,
    robot: RobotFile,
    scene: str | None,
    modes: Sequence[str],
    tolerance: float = 1e-4,
    *,
    interpolation: str | None = None,
    topic: str | None = None,
    frame: str | None = None,
) -> list[TrajectoryReport]:
    """Judge a trajectory in each of several modes.

    Args:
        trajectory: path of the file.
        robot: the robot's file.
        scene: path of the scene's file, or name of a scenario; None for no obstacles.
        modes: see `certify`.
        tolerance: see `certify`.
        interpolation: in place of what the file says.
        topic: of a bag, the only one that is read.
        frame: see `certify`.

    Returns:
        A report for each mode.

    Raises:
        InvalidInput: what is wrong in the files or options.
    """
    given = read_trajectory(trajectory, interpolation, topic)
    obstacles = Scene() if scene is None else read_scene(scene)
    made = robot.robot()
    return [
        certify(made, obstacles, given, mode, frame=frame, tolerance=tolerance) for mode in modes
    ]


def report_rows(report: TrajectoryReport) -> list[tuple[str, str]]:
    """Names and values of a report, for a table."""
    samples, contact, pieces = report.samples, report.contact, report.trajectory.pieces
    yes = "yes, proven" if report.free else "NO: contact" if contact else "not proven"
    rows = [("free", yes), ("verdict", report.verdict())]
    if not report.free:
        rows.append(("proven free before", f"{report.proven_until:.9g} s"))
    if contact is not None:
        rows.append(("contact", f"{contact.time:.9g} s"))
        rows.append(("base turned then", f"{np.degrees(contact.turn):.3f} degrees"))
    rows += [
        ("base turned at the end", f"{np.degrees(report.turn):.3f} degrees"),
        ("base turned at most", f"{np.degrees(report.largest_turn):.3f} degrees"),
        ("base moved at the end", f"{samples.shifts[-1]:.4f} m"),
        (f"drift of {report.frame} at the end", f"{report.drift:.4f} m"),
        ("drift at most", f"{report.largest_drift:.4f} m"),
        ("trajectory", counted(pieces, f"{report.trajectory.interpolation} piece")),
        ("duration", f"{report.trajectory.duration:g} s"),
    ]
    return rows


def report_figures(report: TrajectoryReport) -> dict[str, Any]:
    """A report as JSON has it; lengths in metres, angles in radians, times in seconds."""
    contact = report.contact
    met = None
    if contact is not None:
        link, obstacle, depth, _ = contact.deepest
        deepest = {"time": contact.deepest_time, "link": link, "obstacle": obstacle, "depth": depth}
        met = {**contact._asdict(), "deepest": deepest}
        del met["deepest_time"]
    return {
        "mode": str(report.mode),
        "free": report.free,
        "verdict": report.verdict(),
        "proven_clearance": report.proven_clearance,
        "contact": met,
        "proven_until": report.proven_until,
        "unproven_time": report.unproven_time,
        "base_turn": report.turn,
        "largest_base_turn": report.largest_turn,
        "base_shift": float(report.samples.shifts[-1]),
        "frame": report.frame,
        "drift": report.drift,
        "largest_drift": report.largest_drift,
        "pieces": report.trajectory.pieces,
        "interpolation": report.trajectory.interpolation,
        "duration": report.trajectory.duration,
    }


def _pair(given: str) -> tuple[str, float]:
    """Name and value of a locked joint."""
    name, sign, value = given.rpartition("=")
    if not sign or not name.strip():
        raise InvalidInput("--lock", given, "a joint and its value, such as finger=0.04")
    return name.strip(), _number("--lock", value)


def _number(what: str, given: str) -> float:
    try:
        return float(given)
    except ValueError:
        raise InvalidInput(what, given, "a finite number") from None

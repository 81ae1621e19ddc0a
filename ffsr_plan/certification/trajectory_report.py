"""`TrajectoryReport`: what is proven of a trajectory, or where it first touches something."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.certification.sampled_trajectory import (
    Samples,
    ShownTrajectory,
    configurations_at,
)
from ffsr_plan.certification.spans import Span
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array, text
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.contacts import TOUCHING, Contact, encounter
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.text_files import write_text
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.trajectory.trajectory import Trajectory

_SHOWN = 1e6  # times are shown in units of 1 / _SHOWN s


class TrajectoryContact(NamedTuple):
    """The first contact that was found on a trajectory; see `TrajectoryReport.proven_until`.

    Attributes:
        time: at which something touches, and did not 1e-6 s before, unless it is the first time or
            a piece lasts longer than 1e9 s [s].
        link: name of the link.
        obstacle: number of the obstacle in the scene, or name of the other link.
        name: of the obstacle, as messages have it.
        turn: angle by which the base has turned since the start [rad].
        deepest_time: time from then on at which something is deepest, of those sampled [s].
        deepest: the link and the obstacle, and the depth [m].
    """

    time: float
    link: str
    obstacle: int | str | None
    name: str
    turn: float
    deepest_time: float
    deepest: Contact


@dataclass(frozen=True, eq=False)
class TrajectoryReport:
    """What `certify` found.

    Attributes:
        robot: the robot.
        scene: the obstacles.
        trajectory: what was judged.
        mode: what actuates the base.
        free: whether all of it is proven free, of obstacles and of other links.
        proven_clearance: lower bound on the distance to any obstacle all along it [m]; 0 where it
            is not free, infinite without obstacles.
        contact: the first contact; None without one.
        proven_until: time before which all is proven free [s]: the last time where all of it is.
            From there to the contact, or to the end without one, nothing was found to touch, and
            distances below the tolerance are neither proven nor refuted.
        frame: the end effector.
        samples: the trajectory at its own times and between them.
        queries: number of configurations at which Coal measured distances.
    """

    robot: SpaceRobot
    scene: Scene
    trajectory: Trajectory
    mode: Mode
    free: bool
    proven_clearance: float
    contact: TrajectoryContact | None
    proven_until: float
    frame: str
    samples: Samples = field(repr=False)
    queries: int
    _spans: Sequence[Span] = field(repr=False)

    @property
    def unproven_time(self) -> float | None:
        """`proven_until` of a trajectory that is neither proven nor refuted, else None [s]."""
        return self.proven_until if not self.free and self.contact is None else None

    @property
    def turn(self) -> float:
        """Angle by which the base has turned at the end [rad]."""
        return float(self.samples.turns[-1])

    @property
    def largest_turn(self) -> float:
        """Greatest angle of the base from its start [rad]."""
        return float(self.samples.turns.max())

    @property
    def drift(self) -> float:
        """Distance of the end effector at the end from where a base at rest would take it [m]."""
        return float(self.samples.drifts[-1])

    @property
    def largest_drift(self) -> float:
        """The greatest such distance at any sampled time [m]."""
        return float(self.samples.drifts.max())

    def verdict(self) -> str:
        """The answer in one sentence."""
        if self.free:
            least = "there are no obstacles"
            if np.isfinite(self.proven_clearance):
                least = f"the clearance is at least {proven(self.proven_clearance)}"
            return f"proven free: {least}"
        if self.contact is not None:
            c = self.contact
            text = f"in contact at {c.time:.6f} s: link '{c.link}' touches {c.name}"
            text += f", with the base turned by {np.degrees(c.turn):.3g} degrees"
            link, obstacle, depth, source = c.deepest
            if depth > TOUCHING:
                met = encounter(-depth, obstacle, source)
                text += f"; deepest at {c.deepest_time:.4g} s, where link '{link}' {met}"
            return text + self._before()
        return (
            f"not proven: near {self.proven_until:.6f} s the distance is below the tolerance, "
            "although nothing was found to touch"
        )

    def _before(self) -> str:
        """What is proven of the time before the contact, as the end of a sentence."""
        first, until = float(self.trajectory.times[0]), self.proven_until
        found = first if self.contact is None else self.contact.time
        if found <= first:
            return ""
        text = f"; proven free before {np.floor(until * _SHOWN) / _SHOWN:.6f} s"
        if found - until > 2.0 / _SHOWN:
            text += " and undecided from there to the contact, with distances below the tolerance"
        return text

    def at(self, times: ArrayLike) -> Array:
        """Configurations at times, base reaction included.

        Args:
            times: (N,) between the first and the last time of the trajectory [s].

        Returns:
            (N, nq) base pose in the world [m, quaternion xyzw] and joints.

        Raises:
            InvalidInput: not finite, or outside of the trajectory.
        """
        asked = finite_array("times", times, (-1,))
        begin, end = self.trajectory.times[[0, -1]].tolist()
        if np.any((asked < begin) | (asked > end)):
            raise InvalidInput("times", times, f"times from {begin:g} to {end:g} s")
        return configurations_at(self._spans, asked)

    def with_base(self) -> Trajectory:
        """The trajectory with the base poses at its times, for formats that hold them.

        Joints, velocities and interpolation are those that were given. A trajectory that is read
        from such a file starts where this one does; its attitudes are given at the times alone.
        """
        given = self.trajectory
        q = self.at(given.times)
        return Trajectory(
            given.times,
            given.joints,
            velocities=given.velocities,
            base_positions=q[:, :3],
            base_velocities=None if self.mode.floats else given.base_velocities,
            base_attitudes=q[:, 3:7],
            interpolation=given.interpolation,
            source=given.source,
        )

    def write_html(self, path: str | Path, title: str = "") -> None:
        """Write a page that plays the trajectory in true time, and needs no network.

        Args:
            path: the file, replaced if it exists; it ends in `.html`.
            title: heading; by default robot and mode.

        Raises:
            InvalidInput: a file that cannot be written.
        """
        target = checked_path("path", path, ".html")
        heading = text("title", title) or f"{self.robot.name}, {self.mode}"
        shown = ShownTrajectory(
            heading, self.verdict(), self.scene, self.trajectory, self._spans, self.samples,
            self.frame, self.proven_clearance,
        )  # fmt: skip
        from ffsr_plan.certification.trajectory_page import trajectory_page

        write_text("path", target, trajectory_page(shown))

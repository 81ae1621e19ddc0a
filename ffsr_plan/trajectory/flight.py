"""`Flight`: what every motion with a time law offers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array, number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.csv_tables import BYTES_PER_CELL, trajectory_table, write_csv

_MOST_ROWS = 1_000_000


class Flight(ABC):
    """A motion with a time law."""

    @property
    @abstractmethod
    def robot(self) -> SpaceRobot:
        """The robot."""

    @property
    @abstractmethod
    def mode(self) -> Mode:
        """What actuates the base."""

    @property
    @abstractmethod
    def duration(self) -> float:
        """Duration of the flight [s]."""

    @abstractmethod
    def at(self, times: ArrayLike) -> States:
        """Configurations, velocities, accelerations, thrust and torques at times (N,) [s]."""

    def clock(self, rate: float) -> Array:
        """Equally spaced times 0, 1 / rate, 2 / rate, ..., and the end.

        Args:
            rate: number of times per second [1/s].

        Returns:
            (N,) times [s].

        Raises:
            InvalidInput: a rate that is not positive, or more than a million times.
        """
        rate = number("rate", rate, above=0.0, at_most=_MOST_ROWS / self.duration)
        count = int(np.ceil(self.duration * rate * (1.0 - 1e-12)))
        return np.append(np.arange(count) / rate, self.duration)

    def to_csv(self, path: str | Path, rate: float) -> None:
        """Write the trajectory as a table with one row for each time and units in the header.

        The columns are time, path parameter, base pose, base velocity and acceleration (linear in
        world axes, angular in base axes), joints, thrust, wheels and torques. The states are those
        of `at`, without pulses. An existing file is replaced.

        Args:
            path: of the file.
            rate: rows per second [1/s]; the last row is the end.

        Raises:
            InvalidInput: a file that cannot be written, or a rate that is not possible.
        """
        target, times = checked_path("path", path), self.clock(rate)
        size = {"rows": len(times), "columns": 30 + 5 * self.robot.nd}
        check_memory("rate", size, BYTES_PER_CELL, "a lower rate")
        write_csv(target, trajectory_table(self.robot, times, self.at(times)))

    def _instants(self, times: ArrayLike) -> Array:
        """(N,) times within the flight, checked."""
        instants = finite_array("times", times, (-1,))
        if instants.size == 0 or np.any((instants < 0.0) | (instants > self.duration)):
            allowed = f"at least one time, all from 0 to {self.duration!r} s"
            raise InvalidInput("times", times, allowed)
        return instants

"""What the verification of a flight asks of it."""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits


class FlownFlight(Protocol):
    """A flight with the problem that it solves; see `SmoothFlight` and `TimedPlan`."""

    limits: FlightLimits
    pulse_times: Array
    pulse_durations: Array
    pulses: Array
    corner_cut: float

    @property
    def problem(self) -> Problem:
        """Robot, obstacles, start and goal."""

    @property
    def duration(self) -> float:
        """Duration [s]."""

    @property
    def switch_times(self) -> Array:
        """(K + 1,) times between which the acceleration does not jump [s]."""

    def at(self, times: ArrayLike) -> States:
        """The states at times (N,) [s]."""

    def pulse_accelerations(self, times: ArrayLike) -> Array:
        """(N, 3) acceleration of the base by pulses, world axes [m/s^2]."""

"""`Flown`: what the verification asks of a flight."""

from __future__ import annotations

from typing import Protocol

from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.meetings.departure import Departure
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits


class Flown(Protocol):
    """A flight of either kind; see `SmoothFlight` and `TimedPlan`."""

    @property
    def problem(self) -> Problem:
        """Robot, obstacles, start and goal."""

    @property
    def limits(self) -> FlightLimits:
        """Limits that it is to keep."""

    @property
    def duration(self) -> float:
        """Duration [s]."""

    @property
    def delta_v(self) -> float:
        """Velocity change that the thrusters produce in translation [m/s]."""

    @property
    def switch_times(self) -> Array:
        """(K + 1,) times between which it is smooth [s]."""

    @property
    def pulse_times(self) -> Array:
        """(p,) middles of the pulses [s]."""

    @property
    def pulse_durations(self) -> Array:
        """(p,) durations of the pulses [s]."""

    @property
    def pulses(self) -> Array:
        """(p, 3) changes of the base's velocity by pulses, world axes [m/s]."""

    @property
    def corner_cut(self) -> float:
        """Largest displacement by pulses [m]."""

    @property
    def meeting(self) -> Meeting | None:
        """What it arrives with, and when; None for a rest."""

    @property
    def departure(self) -> Departure | None:
        """The state that it begins in; None for a rest."""

    def at(self, times: ArrayLike) -> States:
        """States at times (N,) [s], without pulses."""

    def pulse_accelerations(self, times: ArrayLike) -> Array:
        """(N, 3) acceleration by pulses at times (N,), world axes [m/s^2]."""

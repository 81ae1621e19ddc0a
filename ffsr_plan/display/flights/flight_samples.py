"""Instants of a flight with what its pictures show of them."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.rotations import rotation_vector
from ffsr_plan.display.scenes.picture_data import MotionFrames, motion_frames
from ffsr_plan.display.scenes.timed_clearances import clearances
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits

_ASIDE = 1e-7  # share of the duration between a jump and the instants on its sides
_MOST_SWITCHES = 2000  # of the time law whose both sides are among the instants


class Flight(Protocol):
    """What pictures ask of a flight, with corners or without; see `TimedPlan`."""

    @property
    def duration(self) -> float:
        """Duration [s]."""

    @property
    def delta_v(self) -> float:
        """Velocity change that the thrusters produce in translation [m/s]."""

    @property
    def slip(self) -> float:
        """Time by which it may be early or late past bodies that move [s]."""

    @property
    def rests(self) -> Array:
        """(k,) times of rests on the way [s]."""

    @property
    def switch_times(self) -> Array:
        """(K + 1,) times between which the acceleration does not jump [s]."""

    def at(self, times: ArrayLike) -> States:
        """The states at times (N,) [s]."""

    def pulse_accelerations(self, times: ArrayLike) -> Array:
        """(N, 3) acceleration of the base by pulses [m/s^2]."""


class FlownProblem(NamedTuple):
    """A flight and what it flies through.

    Attributes:
        problem: robot, obstacles, start and goal.
        limits: those that the flight keeps.
        flight: the flight.
    """

    problem: Problem
    limits: FlightLimits
    flight: Flight

    def heading(self) -> str:
        """Robot and mode."""
        return f"{self.problem.robot.name}, {self.problem.mode}"

    def summary(self) -> str:
        """Duration, delta-v and rests; where bodies move, by how much it may miss its times."""
        words = f"{self.flight.duration:.4g} s"
        if self.problem.mode.has_thrusters:
            words += f", Δv {self.flight.delta_v:.3g} m/s"
        rests = len(self.flight.rests)
        words += f", {rests} rests" if rests > 1 else ", 1 rest" if rests else ""
        if self.problem.scene.moves:
            words += f", free of bodies even {self.flight.slip:.2g} s early or late"
        return words


class FlightSamples(NamedTuple):
    """N instants of a flight.

    Attributes:
        times: (N,) [s].
        states: the states.
        frames: poses of the robot's links.
        speed: (N,) of the base origin [m/s].
        thrust: (N,) force of the thrusters over the robot's mass, pulses included [m/s^2].
        rotation: (N, 3) rotation vector of the base since the start, axes of the base at the start
            [rad]; continuous, so that it may be longer than half a turn.
        clearances: (N,) least distance of a link to an obstacle, to bodies where they are at the
            time [m]; infinite without obstacles.
    """

    times: Array
    states: States
    frames: MotionFrames
    speed: Array
    thrust: Array
    rotation: Array
    clearances: Array


def sample_flight(flown: FlownProblem, times: Array) -> FlightSamples:
    """The flight at times (N,) [s].

    Raises:
        InvalidInput: the flight takes longer than the motion of a body is known.
    """
    problem, flight = flown.problem, flown.flight
    robot = problem.robot
    states = flight.at(times)
    frames = motion_frames(robot, states.configurations)
    mass = sum(body.mass for body in list(robot.model.inertias)[1:])
    push = states.thrust / mass + flight.pulse_accelerations(times)
    return FlightSamples(
        times=times,
        states=states,
        frames=frames,
        speed=np.linalg.norm(states.base_velocity, axis=1),
        thrust=np.linalg.norm(push, axis=1),
        rotation=continuous(rotation_vector(states.attitudes[:1], states.attitudes)),
        clearances=clearances(frames, problem.obstacles, times),
    )


def instants(flight: Flight, count: int) -> Array:
    """Times at which curves of a flight are drawn: equal steps, and both sides of jumps.

    Args:
        flight: the flight.
        count: number of equal steps.

    Returns:
        (N,) times, rising [s].
    """
    steps = np.linspace(0.0, flight.duration, count + 1)
    switches = np.asarray(flight.switch_times)[1:-1]
    if len(switches) > _MOST_SWITCHES:
        return steps
    aside = _ASIDE * flight.duration  # so that rounding does not decide on which side they are
    both = np.clip([switches - aside, switches + aside], 0.0, flight.duration)
    return np.unique(np.concatenate([steps, both.ravel()]))


def continuous(vectors: Array) -> Array:
    """Rotation vectors (N, 3) [rad] that lead to the same attitudes and do not jump by a turn."""
    result = vectors.copy()
    for k in range(1, len(vectors)):
        angle = float(np.linalg.norm(vectors[k]))
        if angle < 1e-9:
            continue
        axis = vectors[k] / angle
        turns = np.round((float(result[k - 1] @ axis) - angle) / (2.0 * np.pi))
        result[k] = (angle + 2.0 * np.pi * turns) * axis
    return result

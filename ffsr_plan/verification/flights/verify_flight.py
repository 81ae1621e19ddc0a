"""`FlightReport`: a flight checked by code of its own: motion, forces, limits, distances.

No code here calls the planner's kinematics, reaction, forces or distances. `flight.at` is sampled;
see `flown_motion`, `flown_forces` and `flown_distances` for what is computed again from it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.contacts import approach
from ffsr_plan.verification.flights.flown_distances import FlownDistances, flown_distances
from ffsr_plan.verification.flights.flown_flight import FlownFlight
from ffsr_plan.verification.flights.flown_forces import (
    ForceErrors,
    LimitUse,
    force_errors,
    limit_uses,
)
from ffsr_plan.verification.flights.flown_motion import MotionErrors, motion_errors
from ffsr_plan.verification.urdf_reading import Bodies

POSITION_LIMIT = 1e-5
"""Allowed error of base position [m], joint values and rates [rad, rad/s, m or m/s]."""
ATTITUDE_LIMIT = 1e-5
"""Allowed error of the attitude [rad]."""
FORCE_LIMIT = 1e-6
"""Allowed error of forces and torques, relative to their peaks."""
EXCESS = 1e-6
"""Share by which a limit may be exceeded, for rounding."""
GOAL_LIMIT = 1e-6
"""Allowed error at start and goal [m or rad]."""
REST_LIMIT = 1e-9
"""Allowed speed at start and goal [m/s or rad/s]."""
SAMPLES = 2_000
"""Equal time steps at which distances are measured by default; more where they are needed."""


@dataclass(frozen=True)
class FlightReport:
    """Result of the `verify()` of a flight.

    Attributes:
        ok: whether there are no problems.
        problems: one sentence for each violated condition.
        not_checked: one sentence for each part of the flight that was not checked.
        position_error: largest distance of the base from where thrust moves it [m].
        attitude_error: largest angle from the attitude by conservation of momentum [rad].
        joint_error: largest difference of joint values from the integral of their velocities
            [rad or m].
        thrust_error: largest error of the thrust, relative to its peak.
        torque_error: largest error of torques of joints and wheels, relative to their peak.
        limits: largest value over each limit by its name, at most 1.
        least_clearance: least measured distance to an obstacle [m]; infinite without any.
        least_self_separation: least measured distance of links that must not touch [m].
        samples: number of configurations whose distances were measured.
    """

    ok: bool
    problems: tuple[str, ...]
    not_checked: tuple[str, ...]
    position_error: float
    attitude_error: float
    joint_error: float
    thrust_error: float
    torque_error: float
    limits: dict[str, float]
    least_clearance: float
    least_self_separation: float
    samples: int


def verify_flight(flight: FlownFlight, samples: int = SAMPLES) -> FlightReport:
    """Verify a flight from its states alone.

    Args:
        flight: the flight.
        samples: least number of equal time steps at which distances are measured.

    Raises:
        InvalidInput: `samples` is not a positive whole number, or too large.
    """
    steps = whole_number("samples", samples, at_least=1, at_most=100_000)
    robot = flight.problem.robot
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    motion, forces = motion_errors(flight, bodies), force_errors(flight)
    uses, distances = limit_uses(flight), flown_distances(flight, bodies, steps)
    problems = (
        *_other_motion(motion),
        *_other_forces(forces),
        *_exceeded(uses),
        *_collisions(flight, distances),
        *_ends(flight),
    )
    clearance, separation = distances.clearance, distances.separation
    return FlightReport(
        ok=not problems,
        problems=problems,
        not_checked=tuple(_not_checked(flight, bodies)),
        position_error=motion.position,
        attitude_error=motion.attitude,
        joint_error=max(motion.joints, motion.rates),
        thrust_error=forces.thrust,
        torque_error=max(forces.torques, forces.wheel_momentum),
        limits={use.name: use.share for use in uses},
        least_clearance=np.inf if clearance is None else clearance.distance,
        least_self_separation=np.inf if separation is None else separation.distance,
        samples=distances.samples,
    )


def _other_motion(errors: MotionErrors) -> Iterator[str]:
    if not errors.position <= POSITION_LIMIT:
        yield f"the base is {errors.position:.3g} m from where its thrust moves it"
    if not errors.attitude <= ATTITUDE_LIMIT:
        yield f"the attitude is {errors.attitude:.3g} rad from that of momentum conservation"
    if not errors.joints <= POSITION_LIMIT:
        yield f"joints are {errors.joints:.3g} rad or m from the integral of their velocities"
    if not errors.rates <= POSITION_LIMIT:
        yield f"joint velocities are {errors.rates:.3g} from the integral of their accelerations"


def _other_forces(errors: ForceErrors) -> Iterator[str]:
    for what, error in zip(("thrust", "torques", "wheel momentum"), errors, strict=True):
        if not error <= FORCE_LIMIT:
            yield f"inverse dynamics gives another {what}: {error:.3g} of the peak"


def _exceeded(uses: list[LimitUse]) -> Iterator[str]:
    for use in uses:
        if not use.share <= 1.0 + EXCESS:
            yield f"{use.name} is exceeded: {use.share:.6g} of the limit at {use.time:.4g} s"


def _collisions(flight: FlownFlight, distances: FlownDistances) -> Iterator[str]:
    near = distances.clearance
    if near is not None and near.distance <= flight.corner_cut:
        pulses = (
            f", and pulses displace it by {flight.corner_cut:.3g} m" if flight.corner_cut else ""
        )
        words = approach(near.distance)
        yield f"link '{near.names[0]}' {words} an obstacle at {near.time:.4g} s{pulses}"
    near = distances.separation
    if near is not None and near.distance <= 0.0:
        yield f"two links touch at {near.time:.4g} s: '{near.names[0]}' and '{near.names[1]}'"


def _ends(flight: FlownFlight) -> Iterator[str]:
    problem = flight.problem
    ends = flight.at([0.0, flight.duration])
    if np.abs(ends.configurations[0] - problem.start).max() > GOAL_LIMIT:
        yield "the flight does not begin at the start"
    missed = ends.configurations[1][7:] - problem.goal[7:]
    if problem.mode.has_thrusters:
        missed = np.append(missed, ends.base_position[1] - problem.goal[:3])
    if np.max(np.abs(missed), initial=0.0) > GOAL_LIMIT:
        yield "the flight does not end at the goal"
    if problem.reach_attitude or problem.mode.has_wheels:
        reached, goal = ends.attitudes[1], problem.goal[3:7]
        chord = min(np.linalg.norm(reached - sign * goal) for sign in (1.0, -1.0))
        if (angle := 4.0 * np.arcsin(0.5 * chord)) > GOAL_LIMIT:
            yield f"the goal's attitude is missed by {angle:.3g} rad"
    for speed, end in zip(np.abs(ends.velocities).max(axis=1), ("begin", "end"), strict=True):
        if speed > REST_LIMIT:
            yield f"the robot does not rest at the {end}"


def _not_checked(flight: FlownFlight, bodies: Bodies) -> Iterator[str]:
    robot = flight.problem.robot
    yield "that nothing touches between samples: their ways were measured, not bounded"
    if len(flight.pulse_times):
        yield "thrust and torques while arms move during a pulse"
    if robot.disabled_pairs:
        pairs = ", ".join(f"{a} and {b}" for a, b in robot.disabled_pairs)
        yield f"pairs of links that the SRDF exempts: {pairs}"
    if bodies.unchecked:
        yield f"links without a shape for collisions: {', '.join(bodies.unchecked)}"


__all__ = ["FlightReport", "verify_flight"]

"""Independent verification of a flight: integrals, inverse dynamics, limits, distances, ends.

Nothing here calls the planner's reaction, dynamics, clearance or timing. The flight's states,
`flight.at`, are taken as they are:

- the joints' rates, integrated by momentum conservation of the URDF's bodies, must give the base's
  attitude and, where it floats, its position; velocities and accelerations must be the derivatives
  that they are said to be (`motion_integrals`);
- Pinocchio's inverse dynamics of these states must give thrust, wheel and joint torques
  (`force_balance`);
- every limit is looked at at a hundred instants of each piece of the time law (`used_limits`);
- distances are measured as along plans, halving intervals until nothing can be hidden between two
  samples (`sweep`). The bounds on speeds behind that are those of the hundred instants.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ffsr_plan.verification.flights.flight_ends import flight_ends
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.flights.flown_course import FlownCourse
from ffsr_plan.verification.flights.force_balance import ForceErrors, force_errors
from ffsr_plan.verification.flights.motion_integrals import MotionErrors, motion_errors, steps_of
from ffsr_plan.verification.flights.used_limits import PER_PIECE, UsedLimits, used_limits
from ffsr_plan.verification.motion_samples import MayTouch
from ffsr_plan.verification.recomputed_objective import AGREEMENT
from ffsr_plan.verification.sweep import CONFIRMED, Swept, sweep
from ffsr_plan.verification.urdf_reading import Bodies
from ffsr_plan.verification.verify import (
    collisions,
    functions_not_checked,
    other_bodies,
    other_motion,
    shapes_not_checked,
)

MOTION_LIMIT = 1e-5
"""Allowed difference of base and joints from their integrals [rad] and [m]."""
RELATIVE_LIMIT = 1e-6
"""Allowed difference of velocities and forces, and excess over limits, relative to the peaks."""
DELTA_V_LIMIT = 1e-3
"""Allowed relative difference of delta-v: |thrust| has kinks where it passes zero."""
_SAMPLES = 2000  # of distances on the whole flight, at least
_FEWEST = 4  # on each piece


@dataclass(frozen=True)
class FlightReport:
    """Result of `flight.verify()`.

    Attributes:
        ok: whether there are no problems.
        problems: one sentence for each violated condition.
        not_checked: one sentence for each part of the flight that was not checked.
        attitude_error: largest angle of the base from its integrated attitude [rad].
        position_error: largest distance of the base origin from its integrated place, in
            `free-floating` from where the centre of mass at rest puts it [m].
        joint_error: largest difference of joint values from the integrals of their rates [rad, m].
        velocity_error: largest difference of velocities from the integrals of accelerations, and of
            the base's angular velocity from what momentum conservation wants, relative to peaks.
        thrust_error: largest difference of the thrust from inverse dynamics, relative to its peak.
        wheel_error: of the moment on the base about the centre of mass, and of the wheels'
            momentum, relative to their peaks; without wheels to the joint torques.
        torque_error: of joint torques, relative to their peak.
        delta_v_error: relative difference of delta-v from the integral of |thrust| / mass.
        limits: largest share in use of each limit that there is, by name; 1 is all of it.
        least_clearance: least distance of a link to an obstacle or to the outside of a zone, over
            all samples of the path [m]; where they overlap, a lower bound.
        clearance_bound: lower bound on it all along the path, between the samples too [m]; pulses
            displace the robot from its path by at most `flight.corner_cut`.
        least_self_separation: least distance of links that must not touch, over all samples [m].
        samples: number of configurations whose distances were computed.
        largest_gap: longest way of any point between two samples that may hide a contact [m]; 0
            where there are none. Such a flight is not ok.
    """

    ok: bool
    problems: tuple[str, ...]
    not_checked: tuple[str, ...]
    attitude_error: float
    position_error: float
    joint_error: float
    velocity_error: float
    thrust_error: float
    wheel_error: float
    torque_error: float
    delta_v_error: float
    limits: dict[str, float]
    least_clearance: float
    clearance_bound: float
    least_self_separation: float
    samples: int
    largest_gap: float


def verify_flight(flight: Flown, clearance: float) -> FlightReport:
    """Verify a flight from its states alone.

    Args:
        flight: the flight.
        clearance: clearance to confirm along its path, infinite without obstacles [m].

    Returns:
        The measured values, the problems found, and what was not checked.

    Raises:
        InvalidInput: a function of a body's motion tells no pose.
        IntegrationError: a tumble of a body that cannot be integrated accurately.
    """
    robot = flight.problem.robot
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    used = used_limits(flight)
    steps = steps_of(flight, bodies, used)
    motion, forces = motion_errors(flight, steps), force_errors(flight, steps)
    course = FlownCourse(flight, bodies, used, clearance)
    swept = sweep(course, bodies, max(_FEWEST, -(-_SAMPLES // course.edges)))
    problems = (
        *_other_integrals(motion, forces),
        *_exceeded(used),
        *flight_ends(flight, steps.inner.velocities, RELATIVE_LIMIT),
        *_pulses(flight, swept),
        *collisions(clearance, swept, "flight", "piece", timed=flight.problem.scene.moves),
        *other_motion(swept),
        *other_bodies(flight.problem, swept),
    )
    figures = (*motion, *forces)
    if not swept.finite or not np.all(np.isfinite(figures)):
        problems += ("some of the figures are not numbers",)
    return FlightReport(
        not problems,
        problems,
        tuple(_not_checked(flight, bodies, course.touching)),
        *figures[:4],
        *forces,
        motion.delta_v,
        limits=used.shares,
        least_clearance=swept.clearance.value if swept.clearance else np.inf,
        clearance_bound=float(swept.clearance_bound),
        least_self_separation=swept.separation.value if swept.separation else np.inf,
        samples=swept.samples,
        largest_gap=max((place.value for place in swept.hidden if place), default=0.0),
    )


def _other_integrals(motion: MotionErrors, forces: ForceErrors) -> Iterator[str]:
    for what, error, unit in (
        ("the base's attitude is not that of its joints' motion", motion.attitude, "rad"),
        ("the base is not where its motion leads", motion.position, "m"),
        ("joints are not where their rates lead", motion.joints, "rad or m"),
    ):
        if error > MOTION_LIMIT:
            yield f"{what}: off by {error:.3g} {unit}"
    for what, error in (
        ("velocities are not the integrals of accelerations", motion.velocities),
        ("thrust is not what the motion needs", forces.thrust),
        ("the moment on the base is not what the motion needs", forces.wheels),
        ("joint torques are not what the motion needs", forces.torques),
    ):
        if error > RELATIVE_LIMIT:
            yield f"{what}: relative error {error:.3g}"
    if motion.delta_v > DELTA_V_LIMIT:
        yield f"delta-v is not the integral of thrust / mass: relative error {motion.delta_v:.3g}"


def _exceeded(used: UsedLimits) -> Iterator[str]:
    for name, share in used.shares.items():
        if share > 1.0 + RELATIVE_LIMIT:
            yield f"{name} is {share:.6g} times its limit"
    if used.beyond > AGREEMENT:
        yield "a joint leaves its limits"


def _pulses(flight: Flown, swept: Swept) -> Iterator[str]:
    """Whether pulses are what they are said to be, and leave the path by less than is clear."""
    sizes = np.linalg.norm(flight.pulses, axis=1)
    cut = float(np.max(sizes * flight.pulse_durations, initial=0.0)) / 8.0
    if abs(cut - flight.corner_cut) > AGREEMENT:
        yield f"pulses leave the path by {cut:.3g} m, not {flight.corner_cut:.3g} m"
    if cut > 0.0 and cut >= swept.clearance_bound:
        free = f"only {swept.clearance_bound:.3g} m are free"
        yield f"pulses leave the path by {cut:.3g} m, but {free}"
    middles = flight.pulse_times[:, None] + flight.pulse_durations[:, None] * [-0.25, 0.25]
    pushes = flight.pulse_accelerations(middles.ravel()).reshape(-1, 2, 3)
    given = pushes * flight.pulse_durations[:, None, None] - flight.pulses[:, None]
    if np.max(np.abs(given), initial=0.0) > RELATIVE_LIMIT * np.max(sizes, initial=0.0):
        yield "pulses do not add up to the changes of velocity that they stand for"


def _not_checked(flight: Flown, bodies: Bodies, touching: MayTouch | None) -> Iterator[str]:
    yield "that no flight within the limits is shorter, or calmer in the same time"
    yield f"limits, and rates that bound the travel, between {PER_PIECE} instants of each piece"
    if flight.problem.scene.excess > 0.0:
        yield "that the spheres cover what they stand for, and by how much they exceed it"
    if touching is not None:
        target, links = flight.departure or flight.meeting, ", ".join(touching.links)
        which = f"{links} to moving body '{target and target.target}', which they may touch"
        when = f"last {flight.duration - touching.since:.3g} s"
        if flight.departure is not None:
            when = f"first {min(touching.until, flight.duration):.3g} s"
        yield f"distances of {which}, in the {when}"
    yield from functions_not_checked(flight.problem)
    yield from shapes_not_checked(flight.problem.robot, bodies)


def clearance_to_confirm(cut: float, obstacles: int) -> float:
    """The clearance [m] that a path without a proof of its own has to keep.

    Args:
        cut: by how much pulses leave it [m].
        obstacles: their number.
    """
    if not obstacles:
        return np.inf
    return cut + 2.0 * CONFIRMED if cut > 0.0 else 0.0


__all__ = ["FlightReport", "clearance_to_confirm", "verify_flight"]

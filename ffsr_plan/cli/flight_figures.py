"""The figures of a timed plan that the command `timed` states."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ffsr_plan.core.arrays import Array
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan

_PEAK_SAMPLES = 10_001  # times at which peaks of a flight are taken


class FlightFigures(NamedTuple):
    """Figures of a timed plan; peaks are over ten thousand instants.

    Attributes:
        duration: [s].
        curve: kind of the smooth curve, see `SmoothPlan`; None along the path itself.
        rests: rests on the way, at corners of the path.
        pulses: pulses of the thrusters at corners.
        largest_pulse: change of velocity [m/s]; None without pulses.
        longest_pulse: [s]; None without pulses.
        corner_cut: by which pulses leave the path at most [m]; None without pulses.
        delta_v: of the translation [m/s].
        straight_delta_v: the same along a straight line in the same time [m/s].
        peak_thrust: [N].
        peak_wheel_torque: (3,) in base axes [N m]; None without wheels.
        peak_wheel_momentum: (3,) in base axes [N m s]; None without wheels.
        peak_joint_torques: by joint name, those that rotate [N m].
        peak_joint_forces: by joint name, those that slide [N].
    """

    duration: float
    curve: str | None
    rests: int
    pulses: int
    largest_pulse: float | None
    longest_pulse: float | None
    corner_cut: float | None
    delta_v: float
    straight_delta_v: float
    peak_thrust: float
    peak_wheel_torque: Array | None
    peak_wheel_momentum: Array | None
    peak_joint_torques: dict[str, float]
    peak_joint_forces: dict[str, float]


def flight_figures(flight: SmoothFlight | TimedPlan) -> FlightFigures:
    """The figures of a timed plan."""
    from ffsr_plan.planning.flights import SmoothFlight

    robot = flight.robot
    smooth = flight if isinstance(flight, SmoothFlight) else None
    times = np.linspace(0.0, flight.duration, _PEAK_SAMPLES)
    states = flight.at(times)
    mass = sum(body.mass for body in list(robot.model.inertias)[1:])
    thrust = states.thrust + mass * flight.pulse_accelerations(times)
    loads = np.max(np.abs(states.torques), axis=0).tolist()
    named = list(zip(robot.joint_names, loads, robot.prismatic, strict=True))
    count, wheels = len(flight.pulses), flight.mode.has_wheels
    return FlightFigures(
        duration=flight.duration,
        curve=smooth.smooth_plan.kind if smooth else None,
        rests=len(flight.rests),
        pulses=count,
        largest_pulse=float(np.max(np.linalg.norm(flight.pulses, axis=1))) if count else None,
        longest_pulse=float(np.max(flight.pulse_durations)) if count else None,
        corner_cut=flight.corner_cut if count else None,
        delta_v=flight.delta_v,
        straight_delta_v=flight.straight_delta_v,
        peak_thrust=float(np.max(np.linalg.norm(thrust, axis=1))),
        peak_wheel_torque=np.max(np.abs(states.wheel_torque), axis=0) if wheels else None,
        peak_wheel_momentum=np.max(np.abs(states.wheel_momentum), axis=0) if wheels else None,
        peak_joint_torques={name: load for name, load, slides in named if not slides},
        peak_joint_forces={name: load for name, load, slides in named if slides},
    )

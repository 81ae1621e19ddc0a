"""Speed, thrust, joint rates, attitude and others of a flight as curves over time."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.display.flights.flight_samples import FlightSamples, FlownProblem
from ffsr_plan.display.scenes.picture_data import Curve, Quantity

QUANTITIES = ("speed", "thrust", "joints", "slides", "attitude", "wheels", "clearance")
"""Names of all quantities, in the order in which they are shown."""
_LEAST_RATE = 1e-9  # [rad/s or m/s] below which a joint does not move
_LEAST_ROTATION = 0.05  # [degrees] below which a component is not shown, if another one is larger
_SMALL = 0.1  # [m/s^2] below which accelerations are written in mm/s^2


def quantities(flown: FlownProblem, samples: FlightSamples) -> list[Quantity]:
    """What can be shown of a flight: thrust only with thrusters, joints only that move, and so on.

    Args:
        flown: the flight and its problem.
        samples: instants of the flight.
    """
    mode, limits = flown.problem.mode, flown.limits
    found = [
        Quantity(
            "speed",
            "speed of the base",
            "m/s",
            [Curve("speed", "speed", samples.speed)],
            _finite(limits.velocity[:1]),
        )
    ]
    if mode.has_thrusters:
        found.append(_thrust(flown, samples))
    prismatic = np.asarray(flown.problem.robot.prismatic, dtype=bool)
    found += _joint_rates(flown, samples, ~prismatic, "joints", "joint rates", "rad/s")
    found += _joint_rates(flown, samples, prismatic, "slides", "sliding joints", "m/s")
    found.append(
        Quantity(
            "attitude",
            "rotation of the base",
            "°",
            _components("rotation", np.degrees(samples.rotation)),
            [],
        )
    )
    if mode.has_wheels:
        momentum = _components("wheels", samples.states.wheel_momentum)
        found.append(Quantity("wheels", "momentum of the wheels", "N m s", momentum, []))
    if np.all(np.isfinite(samples.clearances)):
        clearance = [Curve("clearance", "clearance", samples.clearances)]
        found.append(Quantity("clearance", "clearance", "m", clearance, []))
    return found


def _thrust(flown: FlownProblem, samples: FlightSamples) -> Quantity:
    limit = flown.limits.acceleration[:1]
    small = float(np.max(samples.thrust, initial=0.0)) < _SMALL
    factor, unit = (1e3, "mm/s²") if small else (1.0, "m/s²")
    curve = Curve("thrust", "thrust / mass", factor * samples.thrust)
    return Quantity("thrust", "thrust / mass", unit, [curve], _finite(factor * limit))


def _joint_rates(
    flown: FlownProblem, samples: FlightSamples, kind: Flags, name: str, title: str, unit: str
) -> list[Quantity]:
    """Rates of the joints of a kind (nd,) that move; none if none does."""
    rates = samples.states.joint_velocities
    moves = np.flatnonzero(kind & (np.max(np.abs(rates), axis=0, initial=0.0) > _LEAST_RATE))
    if not len(moves):
        return []
    names = flown.problem.robot.joint_names
    curves = [Curve(names[j], names[j], rates[:, j]) for j in moves]
    limits = _finite(np.unique(flown.limits.velocity[2:][moves]))
    return [Quantity(name, title, unit, curves, limits)]


def _components(name: str, vectors: Array) -> list[Curve]:
    """Those components of vectors (N, 3) that are not nearly zero; all if all are."""
    peaks = np.max(np.abs(vectors), axis=0)
    least = min(_LEAST_ROTATION, 0.01 * float(peaks.max()))
    shown = [k for k in range(3) if peaks[k] > least] or [0, 1, 2]
    return [Curve(f"{name} {'xyz'[k]}", f"about {'xyz'[k]}", vectors[:, k]) for k in shown]


def _finite(limits: Array) -> list[float]:
    return [float(limit) for limit in limits if np.isfinite(limit)]

"""Forces of a flight against Pinocchio's inverse dynamics (recursive Newton-Euler)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.flights.motion_integrals import Steps
from ffsr_plan.verification.motion_samples import base_turns

_LEAST = 1e-12  # [N or N m] scales below count as this much
_SMALL = 1e-6  # share of the other forces below which a peak counts as zero


class ForceErrors(NamedTuple):
    """Differences from inverse dynamics, relative to peaks.

    Attributes:
        thrust: of the force on the base; relative to mass times acceleration without thrusters.
        wheels: of the moment on the base about the centre of mass, and of the wheels' momentum.
        torques: of joint torques and forces.
    """

    thrust: float
    wheels: float
    torques: float


def force_errors(flight: Flown, steps: Steps) -> ForceErrors:
    """Compare the forces of a flight at all nodes of its steps.

    Args:
        flight: the flight.
        steps: its steps.
    """
    states, robot = steps.inner, flight.problem.robot
    wanted, stored = _inverse_dynamics(flight, steps)
    to_world = base_turns(states.configurations)
    thrust = np.einsum("nji,nj->ni", to_world, states.thrust)
    lever = steps.momentum.centers
    moment = states.wheel_torque + np.cross(lever, thrust)
    force = _peak(states.thrust, robot.mass * states.base_acceleration)
    turning = _peak(states.wheel_torque, states.torques[:, ~robot.prismatic])
    turning = max(turning, float(np.max(np.abs(lever))) * force * _SMALL)
    kinds = [np.flatnonzero(robot.prismatic == slides) for slides in (False, True)]
    torques = [
        _largest(states.torques[:, kind] - wanted[:, 6:][:, kind])
        / max(_peak(states.torques[:, kind]), _SMALL * max(force, turning))
        for kind in kinds
        if len(kind)
    ]
    wheels = _largest(moment - wanted[:, 3:6]) / turning
    if flight.problem.mode.has_wheels:
        error = _largest(states.wheel_momentum + np.einsum("nji,nj->ni", to_world, stored))
        wheels = max(wheels, error / _peak(states.wheel_momentum))
    return ForceErrors(_largest(thrust - wanted[:, :3]) / force, wheels, max(torques, default=0.0))


def _inverse_dynamics(flight: Flown, steps: Steps) -> tuple[Array, Array]:
    """(N, 6 + nd) generalised forces, and (N, 3) angular momentum about the centre of mass."""
    import pinocchio as pin

    model = flight.problem.robot.model.copy()
    model.gravity = pin.Motion.Zero()
    data, states = model.createData(), steps.inner
    found, momenta = [], []
    for q, v, a in zip(states.configurations, states.velocities, states.accelerations, strict=True):
        found.append(pin.rnea(model, data, q, v, a).copy())
        momenta.append(pin.computeCentroidalMomentum(model, data, q, v).angular.copy())
    return np.array(found), np.array(momenta)


def _peak(*arrays: Array) -> float:
    """The largest size of any of them, as a scale that errors are divided by."""
    return max(_LEAST, *map(_largest, arrays))


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))

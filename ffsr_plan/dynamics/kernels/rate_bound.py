"""Compiled bound on the base's angular velocity at complex joint values.

Along a straight joint segment the base's angular velocity omega(t) is an analytic function. How
well polynomials approximate it follows from its size for complex t. docs/proof.md, section 9,
derives this bound.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import LinkStates, norm_of
from ffsr_plan.robots.kinematics import Bodies


class Excursions(NamedTuple):
    """Memory for what n links can move by when the joint values leave the middle of a substep.

    Real excursions are taken first, imaginary ones from there. `forth` and `back` are one bound as
    a function of the imaginary excursion s, at s and at -s: their mean bounds its even part.

    Attributes:
        turn: (n,) sum of the real rotations of the joints up to the link [rad].
        twist: (n,) sum of the imaginary rotations [rad].
        real: (n, 2) real displacement of origin and centre of mass [m].
        forth: (n, 2) imaginary displacement of origin and centre of mass [m].
        back: (n, 2) the same at -s [m].
        speeds: (n, 3) angular speed [rad], speeds of origin and centre of mass [m].
    """

    turn: Array
    twist: Array
    real: Array
    forth: Array
    back: Array
    speeds: Array


@kernel
def excursions(count: int) -> Excursions:
    """Memory for `count` links."""
    return Excursions(
        np.zeros(count),
        np.zeros(count),
        np.zeros((count, 2)),
        np.zeros((count, 2)),
        np.zeros((count, 2)),
        np.zeros((count, 3)),
    )


@kernel
def _chord(turn: float) -> float:
    """Norm of exp(a) - 1 for a real rotation by at most `turn` [rad]."""
    return 2.0 * math.sin(0.5 * min(turn, math.pi))


@kernel
def excursions_of_links(
    bodies: Bodies, rates: Array, real: float, imaginary: float, states: LinkStates, out: Excursions
) -> None:
    """How far the links can move, and how fast, while joints leave their present values.

    Args:
        bodies: the links.
        rates: (nd,) joint rates.
        real: largest real time from the present one.
        imaginary: largest imaginary time.
        states: the links at the present values.
        out: filled in.
    """
    for j in range(len(bodies.parents)):
        turn, twist, lever = 0.0, 0.0, norm_of(bodies.levers[j])
        if j > 0:
            p, rate = bodies.parents[j], abs(rates[j - 1])
            x = states.origins[j, 0] - states.origins[p, 0]
            y = states.origins[j, 1] - states.origins[p, 1]
            z = states.origins[j, 2] - states.origins[p, 2]
            length, growth = math.sqrt(x * x + y * y + z * z), math.exp(out.twist[p])
            angular, sliding = (0.0, rate) if bodies.prismatic[j] else (rate, 0.0)
            turn, twist = out.turn[p] + angular * real, out.twist[p] + angular * imaginary
            reach = length + sliding * real
            out.real[j, 0] = out.real[p, 0] + _chord(out.turn[p]) * length + sliding * real
            out.forth[j, 0] = (
                out.forth[p, 0] + (growth - 1.0) * reach + growth * sliding * imaginary
            )
            out.back[j, 0] = (
                out.back[p, 0] + (1.0 / growth - 1.0) * reach - sliding * imaginary / growth
            )
            out.speeds[j, 0] = out.speeds[p, 0] + growth * angular
            out.speeds[j, 1] = (
                out.speeds[p, 1]
                + out.speeds[p, 0] * growth * (reach + sliding * imaginary)
                + growth * sliding
            )
        out.turn[j], out.twist[j], growth = turn, twist, math.exp(twist)
        out.real[j, 1] = out.real[j, 0] + _chord(turn) * lever
        out.forth[j, 1] = out.forth[j, 0] + (growth - 1.0) * lever
        out.back[j, 1] = out.back[j, 0] + (1.0 / growth - 1.0) * lever
        out.speeds[j, 2] = out.speeds[j, 1] + out.speeds[j, 0] * growth * lever


@kernel
def rate_bound(bodies: Bodies, least: float, states: LinkStates, moved: Excursions) -> float:
    """Bound on |omega| at all complex joint values within given excursions.

    Args:
        bodies: the links.
        least: lower bound on the least eigenvalue of the inertia at the present values [kg m^2].
        states: the links at the present values.
        moved: how far they can move.

    Returns:
        The bound [rad]; infinite if the inertia may become singular.
    """
    mass = np.sum(bodies.masses)
    mean_real, mean_forth, mean_back = 0.0, 0.0, 0.0
    for j in range(len(bodies.masses)):
        share = bodies.masses[j] / mass
        mean_real += share * moved.real[j, 1]
        mean_forth += share * moved.forth[j, 1]
        mean_back += share * moved.back[j, 1]
    change, forth, back, momentum, own = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(len(bodies.masses)):
        weight = bodies.masses[j]
        others = 1.0 - 2.0 * weight / mass  # the link counts in the mean too
        spread = 0.5 * (bodies.moments[j, 1] - bodies.moments[j, 0])
        growth, arm = math.exp(2.0 * moved.twist[j]), norm_of(states.arms[j])
        shift = others * moved.real[j, 1] + mean_real
        change += 2.0 * spread * _chord(moved.turn[j]) + weight * (2.0 * arm + shift) * shift
        arm += shift
        shift = others * moved.forth[j, 1] + mean_forth
        forth += spread * (growth - 1.0) + weight * (2.0 * arm + shift) * shift
        momentum += bodies.moments[j, 1] * growth * moved.speeds[j, 0]
        momentum += weight * (arm + shift) * moved.speeds[j, 2]
        shift = others * moved.back[j, 1] + mean_back
        back += spread * (1.0 / growth - 1.0) + weight * (2.0 * arm + shift) * shift
        own += bodies.moments[j, 0]
    remains = max(least - change, own) - 0.5 * (forth + back)
    return momentum / remains if remains > 0.0 else np.inf

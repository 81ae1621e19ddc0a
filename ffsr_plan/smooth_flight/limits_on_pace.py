"""`Demands`: what a pace along a curve demands of each actuator, relative to its limit.

With x = s'^2 and u = s'', a demand is a u + b x: accelerations of joints and of a base that wheels
rotate, torques, and thrust / mass. Velocities demand x itself. Each is divided by its limit, so
that 1 is the most it may be; a velocity by its square, so that slowing a law down by k divides all
of them by k^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.path_dynamics import PathDynamics, Prescribed
from ffsr_plan.smooth_flight.curve_samples import ASKED, PARTS, CurveSamples
from ffsr_plan.smooth_flight.fastest_pace_kernel import HIGHEST, StepLimits
from ffsr_plan.trajectory.flight_limits import FlightLimits


class Demands(NamedTuple):
    """Demands at K points of a curve.

    Attributes:
        highest: (K,) highest x by limits on velocities.
        discs: (K, 2, D, 3) vectors a and b, whose |a u + b x| may be 1.
        lines: (K, 2, L) numbers a and b, whose |a u + b x| may be 1.
    """

    highest: Array
    discs: Array
    lines: Array

    def ceiled(self, highest: float) -> Demands:
        """With no higher x than `highest` anywhere."""
        return self._replace(highest=np.minimum(self.highest, highest))

    def shares(self, u: Array, x: Array) -> Array:
        """Shares of the limits in use.

        Args:
            u: (..., N) s'' at the points [1/s^2].
            x: (..., N) s'^2 at the points [1/s^2].

        Returns:
            (..., N, 1 + D + L) shares, of velocities in the first column, squared.
        """
        at_u, at_x = u[..., None], x[..., None]
        lines = np.abs(self.lines[..., 0, :] * at_u + self.lines[..., 1, :] * at_x)
        discs = self.discs[..., 0, :, :] * at_u[..., None]
        discs += self.discs[..., 1, :, :] * at_x[..., None]
        sizes = np.linalg.norm(discs, axis=-1)
        return np.concatenate([(x / self.highest)[..., None], sizes, lines], axis=-1)

    def by_step(self, points: slice) -> Demands:
        """Those of some points of each step, (S, P, ...); the end of a step is part of it."""
        steps = (len(self.highest) - 1) // PARTS
        chosen = PARTS * np.arange(steps)[:, None] + np.arange(PARTS + 1)[points]
        return Demands(*(each[chosen] for each in self))


def demands(limits: FlightLimits, path: Prescribed, dynamics: PathDynamics, mass: float) -> Demands:
    """Demands of a curve under given limits.

    Args:
        limits: the limits; `velocity_jump` and jerk are not looked at.
        path: K points of the curve.
        dynamics: of the curve there.
        mass: of the robot [kg].

    Returns:
        The demands; without columns of what is not limited or does not move.
    """
    rates = path.rates
    first = np.column_stack(
        [*(np.linalg.norm(each[:, 0], axis=1) for each in (path.base, path.turn)), rates[:, 0]]
    )
    moves = np.max(np.abs(first), axis=0) > 0.0  # a joint at rest may have a limit of zero
    with np.errstate(divide="ignore"):
        speeds = limits.velocity[moves] / np.abs(first[:, moves])
    highest = np.min(speeds**2, axis=1, initial=HIGHEST)
    thrust = dynamics.thrust / (mass * limits.acceleration[0])
    turn = path.turn / limits.acceleration[1]
    discs = np.stack([thrust, turn], axis=2)
    lines = np.concatenate(
        [rates / limits.acceleration[2:], dynamics.torques / limits.torque], axis=2
    )
    used = np.any(discs != 0.0, axis=(0, 1, 3))
    return Demands(highest, discs[:, :, used], lines[:, :, np.any(lines != 0.0, axis=(0, 1))])


def step_limits(samples: CurveSamples, wanted: Demands) -> StepLimits:
    """The demands as limits on u, and on x at the start of a step.

    A demand a u + b x at a point d later in the step, where x is x + 2 d u, is (a + 2 d b) u + b x
    in terms of x at its start: of the same form. So limits are kept at both ends of every step and
    in its middle, by one u.
    """
    points = slice(None, None, PARTS // ASKED)
    asked = wanted.by_step(points)
    lengths = np.diff(samples.ends)
    ahead = np.multiply.outer(lengths, np.linspace(0.0, 1.0, ASKED + 1))

    def from_start(pair: Array) -> tuple[Array, Array]:
        a, b = pair[:, :, 0], pair[:, :, 1]
        return a + 2.0 * ahead.reshape(ahead.shape + (1,) * (b.ndim - 2)) * b, b

    a, b = from_start(asked.discs)
    products = [np.sum(v * w, axis=-1) for v, w in ((a, a), (a, b), (b, b))]
    return StepLimits(
        lengths=lengths,
        ahead=ahead,
        highest=np.ascontiguousarray(asked.highest),
        discs=np.stack(products, axis=-1),
        lines=np.stack(from_start(asked.lines), axis=-1),
        share=np.ones(len(lengths)),
    )

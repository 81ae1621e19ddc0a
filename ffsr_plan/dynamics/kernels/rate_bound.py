"""Compiled bound on the base's angular velocity at complex joint values.

Along a straight joint segment the base's angular velocity omega(t) is an analytic function. How
well polynomials approximate it follows from its size for complex t. docs/proof.md, section 9,
derives this bound.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import norm_of, total_mass

EXCURSION = np.dtype(
    [
        ("turn", np.float64),
        ("twist", np.float64),
        ("real_shift", np.float64, 2),
        ("forth", np.float64, 2),
        ("back", np.float64, 2),
        ("speeds", np.float64, 3),
    ]
)
"""What a link can move by when the joint values leave the middle of a substep.

Real excursions are taken first, imaginary ones from there. `forth` and `back` are one bound as a
function of the imaginary excursion s, at s and at -s: their mean bounds its even part.

    turn        sum of the real rotations of the joints up to the link [rad]
    twist       sum of the imaginary rotations [rad]
    real_shift  (2,) real displacement of origin and centre of mass [m]
    forth       (2,) imaginary displacement of origin and centre of mass [m]
    back        (2,) the same at -s [m]
    speeds      (3,) angular speed [rad], speeds of origin and centre of mass [m]
"""


@kernel
def _chord(turn: float) -> float:
    """Norm of exp(a) - 1 for a real rotation by at most `turn` [rad]."""
    return 2.0 * math.sin(0.5 * min(turn, math.pi))


@kernel
def excursions_of_links(
    bodies: Records, rates: Array, real: float, imaginary: float, links: Records, moved: Records
) -> None:
    """How far the links can move, and how fast, while joints leave their present values.

    Args:
        bodies: (n,) the links, `BODY`.
        rates: (nd,) joint rates.
        real: largest real time from the present one.
        imaginary: largest imaginary time.
        links: (n,) `LINK_STATE` at the present values.
        moved: (n,) `EXCURSION`, filled in.
    """
    excursion_of_link(bodies, 0, 0.0, real, imaginary, links, moved)
    for j in range(1, len(bodies)):
        excursion_of_link(bodies, j, abs(rates[j - 1]), real, imaginary, links, moved)


@kernel
def excursion_of_link(
    bodies: Records,
    j: int,
    speed: float,
    real: float,
    imaginary: float,
    links: Records,
    moved: Records,
) -> None:
    """How far a link can move, and how fast; its parent's excursion is known.

    Args:
        bodies: (n,) the links, `BODY`.
        j: the link.
        speed: bound on the rate of its joint.
        real: largest real excursion of its joint, divided by the speed.
        imaginary: largest imaginary excursion, divided by the speed.
        links: (n,) `LINK_STATE` at the present values.
        moved: (n,) `EXCURSION`, filled in for the link.
    """
    out, turn, twist, lever = moved[j], 0.0, 0.0, norm_of(bodies[j].lever)
    if j > 0:
        above, rate, sliding = moved[bodies[j].parent], 0.0, speed
        if not bodies[j].prismatic:
            rate, sliding = sliding, rate
        begin, end = links[bodies[j].parent].origin, links[j].origin
        x, y, z = end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]
        length, growth = math.sqrt(x * x + y * y + z * z), math.exp(above.twist)
        turn, twist = above.turn + rate * real, above.twist + rate * imaginary
        reach = length + sliding * real
        out.real_shift[0] = above.real_shift[0] + _chord(above.turn) * length + sliding * real
        out.forth[0] = above.forth[0] + (growth - 1.0) * reach + growth * sliding * imaginary
        out.back[0] = above.back[0] + (1.0 / growth - 1.0) * reach - sliding * imaginary / growth
        out.speeds[0] = above.speeds[0] + growth * rate
        out.speeds[1] = (
            above.speeds[1]
            + above.speeds[0] * growth * (reach + sliding * imaginary)
            + growth * sliding
        )
    out.turn, out.twist, growth = turn, twist, math.exp(twist)
    out.real_shift[1] = out.real_shift[0] + _chord(turn) * lever
    out.forth[1] = out.forth[0] + (growth - 1.0) * lever
    out.back[1] = out.back[0] + (1.0 / growth - 1.0) * lever
    out.speeds[2] = out.speeds[1] + out.speeds[0] * growth * lever


@kernel
def rate_bound(bodies: Records, least: float, links: Records, moved: Records) -> float:
    """Bound on |omega| at all complex joint values within given excursions.

    Args:
        bodies: (n,) the links, `BODY`.
        least: lower bound on the least eigenvalue of the inertia at the present values [kg m^2].
        links: (n,) `LINK_STATE` at the present values.
        moved: (n,) `EXCURSION`, how far they can move.

    Returns:
        The bound [rad]; infinite if the inertia may become singular.
    """
    mass = total_mass(bodies)
    mean_real, mean_forth, mean_back = 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        share = bodies[j].mass / mass
        mean_real += share * moved[j].real_shift[1]
        mean_forth += share * moved[j].forth[1]
        mean_back += share * moved[j].back[1]
    change, forth, back, momentum, own = 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        at, weight, moments = moved[j], bodies[j].mass, bodies[j].moments
        others = 1.0 - 2.0 * weight / mass  # the link counts in the mean too
        spread = 0.5 * (moments[1] - moments[0])
        growth, arm = math.exp(2.0 * at.twist), norm_of(links[j].arm)
        shift = others * at.real_shift[1] + mean_real
        change += 2.0 * spread * _chord(at.turn) + weight * (2.0 * arm + shift) * shift
        arm += shift
        shift = others * at.forth[1] + mean_forth
        forth += spread * (growth - 1.0) + weight * (2.0 * arm + shift) * shift
        momentum += moments[1] * growth * at.speeds[0]
        momentum += weight * (arm + shift) * at.speeds[2]
        shift = others * at.back[1] + mean_back
        back += spread * (1.0 / growth - 1.0) + weight * (2.0 * arm + shift) * shift
        own += moments[0]
    remains = max(least - change, own) - 0.5 * (forth + back)
    return momentum / remains if remains > 0.0 else np.inf

"""Compiled travel bound along the pieces of a curve.

As along straight edges (`travel`), with bounds on the rates of joints and base origin and on their
changes; docs/proof.md, section 10. The base origin's own motion is part of the bound.
"""

from __future__ import annotations

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.curves.kernels.pieces import (
    FIRST_JOINT,
    TURN,
    Pieces,
    joints_at,
    largest_base_rates,
    largest_bend,
    largest_rate,
    rate_between,
)
from ffsr_plan.dynamics.kernels.bodies import move_links, norm_of
from ffsr_plan.proof.kernels.link_bounds import bound_curved_links
from ffsr_plan.proof.kernels.travel import BaseBounds, BaseMotion, Scratch, bound_points


@kernel
def bound_curved_travel(
    bodies: Records,
    points: Records,
    pieces: Pieces,
    piece: int,
    begin: float,
    end: float,
    base: BaseMotion,
    quat: Array,
    joints: Array,
    scratch: Scratch,
    travel: Records,
) -> None:
    """The travel bound over an interval of a piece, for a base step of zero.

    Args:
        bodies: (n,) the links, `BODY`.
        points: (P,) of the collision shapes, `HULL_POINT`.
        pieces: the curve.
        piece: which piece.
        begin: start of the interval, in [0, 1].
        end: its end.
        base: what the base does.
        quat: (4,) attitude of the base at the middle (xyzw).
        joints: (4, nd) scratch memory.
        scratch: filled in.
        travel: (P,) records of `TRAVEL`, filled in.
    """
    half, middle, last = 0.5 * (end - begin), 0.5 * (begin + end), pieces.rows.shape[2] - 1
    values, rates, fastest, bends = joints[0], joints[1], joints[2], joints[3]
    joints_at(pieces, piece, middle, values, rates)
    for j in range(len(values)):
        fastest[j] = largest_rate(pieces, piece, begin, end, FIRST_JOINT + j)
        bends[j] = largest_bend(pieces, piece, begin, end, FIRST_JOINT + j)
    move_links(bodies, values, rates, scratch.links)
    bound_curved_links(bodies, values, fastest, bends, half, scratch.links, scratch.bounds)
    turn, now = pieces.rows[piece, TURN], rate_between(pieces, piece, middle, middle, last)
    whole = norm_of(turn)
    for a in range(3):
        scratch.robot[0].rate[a] = now * turn[a]
    turning = BaseBounds(
        whole * largest_rate(pieces, piece, begin, end, last),
        whole * largest_bend(pieces, piece, begin, end, last),
    )
    bound_points(bodies, points, half, base, turning, quat, scratch, travel)
    speed, bend = largest_base_rates(pieces, piece, begin, end)
    for k in range(len(points)):
        for a in range(3):
            travel[k].velocity[a] += rate_between(pieces, piece, middle, middle, a)
        travel[k].speed += speed
        travel[k].curvature += half * half * bend


@kernel
def curved_travels(
    bodies: Records,
    points: Records,
    pieces: Pieces,
    begin: float,
    end: float,
    base: BaseMotion,
    quats: Array,
    joints: Array,
    scratch: Scratch,
    travel: Records,
) -> None:
    """The travel bound over one interval of every piece.

    Args:
        bodies: (n,) the links, `BODY`.
        points: (P,) of the collision shapes, `HULL_POINT`.
        pieces: the curve, m pieces.
        begin: start of the interval, in [0, 1].
        end: its end.
        base: what the base does.
        quats: (m, 4) attitudes of the base at the middles (xyzw).
        joints: (4, nd) scratch memory.
        scratch: filled in.
        travel: (m, P) records of `TRAVEL`, filled in.
    """
    for piece in range(len(travel)):
        bound_curved_travel(
            bodies, points, pieces, piece, begin, end, base, quats[piece], joints, scratch,
            travel[piece],
        )  # fmt: skip

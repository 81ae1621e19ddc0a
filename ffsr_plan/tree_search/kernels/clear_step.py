"""Compiled step along a motion within which nothing comes too close, as far as speeds tell.

The speeds are those of the instant, so that this is no proof: the prover has the last word.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.collision.nearest_obstacle_kernels import nearest_obstacle
from ffsr_plan.collision.shape_gap_kernels import least_gap
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import norm_of
from ffsr_plan.tree_search.kernels.search_arrays import Record, SearchArrays

_BEYOND = 1e-12  # [m] beyond the farthest distance that matters


@kernel
def place_shapes(space: SearchArrays) -> None:
    """Placements of the shapes in base axes and speeds of their cores relative to the base."""
    for g in range(len(space.shapes)):
        shape = space.shapes[g]
        link = space.links[shape.link]
        turn, own, spin = link.rotation, shape.rotation, link.angular
        x = y = z = 0.0
        for b in range(3):
            x += turn[0, b] * shape.position[b]
            y += turn[1, b] * shape.position[b]
            z += turn[2, b] * shape.position[b]
            for a in range(3):
                shape.frame[3 * a + b] = (
                    turn[a, 0] * own[0, b] + turn[a, 1] * own[1, b] + turn[a, 2] * own[2, b]
                )
        shape.frame[9] = link.origin[0] + x
        shape.frame[10] = link.origin[1] + y
        shape.frame[11] = link.origin[2] + z
        shape.velocity[0] = link.linear[0] + spin[1] * z - spin[2] * y
        shape.velocity[1] = link.linear[1] + spin[2] * x - spin[0] * z
        shape.velocity[2] = link.linear[2] + spin[0] * y - spin[1] * x
        shape.speed = norm_of(shape.velocity) + shape.reach * norm_of(spin)


@kernel
def safe_way(room: float, least: float) -> float:
    """The way to the next check [m], ending before the room does, where a check would fail."""
    return max(room - 0.5 * least, least)


@kernel
def put_in_world(space: SearchArrays, g: int, position: Array, turn: Array) -> None:
    """Placement of shape `g` in the world, into `space.frame`.

    Args:
        space: its shapes have been placed.
        g: the shape.
        position: (3,) base origin [m].
        turn: (3, 3) rotation of the base.
    """
    frame, own = space.frame, space.shapes[g].frame
    for a in range(3):
        x, y, z = turn[a, 0], turn[a, 1], turn[a, 2]
        for b in range(3):
            frame[3 * a + b] = x * own[b] + y * own[3 + b] + z * own[6 + b]
        frame[9 + a] = position[a] + x * own[9] + y * own[10] + z * own[11]
        frame[12 + a] = own[12 + a]


@kernel
def world_speed(shape: Record, link: Record, base: Array, rate: Array) -> float:
    """Bound on the speed of a shape's core in the world.

    Args:
        shape: one of `SHAPE`, placed.
        link: the link that carries it.
        base: (3,) velocity of the base origin, base axes [m].
        rate: (3,) angular velocity of the base, base axes [rad].
    """
    x, y, z = shape.frame[9], shape.frame[10], shape.frame[11]
    u = shape.velocity[0] + base[0] + rate[1] * z - rate[2] * y
    v = shape.velocity[1] + base[1] + rate[2] * x - rate[0] * z
    w = shape.velocity[2] + base[2] + rate[0] * y - rate[1] * x
    p, q, r = link.angular[0] + rate[0], link.angular[1] + rate[1], link.angular[2] + rate[2]
    return math.sqrt(u * u + v * v + w * w) + shape.reach * math.sqrt(p * p + q * q + r * r)


@kernel
def obstacle_step(
    space: SearchArrays, position: Array, turn: Array, base: Array, margin: float, step: float
) -> float:
    """At most `step`, so that no shape comes nearer to an obstacle than `margin`; -1 if one is.

    Args:
        space: its shapes have been placed.
        position: (3,) base origin [m].
        turn: (3, 3) rotation of the base.
        base: (3,) velocity of the base origin, base axes [m].
        margin: clearance to keep [m].
        step: wanted, in the unit of time of the edge.
    """
    setup = space.setup[0]
    for g in range(len(space.shapes)):
        shape = space.shapes[g]
        put_in_world(space, g, position, turn)
        speed = world_speed(shape, space.links[shape.link], base, space.robot[0].rate)
        far = margin + speed * step + _BEYOND
        near, row = nearest_obstacle(
            space.tree, shape.kind, space.frame, space.still, far, -1, space.stack, space.bounds
        )
        if row < 0:
            continue
        if near <= margin:
            return -1.0
        if speed > 0.0:
            step = min(step, safe_way(near - margin, setup.least_step) / speed)
    return step


@kernel
def link_step(space: SearchArrays, margin: float, step: float) -> float:
    """At most `step`, so that no two links come nearer than `margin`; -1 if some are.

    Args:
        space: its shapes have been placed.
        margin: distance to keep [m].
        step: wanted, in the unit of time of the edge.
    """
    least = space.setup[0].least_step
    for k in range(len(space.pairs)):
        one, two = space.shapes[space.pairs[k, 0]], space.shapes[space.pairs[k, 1]]
        speed = one.speed + two.speed
        far = margin + speed * step
        x, y, z = (
            one.frame[9] - two.frame[9], one.frame[10] - two.frame[10], one.frame[11] -
            two.frame[11]
        )  # fmt: skip
        skins = one.skin + two.skin
        wide = far + skins + one.reach + two.reach
        if x * x + y * y + z * z >= wide * wide:
            continue
        near = least_gap(one.kind, one.frame, two.kind, two.frame, far)
        if near <= margin:
            return -1.0
        if near < far and speed > 0.0:
            step = min(step, safe_way(near - margin, least) / speed)
    return step


@kernel
def pair_gaps(space: SearchArrays) -> Array:
    """(p,) lower bounds on the distances of all pairs of shapes that have been placed [m]."""
    gaps = np.empty(len(space.pairs))
    for k in range(len(space.pairs)):
        one, two = space.shapes[space.pairs[k, 0]], space.shapes[space.pairs[k, 1]]
        gaps[k] = least_gap(one.kind, one.frame, two.kind, two.frame, math.inf)
    return gaps

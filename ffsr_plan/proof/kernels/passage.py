"""A body that moves past one edge of a course, tabulated for the compiled proof.

Distances are taken in the body's axes, in which its shapes rest; its way counts beside that of the
robot's shapes. Poses and ways are those of the places and intervals that halving comes to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel


class Passage(NamedTuple):
    """One body along one edge; among obstacles at rest all arrays are empty.

    Attributes:
        poses: (P + 1, 12) axes of the body in the world, row by row, and its reference point, at
            the places 0, 1 / P, 2 / P, ... of the edge [m].
        ways: (2 P,) bounds on the way of its points over parts of the edge: part k of n equal ones,
            with n = 1, 2, 4, ... P, is at n + k [m].
        step: (3,) displacement of its reference point over the edge, if both are watched from
            there, which the base's own counts less; else zero [m].
    """

    poses: Array
    ways: Array
    step: Array


def no_passage() -> Passage:
    """Nothing that moves."""
    return Passage(np.zeros((0, 12)), np.zeros(0), np.zeros(3))


@kernel
def is_finest(passage: Passage, length: float) -> bool:
    """Whether no shorter parts of an edge than those of a length are tabulated."""
    last = len(passage.poses) - 1
    return last > 0 and length * last < 1.5


@kernel
def way_over(passage: Passage, begin: float, end: float) -> float:
    """Bound on the way of the body's points over a part of the edge [m]; zero without a body."""
    if len(passage.ways) == 0:
        return 0.0
    parts = 1.0 / (end - begin)
    return passage.ways[round(parts) + round(begin * parts)]


@kernel
def see_from_body(passage: Passage, time: float, shift: Array, frames: Array) -> None:
    """Turn placements in the world into those in the body's axes.

    Args:
        passage: the body.
        time: a tabulated place on the edge.
        shift: (3,) displacement of the placements [m].
        frames: (g, 15) of the shapes, updated.
    """
    pose = passage.poses[round(time * (len(passage.poses) - 1))]
    column = np.empty(3)
    for i in range(len(frames)):
        frame = frames[i]
        for b in range(4):  # three axes, then the position
            for a in range(3):
                column[a] = frame[9 + a] + shift[a] - pose[9 + a] if b == 3 else frame[3 * a + b]
            for a in range(3):
                seen = pose[a] * column[0] + pose[3 + a] * column[1] + pose[6 + a] * column[2]
                frame[9 + a if b == 3 else 3 * a + b] = seen

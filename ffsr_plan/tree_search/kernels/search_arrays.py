"""The arrays that all kernels of the tree search share.

A state is a row of D = 4 + nd coordinates: base position in the world [m], the angle by which
wheels have turned the base [rad], joint values [rad or m]. Coordinates that the mode does not
actuate stay zero. The attitude of the base that belongs to a state is kept beside it.

Robot, scene and settings are few arrays of records: numba compiles each array of an argument anew
at every call.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, Records
from ffsr_plan.scene.shapes.obstacle_tree import ObstacleTree

Record = Any
TURN, JOINTS = 3, 4
"""Column of the angle that wheels have turned the base by, and first column of the joints."""

_MATRIX = (3, 3)
SHAPE = np.dtype(
    [
        ("link", np.int64),
        ("kind", np.int64),
        ("rotation", np.float64, _MATRIX),
        ("position", np.float64, 3),
        ("skin", np.float64),
        ("reach", np.float64),
        ("frame", np.float64, 15),
        ("velocity", np.float64, 3),
        ("speed", np.float64),
    ],
    align=True,
)
"""A collision shape: the distance by which its surface surrounds its core, a box or a segment along
z, and the largest distance of the core from its middle [m]; then rotation, position and size as of
`Placements.frames`, velocity of its middle, and a bound on the speed of its core, all in base axes
and relative to the base."""

SETUP = np.dtype(
    [
        ("reacts", np.bool_),
        ("floats", np.bool_),
        ("axis", np.float64, 3),
        ("anchor", np.float64, 3),
        ("margin", np.float64),
        ("self_margin", np.float64),
        ("least_step", np.float64),
        ("nearness_weight", np.float64),
        ("cap", np.float64),
        ("goal", np.float64, 4),
        ("missed_weight", np.float64),
        ("largest_turn", np.float64),
        ("turn", np.float64, _MATRIX),
        ("center", np.float64, 3),
        ("drift", np.float64, 3),
        ("checks", np.int64),
    ],
    align=True,
)
"""What actuates the base; axis of the wheels' turn, in base axes; centre of mass at the start,
world [m]; clearances that are kept [m]; least travel between two checks [m]; cost of 1 / d at a
station [m^2] and the largest clearance d that counts [m]; the attitude to arrive at and the cost of
missing it [m/rad]; largest joint step of the integration [rad or m]. Then rotation of the base,
centre of mass and its velocity at the configuration at hand, relative to the base, and the number
of configurations checked so far."""


class SearchArrays(NamedTuple):
    """Robot, scene, settings and memory of a search.

    Attributes:
        bodies: (n,) of `BODY`.
        links: (n,) of `LINK_STATE`, at the configuration at hand.
        robot: (1,) of `ROBOT_STATE`, at the configuration at hand.
        joints: (2, nd) joint values there, and their rates.
        shapes: (g,) of `SHAPE`.
        pairs: (p, 2) shapes that must not touch each other.
        tree: the obstacles.
        setup: (1,) of `SETUP`.
        box: (2, D) least and greatest coordinates.
        weights: (2, D) of the coordinates: in the distance of states, and in the length L.
        bars: (k, D + 2) states near which the proof refused an edge, distance within which a larger
            margin is kept, and that margin [m].
        stack: (64,) memory for `nearest_obstacle`.
        bounds: (64,) memory for `nearest_obstacle`.
        frame: (15,) memory for the placement of a shape.
        still: (3,) zeros.
    """

    bodies: Records
    links: Records
    robot: Records
    joints: Array
    shapes: Records
    pairs: IntArray
    tree: ObstacleTree
    setup: Records
    box: Array
    weights: Array
    bars: Array
    stack: NDArray[np.int32]
    bounds: Array
    frame: Array
    still: Array


class Trees(NamedTuple):
    """Tree 0 from the start and tree 1 from the goals.

    Attributes:
        states: (2, N, D) nodes.
        attitudes: (2, N, 4) of the base.
        parents: (2, N) of each node, -1 for a root.
        roots: (R,) nodes of tree 1 that are roots.
        counts: (5,) nodes of both trees, roots of tree 1, meetings, and meetings that failed.
    """

    states: Array
    attitudes: Array
    parents: IntArray
    roots: IntArray
    counts: IntArray

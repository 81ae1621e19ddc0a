"""Random pairs of widened boxes, and their signed distances by other means.

Apart, a bounded least-squares programme over the points of both boxes gives the distance. Where
they overlap, the depth is the least distance of the origin from a face of the hull of all
differences of corners.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.optimize import lsq_linear
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from ffsr_plan.robots.shape_arrays import BOX, ROUND

CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))
RELATIONS = ("apart", "near", "flush", "aligned", "nested", "touching", "flat")


class Widened(NamedTuple):
    """A box that is widened by a radius.

    Attributes:
        turn: (3, 3) axes as columns.
        middle: (3,) [m].
        halves: (3,) half sides [m].
        skin: [m].
    """

    turn: np.ndarray
    middle: np.ndarray
    halves: np.ndarray
    skin: float

    def corners(self):
        """(8, 3) of the box without its skin [m]."""
        return self.middle + (CORNERS * self.halves) @ self.turn.T

    def frame(self):
        """(15,) kind and numbers as a shape of a robot: a box, or a segment with a radius."""
        box = self.skin == 0.0
        size = self.halves if box else [self.skin, self.halves[2], 0.0]
        return (BOX if box else ROUND), np.concatenate([self.turn.ravel(), self.middle, size])

    def solid(self):
        """(16,) row of `ObstacleTree.solids`."""
        return np.concatenate([self.turn.ravel(), self.middle, self.halves, [self.skin]])


def random_widened(rng, kind):
    """A box, capsule or ball of some decimetres near the origin."""
    turn, halves = Rotation.random(random_state=rng).as_matrix(), rng.uniform(0.05, 0.8, 3)
    if kind == "box":
        return Widened(turn, np.zeros(3), halves, 0.0)
    length = halves[2] if kind == "capsule" else 0.0
    return Widened(turn, np.zeros(3), np.array([0.0, 0.0, length]), halves[0])


def random_pair(rng, first, second, relation):
    """Two bodies, the second somewhere near the first, in some relation."""
    one, other = random_widened(rng, first), random_widened(rng, second)
    way = rng.normal(size=3)
    way *= {"apart": 3.0, "near": 1.0, "nested": 0.1}.get(relation, 1.5) / np.linalg.norm(way)
    if relation == "flat" and other.skin == 0.0:
        other = other._replace(halves=other.halves * [1.0, 1.0, 0.0])
    if relation in ("flush", "aligned", "touching"):
        turn = one.turn[:, rng.permutation(3)] if relation == "aligned" else one.turn
        other = other._replace(turn=turn)
    if relation in ("flush", "touching"):
        axis = int(rng.integers(3))
        shift = rng.uniform(-0.2, 0.2, 3)
        gap = 0.0 if relation == "touching" else rng.uniform(0.0, 0.3)
        shift[axis] = one.halves[axis] + other.halves[axis] + one.skin + other.skin + gap
        way = one.turn @ shift
    return one, other._replace(middle=way)


def signed_distance(one, other):
    """Signed distance of two widened boxes [m], by a quadratic programme or by a hull."""
    matrix = np.hstack([one.turn, -other.turn])
    bounds = np.concatenate([one.halves, other.halves])
    free = bounds > 0.0
    between, found = other.middle - one.middle, np.linalg.norm(other.middle - one.middle)
    if np.any(free):
        bound = bounds[free]
        solved = lsq_linear(
            matrix[:, free], between, (-bound, bound), method="bvls", tol=1e-15, max_iter=200
        )
        found = np.linalg.norm(matrix[:, free] @ solved.x - between)
    if found > 1e-9:
        return found - one.skin - other.skin
    differences = (other.corners()[:, None] - one.corners()).reshape(-1, 3)
    if np.linalg.matrix_rank(differences - differences[0], tol=1e-9) < 3:
        return -one.skin - other.skin
    return float(np.max(ConvexHull(differences).equations[:, 3])) - one.skin - other.skin

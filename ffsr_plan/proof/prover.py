"""`Prover`: clearances and proofs along edges of one motion, for any offsets of the base.

An edge runs from one layer to the next; its ends are displaced from the nominal motion by offsets
of one's choice. The lattice asks for its nodes, the refinement for points between them.
"""

from __future__ import annotations

import copy
from itertools import pairwise

import numpy as np

from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import GoalInCollision, NoPath, StartInCollision
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import ROUNDING, Verdict, certify, clearance_bound
from ffsr_plan.scene.scene import Scene

_SLACK = 0.05  # between the clearance proven along a path and the least one met, relative
_ITERATED = 1e-7  # travel [m] for distances that Coal iterates to 1e-8 (`shapes.sharpen`)
_RELATIVE = 4e-9  # and for each metre between the middles of what they are taken between
_STILL = np.zeros(3)


class Prover:
    """Asks Coal, and concludes.

    Attributes:
        speeds: (m,) bound on the distance [m] that any point travels over an edge of each layer
            besides the base's own.
        rounding: travel [m] that is added to every bound.
    """

    def __init__(self, nominal: Motion, scene: Scene, tolerance: float) -> None:
        self._motion, self._tolerance = nominal, tolerance
        self._self = SelfQuery(nominal.robot)
        self._travel, self._steps = EdgeTravel(nominal), nominal.base_steps()
        self._placed: dict[float, Placements] = {}
        self._corners = shape_placements(nominal.robot, nominal.configurations())
        self.speeds = self._travel.speeds
        self._look_among(scene)

    def among(self, scene: Scene) -> Prover:
        """The same motion among other obstacles; what does not depend on them is shared."""
        twin = copy.copy(self)
        twin._look_among(scene)
        return twin

    def _look_among(self, scene: Scene) -> None:
        robot = self._motion.robot
        self._obstacles = ObstacleQuery(robot, scene)
        self.rounding = ROUNDING + self._travel.slack
        if not robot.primitives.exact.all():
            self.rounding += _ITERATED + _RELATIVE * float(np.max(scene.radii, initial=0.0))

    @property
    def queries(self) -> int:
        """Coal queries so far, each over all pairs of one configuration."""
        return self._obstacles.count + self._self.count

    def clearances(self, layers: IntArray, offsets: Array) -> Array:
        """(k,) clearances [m] on layers (k,) at offsets (k, 3)."""
        return self._obstacles.distances_at(self._corners, layers, offsets)

    def base_step(self, layer: int, tail: Array, head: Array) -> Array:
        """(..., 3) what the base origin covers from offsets `tail` to `head` (..., 3) [m]."""
        along: Array = self._steps[layer]
        return along + head - tail

    def certify(self, layer: int, tail: Array, head: Array, ends: tuple[float, float]) -> Verdict:
        """The verdict on the edge from offset `tail` to `head` (3,), clearances `ends` [m]."""
        return certify(_ObstacleEdge(self, layer, tail, head), ends, self._tolerance)

    def least_clearance(self, offsets: Array, clearances: Array) -> float:
        """Proven lower bound on the clearance [m] all along a path whose edges are free.

        Args:
            offsets: (m + 1, 3) of the path's nodes.
            clearances: (m + 1,) at the nodes [m].
        """
        bound = met = float(np.min(clearances))
        for layer, ends in enumerate(pairwise(map(float, clearances))):
            edge = _ObstacleEdge(self, layer, offsets[layer], offsets[layer + 1])
            here, met = clearance_bound(edge, ends, met, _SLACK)
            bound = min(bound, here)
        return max(bound, 0.0)  # no less: the edges have been proven free

    def nearest(self, layer: int, tail: Array, head: Array, time: float) -> Nearest:
        """The nearest link and obstacle at a time on an edge."""
        edge = _ObstacleEdge(self, layer, tail, head)
        return self._obstacles.nearest_at(self.placed(time), layer, edge.offset(time))

    def nearest_links(self, layer: int, time: float) -> Nearest:
        """The nearest two links that must not touch, at a time on an edge."""
        return self._self.nearest(self._posture(layer, time))

    def check_ends(self) -> None:
        """Raise `StartInCollision` or `GoalInCollision`, with link, obstacle and depth."""
        for layer, error in ((0, StartInCollision), (self._motion.edges, GoalInCollision)):
            found = (
                self._obstacles.nearest_at(self._corners, layer, _STILL),
                self.nearest_links(layer, 0.0),
            )
            for near in found:
                if near.distance <= 0.0:
                    raise error(near.link, near.other, -near.distance)

    def check_self_collision(self) -> None:
        """Prove that the arms keep clear of each other on the way; it does not matter where.

        Raises:
            NoPath: with the first edge on which two links come too close.
        """
        for layer, verdict in enumerate(self.self_verdicts()):
            if not verdict.free:
                near = self.nearest_links(layer, verdict.time)
                raise NoPath(layer + 1, (near.link, str(near.other)), self._motion.edges)

    def self_verdicts(self) -> list[Verdict]:
        """(m) whether the links keep clear of each other on each edge."""
        if self._self.empty:
            return [Verdict(True, np.inf, 0.0, 0)] * self._motion.edges
        edges = [_SelfEdge(self, layer) for layer in range(self._motion.edges)]
        starts = [edge.clearance(0.0) for edge in edges]
        starts.append(edges[-1].clearance(1.0))
        return [
            certify(edge, ends, self._tolerance)
            for edge, ends in zip(edges, pairwise(starts), strict=True)
        ]

    def placed(self, time: float) -> Placements:
        """All shapes on every edge of the nominal motion at one time; kept, as halving asks again.

        So do other edges for the times at the same level of halving: those come along.
        """
        if time not in self._placed:
            times = _of_same_level(time)
            edges = self._motion.edges
            q = self._motion.at(np.tile(np.arange(edges), len(times)), np.repeat(times, edges))
            frames = shape_placements(self._motion.robot, q).frames
            parts = frames.reshape(len(times), edges, *frames.shape[1:])
            self._placed |= zip(times.tolist(), map(Placements, parts), strict=True)
        return self._placed[time]

    def _posture(self, layer: int, time: float) -> Array:
        """(nq,) joints at a time on an edge, the base anywhere."""
        begin, end = self._motion.joint_values[[layer, layer + (time > 0.0)]]
        joints = (1.0 - time) * begin + time * end
        return self._motion.robot.assemble(_STILL, rotations.IDENTITY, joints)


def _of_same_level(time: float) -> Array:
    """The dyadic times that halving reaches in as many steps as `time`; beyond 1/16 it alone."""
    for parts in (1, 2, 4, 8, 16):
        if (time * parts).is_integer():
            step = 1.0 / parts
            return np.arange(step, 1.0, 2.0 * step) if parts > 1 else np.array([time])
    return np.array([time])


class _ObstacleEdge:
    """An edge among the obstacles; its parts are the collision shapes."""

    def __init__(self, prover: Prover, layer: int, tail: Array, head: Array) -> None:
        self._prover, self._layer = prover, layer
        self._tail, self._head = tail, head
        self._step = prover.base_step(layer, tail, head)
        self._parts: dict[float, Array] = {}
        self.rounding = prover.rounding
        self.speed = float(np.linalg.norm(self._step) + prover.speeds[layer])

    def offset(self, time: float) -> Array:
        return (1.0 - time) * self._tail + time * self._head

    def clearance(self, time: float) -> float:
        query, placed = self._prover._obstacles, self._prover.placed(time)
        return float(
            query.distances_at(placed, np.array([self._layer]), self.offset(time)[None])[0]
        )

    def parts(self, time: float) -> Array:
        if time not in self._parts:
            query, placed = self._prover._obstacles, self._prover.placed(time)
            self._parts[time] = query.links_at(placed, self._layer, self.offset(time))
        return self._parts[time]

    def travel(self, begin: float, end: float) -> Array:
        return self._prover._travel.bounds(self._layer, begin, end, self._step)


class _SelfEdge:
    """An edge of the joints alone; its parts are the pairs of links that must not touch."""

    def __init__(self, prover: Prover, layer: int) -> None:
        self._prover, self._layer = prover, layer
        self._pairs = prover._self.pairs
        self._parts: dict[float, Array] = {}
        self.rounding = ROUNDING + _ITERATED
        self.speed = 2.0 * float(prover._travel.speeds_in_base[layer])

    def clearance(self, time: float) -> float:
        return self._prover._self.distance(self._prover._posture(self._layer, time))

    def parts(self, time: float) -> Array:
        if time not in self._parts:
            posture = self._prover._posture(self._layer, time)
            self._parts[time] = self._prover._self.distances(posture)
        return self._parts[time]

    def travel(self, begin: float, end: float) -> Array:
        each = self._prover._travel.bounds_in_base(self._layer, begin, end)
        return np.asarray(each[self._pairs].sum(axis=1))

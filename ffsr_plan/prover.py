"""`Prover`: clearances and proofs along edges of one problem, for any offsets of the base.

An edge runs from one layer to the next; its ends are displaced from the nominal motion by offsets
of one's choice. The lattice asks for its nodes, the refinement for points between them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

from ffsr_plan.collision import obstacle_query, self_query
from ffsr_plan.edges import ROUNDING, Verdict, certify, clearance_bound
from ffsr_plan.errors import GoalInCollision, NoPath, StartInCollision
from ffsr_plan.inputs import Array, IntArray, frozen
from ffsr_plan.motion import Motion
from ffsr_plan.travel import swing

_SLACK = 0.05  # between the clearance proven along a path and the least one met, relative


class Prover:
    """Asks Coal, and concludes.

    Attributes:
        swing: bound on the distance [m] that any point travels over an edge besides the base's own.
    """

    def __init__(self, nominal: Motion) -> None:
        problem = nominal.problem
        self._problem, self._motion = problem, nominal
        self._obstacles = obstacle_query(problem.robot, problem.scene)
        self._self = self_query(problem.robot)
        self._corners = nominal.configurations()
        self._between: dict[float, Array] = {}
        values = np.abs(nominal.joint_values)
        divisions = problem.lattice.divisions
        self._speeds = swing(
            problem.robot,
            problem.joint_travel / divisions,
            np.maximum(values[0], values[-1]),
            None if problem.mode == "free-flying" else problem.turn / divisions,
        )
        self.swing = float(np.max(self._speeds.world, initial=0.0))

    @property
    def queries(self) -> int:
        """Coal queries so far, each over all pairs of one configuration."""
        return self._obstacles.count + self._self.count

    def clearances(self, layers: IntArray, offsets: Array) -> Array:
        """(k,) clearances [m] on layers (k,) at offsets (k, 3)."""
        q = self._corners[layers]
        q[:, :3] += offsets
        return self._obstacles.distances(q)

    def base_travel(self, layer: int, tail: Array, head: Array) -> Array:
        """Distance [m] that the base origin covers from offsets `tail` to `head` (..., 3)."""
        along = self._motion.positions[layer + 1] - self._motion.positions[layer]
        return np.asarray(np.linalg.norm(along + head - tail, axis=-1))

    def certify(self, layer: int, tail: Array, head: Array, ends: tuple[float, float]) -> Verdict:
        """The verdict on the edge from offset `tail` to `head` (3,), clearances `ends` [m]."""
        speed = float(self.base_travel(layer, tail, head)) + self.swing
        return certify(self._along(layer, tail, head), ends, speed, self._problem.tolerance)

    def least_clearance(self, offsets: Array, clearances: Array) -> float:
        """Proven lower bound on the clearance [m] all along a path whose edges are free.

        Args:
            offsets: (m + 1, 3) of the path's nodes.
            clearances: (m + 1,) at the nodes [m].
        """
        bound = met = float(np.min(clearances))
        for layer, (first, last) in enumerate(pairwise(map(float, clearances))):
            tail, head = offsets[layer], offsets[layer + 1]
            speed = float(self.base_travel(layer, tail, head)) + self.swing
            along = self._along(layer, tail, head)
            here, met = clearance_bound(along, (first, last), speed, met, _SLACK)
            bound = min(bound, here)
        return bound

    def nearest_obstacle(self, layer: int, tail: Array, head: Array, time: float) -> int | str:
        """The obstacle nearest to the robot at a time on an edge."""
        q = self._at(layer, time).copy()
        q[:3] += (1.0 - time) * tail + time * head
        return self._obstacles.nearest(q).other

    def check_ends(self) -> None:
        """Raise `StartInCollision` or `GoalInCollision`, with link, obstacle and depth."""
        for q, error in (
            (self._corners[0], StartInCollision),
            (self._corners[-1], GoalInCollision),
        ):
            for query in (self._obstacles, self._self):
                if query.distance(q) <= 0.0:
                    near = query.nearest(q)
                    raise error(near.link, near.other, -near.distance)

    def check_self_collision(self) -> None:
        """Prove that the arms keep clear of each other on the way; it does not matter where.

        Raises:
            NoPath: with the first edge on which two links come too close.
        """
        if self._self.empty:
            return
        in_base = self._speeds.in_base
        pairs = self._problem.robot.collision_model.collisionPairs
        speed = max(float(in_base[p.first] + in_base[p.second]) for p in pairs)
        ends = self._self.distances(self._corners)
        for layer in range(len(ends) - 1):
            if ends[layer] + ends[layer + 1] > speed + ROUNDING:
                continue
            verdict = certify(
                partial(self._self_distance, layer),
                (float(ends[layer]), float(ends[layer + 1])),
                speed,
                self._problem.tolerance,
            )
            if not verdict.free:
                near = self._self.nearest(self._at(layer, verdict.time))
                raise NoPath(layer + 1, (near.link, near.other), len(ends) - 1)

    def _along(self, layer: int, tail: Array, head: Array) -> Callable[[float], float]:
        def clearance_at(time: float) -> float:
            q = self._at(layer, time).copy()
            q[:3] += (1.0 - time) * tail + time * head
            return self._obstacles.distance(q)

        return clearance_at

    def _self_distance(self, layer: int, time: float) -> float:
        return self._self.distance(self._at(layer, time))

    def _at(self, layer: int, time: float) -> Array:
        """Nominal configuration on an edge.

        Halving asks for the same few times on all edges: computed for all layers at once, and kept;
        a time that is asked for brings its fellows down to sixteenths along.
        """
        if time not in self._between:
            coarse = np.arange(1, 16) / 16.0
            times = coarse if time in coarse else np.array([time])
            layers, edges = np.arange(len(self._corners) - 1), len(self._corners) - 1
            found = self._motion.at(np.tile(layers, len(times)), np.repeat(times, edges))
            for t, q in zip(times.tolist(), found.reshape(len(times), edges, -1), strict=True):
                self._between[t] = frozen(q)
        at: Array = self._between[time][layer]
        return at

"""Proofs that the links of a robot do not touch one another along a motion."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.coal_measures import ITERATION_ERROR
from ffsr_plan.collision.distances import Nearest, SelfQuery
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.course import course_in_base
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import ROUNDING, Edge, Verdict, certify
from ffsr_plan.proof.motion_edges import SelfCollisionEdge, joint_configuration
from ffsr_plan.time_limit.deadline import Deadline


class LinkProof:
    """Links that must not touch one another, along the edges of one motion, whatever the offsets.

    Attributes:
        queries: number of Coal queries so far.
    """

    def __init__(
        self,
        motion: Motion | CurvedMotion,
        travel: EdgeTravel,
        tolerance: float,
        deadline: Deadline,
    ) -> None:
        """Prepare the proofs.

        Args:
            motion: the motion.
            travel: travel bounds along it.
            tolerance: distance below which an edge may be refused [m].
            deadline: after which measurements raise `OutOfTime`.
        """
        self._motion, self._travel, self._tolerance = motion, travel, tolerance
        self._query = SelfQuery(motion.robot, deadline)

    @property
    def queries(self) -> int:
        """Number of Coal queries so far."""
        return self._query.count

    def nearest(self, layer: int, time: float) -> Nearest:
        """The nearest two links that must not touch, at a time in [0, 1] on an edge."""
        return self._query.nearest(joint_configuration(self._motion, layer, time))

    def edges(self, layer: int) -> list[Edge]:
        """An edge of all pairs of links that must not touch, for interval halving; none without."""
        if self._query.empty:
            return []
        pairs, rounding = np.arange(len(self._query.pairs)), ROUNDING + ITERATION_ERROR
        return [SelfCollisionEdge(self._query, self._motion, self._travel, layer, pairs, rounding)]

    def verdicts(self) -> list[Verdict]:
        """(m,) for each edge, whether links that must not touch are proven apart.

        Lower bounds decide for the pairs that are far apart; Coal measures the others.
        """
        motion, travel, query = self._motion, self._travel, self._query
        rounding = ROUNDING + ITERATION_ERROR
        verdicts = [Verdict(True, np.inf, 0.0, 0)] * motion.edges
        if query.empty:
            return verdicts
        from ffsr_plan.proof.kernels.apart import known_for, prove_apart
        from ffsr_plan.proof.kernels.course import memory_for

        course, pairs = course_in_base(motion, travel), query.pairs
        proven, memory = np.zeros((motion.edges, len(pairs)), dtype=np.bool_), memory_for(course)
        prove_apart(course, pairs, rounding, memory, known_for(course), proven)
        for layer in np.flatnonzero(~proven.all(axis=1)).tolist():
            open_pairs = np.flatnonzero(~proven[layer])
            edge = SelfCollisionEdge(query, motion, travel, layer, open_pairs, rounding)
            ends = edge.clearance(0.0), edge.clearance(1.0)
            verdicts[layer] = certify(edge, ends, self._tolerance)
        return verdicts

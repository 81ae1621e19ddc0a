"""Clearances and proofs along the edges of one motion, for any offsets of the base.

An edge leads from one layer to the next. Its ends are displaced from the nominal motion by offsets:
those of lattice nodes during a search, any others during refinement.
"""

from __future__ import annotations

from copy import copy
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.contacts import goal_in_collision, named, start_in_collision
from ffsr_plan.collision.distances import Nearest, ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array, IntArray, records
from ffsr_plan.core.errors import NoPath
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.course import course_of
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import ROUNDING, Edge, Verdict, certify, clearance_bound
from ffsr_plan.proof.motion_edges import (
    NominalPlacements,
    ObstacleEdge,
    odd_times,
)
from ffsr_plan.proof.moving_obstacles import MovingObstacles, Touching, worse
from ffsr_plan.proof.sampled_edges import sample_edges
from ffsr_plan.proof.self_collision_proof import LinkProof
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

if TYPE_CHECKING:
    from ffsr_plan.proof.kernels.course import Course, Memory

_BOUND_PRECISION = 0.05  # relative difference of a path's proven and computed least clearance
_EDGES_AT_ONCE = 64  # edges that are proven between two looks at the deadline


class Prover:
    """Certifies edges of one motion by distance queries.

    Attributes:
        speeds: (m,) bound on the travel [m] of any point over an edge of each layer, in addition
            to the base's own.
        rounding: length that is added to every travel bound [m].
        links: proofs that links do not touch one another.
    """

    def __init__(
        self,
        nominal: Motion | CurvedMotion,
        scene: Scene,
        tolerance: float,
        deadline: Deadline | None = None,
        pace: Timetable | None = None,
        touching: Touching | None = None,
    ) -> None:
        """Prepare the proofs.

        Args:
            nominal: the motion from which offsets are counted; along a curve they are zero.
            scene: the obstacles.
            tolerance: clearance below which an edge may be refused [m].
            deadline: after which distance queries, and so all proofs, raise `OutOfTime`.
            pace: at which the motion is run; without it no body may move.
            touching: shapes that may touch a body that moves; None for none.

        Raises:
            InvalidInput: bodies move, and there is no pace.
        """
        self._motion, self._scene, self.tolerance = nominal, scene, tolerance
        self._deadline = deadline or Deadline()
        self._deadline.check()
        self._fixed = scene if pace is None else scene.at_rest
        self._obstacles = ObstacleQuery(nominal.robot, self._fixed, deadline)
        self._travel, self._steps = EdgeTravel(nominal), nominal.base_steps()
        self.links = LinkProof(nominal, self._travel, tolerance, self._deadline)
        self._placements = NominalPlacements(nominal)
        self._corners = shape_placements(nominal.robot, nominal.configurations())
        self._own_speeds = self._travel.speeds
        iterated = iteration_error(nominal.robot, self._fixed)
        self._exact = iterated == 0.0
        self._rounding = ROUNDING + self._travel.attitude_error + iterated
        self._run_at(pace, touching)

    def _run_at(self, pace: Timetable | None, touching: Touching | None = None) -> None:
        """Prepare the proofs past bodies that move, at a pace."""
        self._pace, self.speeds, self.rounding = pace, self._own_speeds, self._rounding
        self._moving: MovingObstacles | None = None
        if pace is not None and self._scene.moves:
            self._moving = MovingObstacles(
                self._motion, self._scene, pace, self._travel, self._placements, self._corners,
                ROUNDING + self._travel.attitude_error, self._deadline, touching,
            )  # fmt: skip
            self.speeds = self.speeds + self._moving.travel
            self.rounding = max(self._rounding, self._moving.rounding)

    def at_pace(self, pace: Timetable) -> Prover:
        """The same proofs at another pace; all that does not depend on it is shared.

        Args:
            pace: the other pace; this prover has one already if bodies move.
        """
        other = copy(self)
        other._run_at(pace)
        return other

    @property
    def queries(self) -> int:
        """Number of Coal queries so far, each over all pairs of one configuration."""
        moving = 0 if self._moving is None else self._moving.queries
        return self._obstacles.count + self.links.queries + moving

    def clearances(self, layers: IntArray, offsets: Array) -> Array:
        """Clearances at layers of the displaced motion.

        Args:
            layers: (k,) layers.
            offsets: (k, 3) displacements of the base [m].

        Returns:
            (k,) distances to the nearest obstacle [m].
        """
        found = self._obstacles.distances_at(self._corners, layers, offsets)
        if self._moving is None:
            return found
        return self._moving.least(0, layers, offsets, found)

    def half_way(self, layers: IntArray, offsets: Array) -> Array:
        """Clearances half-way on edges of the displaced motion, in closed form for a search.

        Args:
            layers: (k,) edges.
            offsets: (k, 3) displacements of the base there [m].

        Returns:
            (k,) distances to the nearest obstacle [m].
        """
        found = self._obstacles.closed_at(self._placements.between(2), layers, offsets)
        if self._moving is None:
            return found
        return self._moving.least(2, layers, offsets, found)

    def sampled_edges(
        self, layers: IntArray, tails: Array, heads: Array, ends: Array
    ) -> list[Verdict]:
        """Sample the clearances on many edges until they are proven free; see `sample_edges`.

        Args:
            layers: (k,) the edges.
            tails: (k, 3) offsets at their starts [m].
            heads: (k, 3) offsets at their ends [m].
            ends: (k, 2) clearances at their starts and ends [m].

        Returns:
            k verdicts: whether the edge is proven free, and the least clearance sampled.
        """
        speeds = np.linalg.norm(self._steps[layers] + heads - tails, axis=1) + self.speeds[layers]

        def measure(which: IntArray, parts: int) -> Array:
            times = odd_times(parts)[:, None]
            rows = np.arange(len(times))[:, None] * self._motion.edges + layers[which]
            offsets = (1.0 - times[..., None]) * tails[which] + times[..., None] * heads[which]
            placed = self._placements.between(parts)
            flat = rows.ravel(), offsets.reshape(-1, 3)
            found = self._obstacles.distances_at(placed, *flat)
            if self._moving is not None:
                found = self._moving.least(parts, *flat, found)
            return found.reshape(rows.shape)

        return sample_edges(measure, ends, speeds, self.rounding, self.tolerance)

    def base_step(self, layer: int, tail: Array, head: Array) -> Array:
        """Displacement of the base origin over an edge.

        Args:
            layer: the edge.
            tail: (..., 3) offsets at its start [m].
            head: (..., 3) offsets at its end [m].

        Returns:
            (..., 3) displacements, world axes [m].
        """
        along: Array = self._steps[layer]
        return along + head - tail

    def obstacle_edge(self, layer: int, tail: Array, head: Array) -> ObstacleEdge:
        """The edge from offset `tail` to `head`, (3,) each [m], for interval halving."""
        return ObstacleEdge(
            self._obstacles,
            self._placements,
            self._travel,
            layer,
            (tail, head),
            self.base_step(layer, tail, head),
            self._rounding,
        )

    def edges_at(self, layer: int) -> list[Edge]:
        """An edge without offsets past the obstacles at rest, past each body, and of the links."""
        still = np.zeros(3)
        found: list[Edge] = [self.obstacle_edge(layer, still, still), *self.links.edges(layer)]
        return found + (self._moving.edges_at(layer) if self._moving is not None else [])

    def certify(self, layer: int, tail: Array, head: Array, ends: tuple[float, float]) -> Verdict:
        """Prove that an edge is free of obstacles, or refuse it.

        Args:
            layer: the edge.
            tail: (3,) offset at its start [m].
            head: (3,) offset at its end [m].
            ends: clearances at both ends [m].
        """
        edge = np.array([layer]), tail[None], head[None], np.array([ends])
        (verdict,) = self.certify_all(*edge)
        return verdict

    def certify_all(
        self, layers: IntArray, tails: Array, heads: Array, ends: Array
    ) -> list[Verdict]:
        """Prove of many edges that they are free of obstacles, or refuse them.

        Distances in closed form decide where they do so by far more than their error; a refusal is
        confirmed by Coal, and what they leave open is decided on Coal's distances alone.

        Args:
            layers: (k,) the edges.
            tails: (k, 3) offsets at their starts [m].
            heads: (k, 3) offsets at their ends [m].
            ends: (k, 2) clearances at their starts and ends [m].
        """
        if not len(layers):
            return []
        if self._course is None:
            free = [Verdict(True, np.inf, 0.0, 0)] * len(layers)
            return self._past_bodies(layers, tails, heads, ends, free)
        from ffsr_plan.proof.kernels import edge_proof

        edges, course = records(edge_proof.EDGE, len(layers)), self._course
        edges["layer"], edges["tail"], edges["head"], edges["ends"] = layers, tails, heads, ends
        halving = edge_proof.intervals_for(course)
        for first in range(0, len(layers), _EDGES_AT_ONCE):
            self._deadline.check()
            some = edges[first : first + _EDGES_AT_ONCE]
            edge_proof.prove(
                course, self._own_speeds, some, self._rounding, self.tolerance, self._memory,
                halving,
            )  # fmt: skip
        verdicts, columns = [], [edges[name] for name in ("state", "least", "time", "count")]
        for k, (state, least, time, count) in enumerate(
            zip(*(column.tolist() for column in columns), strict=True)
        ):
            if state == edge_proof.PROVEN:
                verdicts.append(Verdict(True, least, time, count))
                continue
            edge = self.obstacle_edge(int(layers[k]), tails[k], heads[k])
            touched = (
                edge.clearance(time) if state == edge_proof.TOUCHED and self._exact else np.inf
            )
            if touched <= 0.0:
                verdicts.append(Verdict(False, touched, time, count))
            else:
                verdicts.append(certify(edge, (ends[k, 0], ends[k, 1]), self.tolerance))
        return self._past_bodies(layers, tails, heads, ends, verdicts)

    def _past_bodies(
        self, layers: IntArray, tails: Array, heads: Array, ends: Array, verdicts: list[Verdict]
    ) -> list[Verdict]:
        """The verdicts, after a look at the bodies that move."""
        left = np.flatnonzero([verdict.free for verdict in verdicts])
        if self._moving is None or not len(left):
            return verdicts
        edges = layers[left], tails[left], heads[left], ends[left]
        found = self._moving.certify(*edges, self.tolerance)
        for k, verdict in zip(left.tolist(), found, strict=True):
            verdicts[k] = worse(verdicts[k], verdict)
        return verdicts

    @cached_property
    def _course(self) -> Course | None:
        """The motion among the obstacles for kernels; None where there are none."""
        if self._obstacles.empty:
            return None
        return course_of(self._motion, self._fixed, self._travel)

    @cached_property
    def _memory(self) -> Memory:
        from ffsr_plan.proof.kernels.course import memory_for

        assert self._course is not None
        return memory_for(self._course)

    def least_clearance(self, offsets: Array, clearances: Array) -> float:
        """Proven lower bound on the clearance all along a path whose edges are free.

        Args:
            offsets: (m + 1, 3) offsets of the path's nodes [m].
            clearances: (m + 1,) clearances at the nodes [m].

        Returns:
            The bound [m].

        Raises:
            OutOfTime: at the deadline.
        """
        self._deadline.check()
        found = self._least_at_rest(offsets, clearances)
        if self._moving is not None:
            least = float(np.min(clearances))
            found = min(found, self._moving.least_clearance(offsets, least, _BOUND_PRECISION))
        return max(found, 0.0)  # not negative, because the edges have been proven free

    def _least_at_rest(self, offsets: Array, clearances: Array) -> float:
        """The bound as far as the obstacles at rest count [m]."""
        if self._course is not None and self._exact:
            from ffsr_plan.proof.kernels.path_clearance import parts_for, path_clearance

            found = path_clearance(
                self._course, self._own_speeds, np.array(offsets), np.array(clearances),
                self._rounding, _BOUND_PRECISION, self._memory, parts_for(self._course),
            )  # fmt: skip
            return float(found)
        bound = least = float(np.min(clearances))
        for layer, ends in enumerate(pairwise(map(float, clearances))):
            edge = self.obstacle_edge(layer, offsets[layer], offsets[layer + 1])
            edge_bound, least = clearance_bound(edge, ends, least, _BOUND_PRECISION)
            bound = min(bound, edge_bound)
        return bound

    def nearest(self, layer: int, tail: Array, head: Array, time: float) -> Nearest:
        """The nearest link and obstacle at a time on an edge.

        Args:
            layer: the edge.
            tail: (3,) offset at its start [m].
            head: (3,) offset at its end [m].
            time: the time on it, in [0, 1].
        """
        offset = self.obstacle_edge(layer, tail, head).offset(time)
        found = self._obstacles.nearest_at(self._placements.at(time), layer, offset)
        if self._moving is None:
            return found
        other = self._moving.nearest(layer, tail, head, time)
        return min(found, other, key=lambda pair: pair.distance)

    def check_ends(self) -> None:
        """Check that start and goal touch nothing.

        Raises:
            StartInCollision: with all that touches there, and at the goal.
            GoalInCollision: with all that touches there.
        """
        robot, goal, still = self._motion.robot, self._motion.edges, np.zeros(3)
        clear = self.clearances(np.array([0, goal]), np.zeros((2, 3))) > 0.0
        for layer, is_clear in zip((0, goal), clear.tolist(), strict=True):
            if is_clear and self.links.nearest(layer, 0.0).distance > 0.0:
                continue
            pairs = [
                self._obstacles.nearest_at(self._corners, layer, still),
                self.links.nearest(layer, 0.0),
            ]
            if self._moving is not None:
                pairs.append(self._moving.nearest(layer, still, still, 0.0))
            if min(nearest.distance for nearest in pairs) <= 0.0:
                configurations, scene = self._motion.configurations(), self._scene
                if self._pace is not None:
                    scene = scene.at(float(self._pace.instants(np.array(layer))))
                if layer == 0:
                    end = None if self._moving else configurations[-1]  # at another time
                    raise start_in_collision(robot, scene, configurations[0], end)
                raise goal_in_collision(robot, scene, configurations[-1])

    def check_self_collision(self, advice: tuple[str, ...] = ()) -> None:
        """Prove that no links touch each other on any edge, whatever the offsets.

        Args:
            advice: what may help, for the error.

        Raises:
            NoPath: with the first edge on which two links come too close.
        """
        for layer, verdict in enumerate(self.links.verdicts()):
            if not verdict.free:
                near = self.links.nearest(layer, verdict.time)
                links, contacts = (near.link, str(near.obstacle)), (named(self._scene, near),)
                raise NoPath(layer + 1, links, self._motion.edges, contacts, advice)

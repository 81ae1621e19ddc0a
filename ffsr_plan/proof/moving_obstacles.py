"""Clearances and proofs past bodies that move, along the edges of one motion at a fixed pace.

A layer of the motion has one time. So a body is where it is at that time for all nodes of a layer,
and what holds for obstacles at rest within a layer holds for it: a translation by x changes a
clearance by x at most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.collision.body_distances import BodyDistances, in_axes, moved_aside
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.distances import Nearest, ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.body_edge import BodyEdge
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import Verdict, certify, clearance_bound
from ffsr_plan.proof.motion_edges import NominalPlacements, odd_times
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

POSE_ERROR = 1e-9
"""Of a body's attitude [rad] and of its place [m]."""


class Touching(NamedTuple):
    """Shapes that may touch one body, at the end of a motion.

    Attributes:
        body: number of the body.
        shapes: (g,) the shapes.
        edge: from which edge on; before it, and at its begin, they may not.
    """

    body: int
    shapes: Flags
    edge: int


class MovingObstacles:
    """The bodies of a scene, as a motion passes them.

    Attributes:
        travel: (m,) bound on the way of any point of any body over each edge [m].
        rounding: length added to every travel bound, at most [m].
        queries: number of Coal queries so far.
    """

    def __init__(
        self,
        motion: Motion | CurvedMotion,
        scene: Scene,
        pace: Timetable,
        travel: EdgeTravel,
        placements: NominalPlacements,
        corners: Placements,
        rounding: float,
        deadline: Deadline,
        touching: Touching | None = None,
    ) -> None:
        """Prepare the measurements.

        Args:
            motion: the motion from which offsets are counted.
            scene: the obstacles, of which the bodies count here.
            pace: at which the motion is run.
            travel: travel bounds along it.
            placements: placements of the shapes along it.
            corners: placements at its layers.
            rounding: length added to every travel bound [m].
            deadline: after which measurements raise `OutOfTime`.
            touching: shapes that may touch a body, at layers and along edges; None for none.
        """
        self._touching = touching
        self._bodies, self._pace, self._deadline = scene.bodies, pace, deadline
        self._edges, self._steps = motion.edges, motion.base_steps()
        self._travel, self._placements, self._corners = travel, placements, corners
        self._robot, scenes = motion.robot, scene.body_scenes
        self._queries = [ObstacleQuery(motion.robot, each, deadline) for each in scenes]
        self._first = len(scene) - len(scene.bodies)
        self._roundings = [
            rounding + POSE_ERROR * (1.0 + body.reach) + iteration_error(motion.robot, each)
            for body, each in zip(self._bodies, scenes, strict=True)
        ]
        self.rounding = max(self._roundings)
        ends = pace.instants(np.arange(motion.edges + 1.0)).tolist()
        self._ways = np.array(
            [[body.travel(*ends[k : k + 2]) for k in range(motion.edges)] for body in self._bodies]
        )
        self.travel = frozen(self._ways.max(axis=0))
        self._seen: dict[tuple[int, int], BodyDistances] = {}

    @property
    def queries(self) -> int:
        """Number of Coal queries so far."""
        return sum(query.count for query in self._queries)

    def least(self, parts: int, rows: IntArray, offsets: Array, others: Array) -> Array:
        """The lesser of the distances to all bodies and of others, at the time of each place.

        Args:
            parts: 2, 4, 8 or 16 for places inside edges, see `NominalPlacements.between`; 0 for
                the layers.
            rows: (k,) rows of the placements.
            offsets: (k, 3) displacements of the base there [m].
            others: (k,) distances to other obstacles [m].

        Returns:
            (k,) distances [m].
        """
        for b in range(len(self._bodies)):
            others = self._body(b, parts).least(rows, offsets, others)
        return others

    def certify(
        self, layers: IntArray, tails: Array, heads: Array, ends: Array, tolerance: float
    ) -> list[Verdict]:
        """Prove of many edges that no body touches the robot on them, or refuse them.

        Args:
            layers: (k,) the edges.
            tails: (k, 3) offsets at their starts [m].
            heads: (k, 3) offsets at their ends [m].
            ends: (k, 2) lower bounds on the clearances at their starts and ends [m].
            tolerance: clearance below which an edge may be refused [m].
        """
        steps = np.linalg.norm(self._steps[layers] + heads - tails, axis=1)
        own = steps + self._travel.speeds[layers]
        verdicts = [Verdict(True, least, 0.0, 0) for least in ends.min(axis=1).tolist()]
        for b in range(len(self._bodies)):
            ways = own + self._ways[b, layers] + self._roundings[b]
            left = np.flatnonzero(ends.sum(axis=1) <= ways)
            if not len(left):
                continue
            body = self._body(b, 0)
            first = body.distances(layers[left], tails[left])
            last = body.distances(layers[left] + 1, heads[left])
            for k, pair in zip(left.tolist(), zip(first, last, strict=True), strict=True):
                if verdicts[k].free and sum(pair) <= ways[k]:
                    edge = self._edge(b, int(layers[k]), tails[k], heads[k])
                    found = certify(edge, (float(pair[0]), float(pair[1])), tolerance)
                    verdicts[k] = worse(verdicts[k], found)
        return verdicts

    def least_clearance(self, offsets: Array, least: float, precision: float) -> float:
        """Proven lower bound on the clearance from the bodies along a path whose edges are free.

        Args:
            offsets: (m + 1, 3) offsets of the path's nodes [m].
            least: a clearance that the path has somewhere; more than it is not looked at [m].
            precision: relative precision of the bound.

        Returns:
            The bound, or `least` where that is smaller [m].
        """
        bound, layers = least, np.arange(self._edges + 1)
        for b in range(len(self._bodies)):
            clearances = self._body(b, 0).distances(layers, offsets)
            steps = np.linalg.norm(self._steps + np.diff(offsets, axis=0), axis=1)
            ways = steps + self._travel.speeds + self._ways[b] + self._roundings[b]
            margins = clearances[:-1] + clearances[1:] - ways
            for layer in np.flatnonzero(margins < 2.0 * least).tolist():
                ends = float(clearances[layer]), float(clearances[layer + 1])
                edge = self._edge(b, layer, offsets[layer], offsets[layer + 1])
                found, least = clearance_bound(edge, ends, least, precision)
                bound = min(bound, found)
        return bound

    def nearest(self, layer: int, tail: Array, head: Array, time: float) -> Nearest:
        """The nearest link and body at a place on an edge.

        Args:
            layer: the edge; m for the goal.
            tail: (3,) offset at its start [m].
            head: (3,) offset at its end [m].
            time: the place on it, in [0, 1].
        """
        shift = (1.0 - time) * tail + time * head
        at = self._corners if time == 0.0 else self._placements.at(time)
        frames = at.frames[layer : layer + 1]
        instant = self._pace.instants(np.array([layer + time]))
        pairs = []
        for b, query in enumerate(self._queries):
            poses, placed = self._bodies[b].poses(instant), Placements(frames)
            inside = layer > 0 and time == 0.0  # a layer, which the edge before it ends at
            if (aside := self._aside(b, layer - inside)) is not None:
                placed = moved_aside(placed, np.ones(1, dtype=np.bool_), aside)
            seen = in_axes(placed, poses, shift[None])
            pairs.append(query.nearest_at(seen, 0, np.zeros(3))._replace(obstacle=self._first + b))
        return min(pairs, key=lambda pair: pair.distance)

    def _edge(self, b: int, layer: int, tail: Array, head: Array) -> BodyEdge:
        self._deadline.check()
        step = self._steps[layer] + head - tail
        return BodyEdge(
            self._bodies[b], self._queries[b], self._placements, self._travel, layer, (tail, head),
            step, self._pace, self._roundings[b], aside=self._aside(b, layer),
        )  # fmt: skip

    def _aside(self, b: int, edge: int) -> Flags | None:
        """(g,) shapes that may touch a body on an edge; None for none."""
        touching = self._touching
        if touching is None or touching.body != b or edge < touching.edge:
            return None
        return touching.shapes

    def _body(self, b: int, parts: int) -> BodyDistances:
        """Distances to one body at the layers or at places inside edges."""
        if (b, parts) not in self._seen:
            places: Array = np.arange(self._edges + 1.0)
            placed = self._corners
            if parts:
                places = np.add.outer(odd_times(parts), places[:-1]).ravel()
                placed = self._placements.between(parts)
            elif self._touching is not None and self._touching.body == b:
                after = places > self._touching.edge
                placed = moved_aside(placed, after, self._touching.shapes)
            poses = self._bodies[b].poses(self._pace.instants(places))
            self._seen[b, parts] = BodyDistances(self._robot, self._queries[b], placed, poses)
        return self._seen[b, parts]


def worse(one: Verdict, other: Verdict) -> Verdict:
    """Two verdicts on one edge as one: free if both are.

    Args:
        one: a verdict.
        other: another.
    """
    refused = [each for each in (one, other) if not each.free]
    kept = min(refused or (one, other), key=lambda each: each.least_clearance)
    return kept._replace(queries=one.queries + other.queries)

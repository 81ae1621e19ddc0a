"""Clearances and proofs past bodies and debris, along the edges of one motion at a fixed pace.

A layer of the motion has one time. So a body is where it is at that time for all nodes of a layer,
and what holds for obstacles at rest within a layer holds for it: a translation by x changes a
clearance by x at most.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.collision.body_distances import BodyDistances, in_axes, moved_aside
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.distances import Nearest, ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen, records
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.body_edge import BodyEdge, DebrisProof, Passages
from ffsr_plan.proof.course import course_of
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import Edge, Verdict, certify, clearance_bound
from ffsr_plan.proof.motion_edges import NominalPlacements, odd_times
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

POSE_ERROR = 1e-9
"""Of a body's attitude [rad] and of its place [m]."""
_PLACES = 64  # parts of an edge over which a body is tabulated; proofs on shorter ones take Coal


class BodyProof:
    """Proofs past one body: compiled ones where distances in closed form decide."""

    def __init__(
        self, motion: Motion | CurvedMotion, shapes: Scene, travel: EdgeTravel, exact: bool
    ) -> None:
        """Prepare the proofs.

        Args:
            motion: the motion from which offsets are counted.
            shapes: the body's shapes along its own axes.
            travel: travel bounds along the motion.
            exact: whether distances to all of them are closed forms.
        """
        self._of, self._exact = (motion, shapes, travel), exact
        self._kept: tuple[Any, ...] | None = None

    @property
    def _compiled(self) -> tuple[Any, ...]:
        """Arrays of the motion past the body, and memory for its edges."""
        if self._kept is None:
            from ffsr_plan.proof.kernels import course, edge_proof, passage, path_clearance

            own = passage.Passage(np.empty((_PLACES + 1, 12)), np.empty(2 * _PLACES), np.zeros(3))
            past = course_of(*self._of, own)
            more = edge_proof.intervals_for(past), path_clearance.parts_for(past)
            self._kept = past, course.memory_for(past), *more
        return self._kept

    def certify(self, edge: BodyEdge, ends: tuple[float, float], tolerance: float) -> Verdict:
        """Prove that the body does not touch the robot on an edge, or refuse it.

        Args:
            edge: the edge.
            ends: clearances at its ends [m].
            tolerance: clearance below which it may be refused [m].
        """
        from ffsr_plan.proof.kernels import edge_proof

        if edge.aside is not None:  # of which kernels know nothing
            return certify(edge, ends, tolerance)
        past, memory, intervals, _ = self._compiled
        edge.tabulate(past.passage)
        row = records(edge_proof.EDGE, 1)
        row["layer"], row["tail"], row["head"] = edge.ends
        row["ends"] = ends
        speeds = self._of[2].speeds
        edge_proof.prove(past, speeds, row, edge.rounding, tolerance, memory, intervals)
        (state, least, time, count) = row[["state", "least", "time", "count"]].tolist()[0]
        if state == edge_proof.PROVEN:
            return Verdict(True, least, time, count)
        if state == edge_proof.TOUCHED and self._exact:
            touched = edge.clearance(time)
            if touched <= 0.0:
                return Verdict(False, touched, time, count)
        return certify(edge, ends, tolerance)

    def clearance_bound(
        self, edge: BodyEdge, ends: tuple[float, float], least: float, precision: float
    ) -> tuple[float, float]:
        """A lower bound on the clearance along an edge; see `interval_halving.clearance_bound`."""
        if not self._exact or edge.aside is not None:
            return clearance_bound(edge, ends, least, precision)
        from ffsr_plan.proof.kernels.path_clearance import edge_clearance

        past, memory, _, parts = self._compiled
        edge.tabulate(past.passage)
        numbers = edge.rounding, precision, edge.speed
        bound, found = edge_clearance(past, *edge.ends, numbers, min(least, *ends), memory, parts)
        if found - bound > max(precision * found, edge.rounding):  # it takes shorter intervals
            return clearance_bound(edge, ends, least, precision)
        return min(bound, found), found


class Touching(NamedTuple):
    """Shapes that may touch one body, on a part of a motion.

    Attributes:
        body: number of the body.
        shapes: (g,) the shapes.
        edges: (m,) edges on which they may.
        corners: (m + 1,) ends of edges at which they may; elsewhere on other edges they may not.
    """

    body: int
    shapes: Flags
    edges: Flags
    corners: Flags

    @classmethod
    def since(cls, body: int, shapes: Flags, edge: int, edges: int) -> Touching:
        """From an edge of so many on, but not at its begin."""
        return cls(body, shapes, np.arange(edges) >= edge, np.arange(edges + 1) > edge)

    @classmethod
    def until(cls, body: int, shapes: Flags, edge: int, edges: int) -> Touching:
        """Before an edge of so many, but not at its begin."""
        return cls(body, shapes, np.arange(edges) < edge, np.arange(edges + 1) < edge)


class MovingObstacles:
    """The bodies and the debris of a scene, as a motion passes them.

    Attributes:
        travel: (m,) bound on the way of any point of them over each edge [m].
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
            scene: the obstacles, of which what moves counts here.
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
        self._first = len(scene.at_rest)
        errors = [iteration_error(motion.robot, each) for each in scenes]
        self._proofs = [
            BodyProof(motion, each, travel, error == 0.0)
            for each, error in zip(scenes, errors, strict=True)
        ]
        self._roundings = [
            rounding + POSE_ERROR * (1.0 + body.reach) + error
            for body, error in zip(self._bodies, errors, strict=True)
        ]
        ends = pace.instants(np.arange(motion.edges + 1.0)).tolist()
        self._ways = np.array(
            [[body.travel(*ends[k : k + 2]) for k in range(motion.edges)] for body in self._bodies]
        ).reshape(-1, motion.edges)
        longest, roundings = [*self._ways], [*self._roundings]
        self._debris: DebrisProof | None = None
        if scene.debris:
            own = motion.robot, scene, pace, travel, placements, rounding, deadline
            self._debris = DebrisProof(*own)
            longest.append(self._debris.travel)
            roundings.append(self._debris.rounding)
        self.rounding, self.travel = max(roundings), frozen(np.max(longest, axis=0))
        self._seen: dict[tuple[int, int], BodyDistances] = {}
        self._times: dict[int, Array] = {}

    @property
    def queries(self) -> int:
        """Number of Coal queries so far."""
        debris = 0 if self._debris is None else self._debris.distances.count
        return debris + sum(query.count for query in self._queries)

    def least(self, parts: int, rows: IntArray, offsets: Array, others: Array) -> Array:
        """The lesser of the distances to all that moves and of others, at the time of each place.

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
        if self._debris is None:
            return others
        placed = self._placements.between(parts) if parts else self._corners
        times, at_once = self._instants(parts)[rows], np.zeros(len(rows))
        return self._debris.distances.least(placed, rows, offsets, times, at_once, others)

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
                    both = float(pair[0]), float(pair[1])
                    found = self._proofs[b].certify(edge, both, tolerance)
                    verdicts[k] = worse(verdicts[k], found)
        if self._debris is None:
            return verdicts
        ways = own + self._debris.travel[layers] + self._debris.rounding
        left = np.flatnonzero(ends.sum(axis=1) <= ways)
        edges = self._passages(layers[left], tails[left], heads[left])
        past = self._debris.certify(self._corners, edges, tolerance)
        for k, verdict in zip(left.tolist(), past, strict=True):
            verdicts[k] = worse(verdicts[k], verdict)
        return verdicts

    def _passages(self, layers: IntArray, tails: Array, heads: Array) -> Passages:
        """Edges of the motion, each in its own time."""
        steps, corners = self._steps[layers] + heads - tails, np.stack([layers, layers + 1], axis=1)
        return Passages(layers, layers, tails, heads, steps, corners)

    def least_clearance(self, offsets: Array, least: float, precision: float) -> float:
        """Proven lower bound on the clearance from what moves along a path whose edges are free.

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
                found, least = self._proofs[b].clearance_bound(edge, ends, least, precision)
                bound = min(bound, found)
        if self._debris is None:
            return bound
        edges = self._passages(layers[:-1], offsets[:-1], offsets[1:])
        return min(bound, self._debris.least_clearance(self._corners, edges, least, precision))

    def nearest(self, layer: int, tail: Array, head: Array, time: float) -> Nearest:
        """The nearest link and body, or sphere of debris, at a place on an edge.

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
            if (aside := self._aside(b, layer, time == 0.0)) is not None:
                placed = moved_aside(placed, np.ones(1, dtype=np.bool_), aside)
            seen = in_axes(placed, poses, shift[None])
            pairs.append(query.nearest_at(seen, 0, np.zeros(3))._replace(obstacle=self._first + b))
        if self._debris is not None:
            measure = self._debris.distances.nearest_at
            pairs.append(measure(Placements(frames), 0, shift, float(instant[0])))
        return min(pairs, key=lambda pair: pair.distance)

    def edges_at(self, layer: int) -> list[Edge]:
        """An edge without offsets past each body, for interval halving."""
        still = np.zeros(3)
        return [self._edge(b, layer, still, still) for b in range(len(self._bodies))]

    def _edge(self, b: int, layer: int, tail: Array, head: Array) -> BodyEdge:
        self._deadline.check()
        step = self._steps[layer] + head - tail
        return BodyEdge(
            self._bodies[b], self._queries[b], self._placements, self._travel, layer, (tail, head),
            step, self._pace, self._roundings[b], aside=self._aside(b, layer),
        )  # fmt: skip

    def _aside(self, b: int, number: int, at_corner: bool = False) -> Flags | None:
        """(g,) shapes that may touch a body on an edge, or at a corner; None for none."""
        touching = self._touching
        if touching is None or touching.body != b:
            return None
        return touching.shapes if (touching.edges, touching.corners)[at_corner][number] else None

    def _body(self, b: int, parts: int) -> BodyDistances:
        """Distances to one body at the layers or at places inside edges."""
        if (b, parts) not in self._seen:
            placed = self._placements.between(parts) if parts else self._corners
            if not parts and self._touching is not None and self._touching.body == b:
                placed = moved_aside(placed, self._touching.corners, self._touching.shapes)
            poses = self._bodies[b].poses(self._instants(parts))
            self._seen[b, parts] = BodyDistances(self._robot, self._queries[b], placed, poses)
        return self._seen[b, parts]

    def _instants(self, parts: int) -> Array:
        """Times of the rows of placements [s], see `least`."""
        if parts not in self._times:
            places: Array = np.arange(self._edges + 1.0)
            if parts:
                places = np.add.outer(odd_times(parts), places[:-1]).ravel()
            self._times[parts] = self._pace.instants(places)
        return self._times[parts]


def worse(one: Verdict, other: Verdict) -> Verdict:
    """Two verdicts on one edge as one: free if both are.

    Args:
        one: a verdict.
        other: another.
    """
    refused = [each for each in (one, other) if not each.free]
    kept = min(refused or (one, other), key=lambda each: each.least_clearance)
    return kept._replace(queries=one.queries + other.queries)

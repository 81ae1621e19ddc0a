"""Bodies and debris, as the nodes and edges of a lattice with progress meet them."""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.body_motion import Poses
from ffsr_plan.bodies.pace import Pace
from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.progress_lattice.progress_steps import ProgressSteps
from ffsr_plan.proof.body_edge import BodyEdge, DebrisProof, Passages
from ffsr_plan.proof.interval_halving import ROUNDING, Verdict
from ffsr_plan.proof.motion_edges import NominalPlacements
from ffsr_plan.proof.moving_obstacles import POSE_ERROR, BodyProof, worse
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline


class ProgressBodies:
    """Clearances from the moving bodies and the debris of a scene, and proofs past them.

    Attributes:
        travel: (m + 1,) that any of them has travelled up to each layer, at most [m].
    """

    def __init__(
        self, steps: ProgressSteps, scene: Scene, pace: Pace, offsets: Array, deadline: Deadline
    ) -> None:
        """Prepare the measurements.

        Args:
            steps: the steps of progress.
            scene: the obstacles, of which what moves counts here.
            pace: of the layers.
            offsets: (n, 3) of the nodes [m].
            deadline: after which measurements raise `OutOfTime`.
        """
        self._steps, self._bodies, self._pace, self._offsets = steps, scene.bodies, pace, offsets
        self._deadline = deadline
        motion = steps.motion
        self._travel, self._placements = steps.travel, NominalPlacements(motion)
        self._base_steps = motion.base_steps()
        scenes = scene.body_scenes
        self._queries = [ObstacleQuery(motion.robot, each, deadline) for each in scenes]
        errors = [iteration_error(motion.robot, each) for each in scenes]
        self._proofs = [
            BodyProof(motion, each, self._travel, error == 0.0)
            for each, error in zip(scenes, errors, strict=True)
        ]
        self._roundings = [
            ROUNDING + self._travel.attitude_error + POSE_ERROR * (1.0 + body.reach) + error
            for body, error in zip(self._bodies, errors, strict=True)
        ]
        times = pace.instants(np.arange(pace.edges + 1.0))
        self._ways = np.array(
            [
                [body.travel(*times[k : k + 2].tolist()) for k in range(pace.edges)]
                for body in self._bodies
            ]
        ).reshape(-1, pace.edges)
        longest = [own + more for own, more in zip(self._ways, self._roundings, strict=True)]
        self._debris: DebrisProof | None = None
        if scene.debris:
            own = ROUNDING + self._travel.attitude_error
            self._debris = DebrisProof(
                motion.robot, scene, pace, pace.edges, self._travel, self._placements, own, deadline
            )
            longest.append(self._debris.travel + self._debris.rounding)
        self.travel = np.concatenate([[0.0], np.cumsum(np.max(longest, axis=0))])
        self._times = times
        self._placed = placed = shape_placements(
            motion.robot, motion.configurations()[steps.corners]
        )
        copies = len(times) if self._bodies else 1
        frames = Placements(np.tile(placed.frames, (copies, 1, 1)))
        every = np.repeat(np.arange(len(times)), len(steps.corners))  # the layer of each place
        self._seen = []
        for body, query in zip(self._bodies, self._queries, strict=True):
            poses = Poses(*(each[every] for each in body.poses(times)))
            self._seen.append(BodyDistances(motion.robot, query, frames, poses))

    @property
    def queries(self) -> int:
        """Number of Coal queries so far."""
        debris = 0 if self._debris is None else self._debris.distances.count
        return debris + sum(query.count for query in self._queries)

    def least(self, layers: IntArray, places: IntArray, offsets: IntArray, others: Array) -> Array:
        """The lesser of the nodes' distances to all that moves, at their times, and of others.

        Args:
            layers: (k,) layers.
            places: (k,) places.
            offsets: (k,) numbers of the offsets.
            others: (k,) distances to other obstacles [m].

        Returns:
            (k,) distances [m].
        """
        rows = self._rows(layers, places)
        for seen in self._seen:
            others = seen.least(rows, self._offsets[offsets], others)
        if self._debris is not None:
            at = self._offsets[offsets], self._times[layers], np.zeros(len(layers))
            others = self._debris.distances.least(self._placed, places, *at, others)
        return others

    def certify(
        self, layers: IntArray, places: IntArray, offsets: IntArray, tolerance: float
    ) -> list[Verdict]:
        """Prove that nothing that moves touches the robot on edges, or refuse them.

        Args:
            layers: (k,) layers that they leave.
            places: (k, 2) places at their ends.
            offsets: (k, 2) numbers of the offsets at their ends.
            tolerance: clearance below which an edge may be refused [m].
        """
        steps = self._steps
        edges = steps.edges[places[:, 0], places[:, 1] - places[:, 0] + steps.most]
        tails, heads = self._offsets[offsets[:, 0]], self._offsets[offsets[:, 1]]
        moved = self._base_steps[edges] + heads - tails
        own = np.linalg.norm(moved, axis=1) + self._travel.speeds[edges]
        verdicts = [Verdict(True, np.inf, 0.0, 0)] * len(layers)
        for b in range(len(self._bodies)):
            first = self._seen[b].distances(self._rows(layers, places[:, 0]), tails)
            last = self._seen[b].distances(self._rows(layers + 1, places[:, 1]), heads)
            ways = own + self._ways[b, layers] + self._roundings[b]
            for k, ends in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
                found = Verdict(True, min(ends), 0.0, 0)
                if sum(ends) <= ways[k]:
                    self._deadline.check()
                    edge = BodyEdge(
                        self._bodies[b], self._queries[b], self._placements, self._travel,
                        int(edges[k]), (tails[k], heads[k]), moved[k], self._pace,
                        self._roundings[b], int(layers[k]),
                    )  # fmt: skip
                    found = self._proofs[b].certify(edge, ends, tolerance)
                verdicts[k] = worse(verdicts[k], found)
        if self._debris is not None:
            run = Passages(edges, layers, tails, heads, moved, places)
            past = self._debris.certify(self._placed, run, tolerance)
            verdicts = [worse(*pair) for pair in zip(verdicts, past, strict=True)]
        return verdicts

    def _rows(self, layers: IntArray, places: IntArray) -> IntArray:
        """(k,) rows of the placements: all places of layer 0, then of layer 1, and so on."""
        return np.asarray(layers * len(self._steps.values) + places)

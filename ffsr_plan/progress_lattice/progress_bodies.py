"""Bodies that move, as the nodes and edges of a lattice with progress meet them."""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.pace import Pace
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.progress_lattice.progress_steps import ProgressSteps
from ffsr_plan.proof.body_edge import BodyEdge, in_axes
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import ROUNDING, Verdict, certify
from ffsr_plan.proof.motion_edges import NominalPlacements
from ffsr_plan.proof.moving_obstacles import POSE_ERROR, worse
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline


class ProgressBodies:
    """Clearances from the moving bodies of a scene, and proofs past them.

    Attributes:
        travel: (m + 1,) that any body has travelled up to each layer, at most [m].
    """

    def __init__(
        self, steps: ProgressSteps, scene: Scene, pace: Pace, offsets: Array, deadline: Deadline
    ) -> None:
        """Prepare the measurements.

        Args:
            steps: the steps of progress.
            scene: the obstacles, of which the bodies count here.
            pace: of the layers.
            offsets: (n, 3) of the nodes [m].
            deadline: after which measurements raise `OutOfTime`.
        """
        self._steps, self._bodies, self._pace, self._offsets = steps, scene.bodies, pace, offsets
        self._deadline = deadline
        motion = steps.motion
        self._travel, self._placements = EdgeTravel(motion), NominalPlacements(motion)
        self._base_steps = motion.base_steps()
        scenes = [Scene(shapes=body.shapes, growth=scene.growth) for body in self._bodies]
        self._queries = [ObstacleQuery(motion.robot, each, deadline) for each in scenes]
        self._roundings = [
            ROUNDING
            + self._travel.attitude_error
            + POSE_ERROR * (1.0 + body.reach)
            + iteration_error(motion.robot, each)
            for body, each in zip(self._bodies, scenes, strict=True)
        ]
        times = pace.instants(np.arange(pace.edges + 1.0))
        self._ways = np.array(
            [
                [body.travel(*times[k : k + 2].tolist()) for k in range(pace.edges)]
                for body in self._bodies
            ]
        )
        self.travel = np.concatenate([[0.0], np.cumsum(self._ways.max(axis=0))])
        placed = shape_placements(motion.robot, motion.configurations()[steps.corners])
        self._seen = [self._everywhere(placed, b, times) for b in range(len(self._bodies))]

    @property
    def queries(self) -> int:
        """Number of Coal queries so far."""
        return sum(query.count for query in self._queries)

    def clearances(self, layers: IntArray, places: IntArray, offsets: IntArray) -> Array:
        """Clearances of nodes from the bodies at the times of their layers.

        Args:
            layers: (k,) layers.
            places: (k,) places.
            offsets: (k,) numbers of the offsets.

        Returns:
            (k,) distances [m].
        """
        every = range(len(self._bodies))
        return np.minimum.reduce([self._distances(b, layers, places, offsets) for b in every])

    def certify(
        self, layers: IntArray, places: IntArray, offsets: IntArray, tolerance: float
    ) -> list[Verdict]:
        """Prove that no body touches the robot on edges, or refuse them.

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
            first = self._distances(b, layers, places[:, 0], offsets[:, 0])
            last = self._distances(b, layers + 1, places[:, 1], offsets[:, 1])
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
                    found = certify(edge, ends, tolerance)
                verdicts[k] = worse(verdicts[k], found)
        return verdicts

    def _everywhere(self, placed: Placements, b: int, times: Array) -> tuple[Placements, Array]:
        """The shapes at every layer and place, in the axes of a body; and the body's axes."""
        body, count = self._bodies[b], len(placed.frames)
        frames = np.tile(placed.frames, (len(times), 1, 1))
        every = np.repeat(times, count)
        seen = in_axes(Placements(frames), body, every, np.zeros((len(every), 3)))
        return seen, rotations.matrix(body.poses(times).attitudes)

    def _distances(self, b: int, layers: IntArray, places: IntArray, offsets: IntArray) -> Array:
        seen, turns = self._seen[b]
        shifts = (self._offsets[offsets][:, None] @ turns[layers])[:, 0]
        rows = layers * len(self._steps.values) + places
        return self._queries[b].distances_at(seen, rows, shifts)

"""An edge of a motion past one body that moves, for interval halving.

A point of the robot and a point of the body that touch at some time of an interval were at least
c_a apart at its begin and are at least c_b apart at its end, and their distance changes by no more
than both travel. So c_a + c_b > T + B proves the interval free, where T bounds the travel of the
robot's points and B that of the body's over the same time. Distances are taken in the body's axes,
in which its shapes rest.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.motion_edges import NominalPlacements


class BodyEdge:
    """An edge that is run in an interval of time past one moving body, at a constant pace.

    Attributes:
        speed: bound on the way of any shape and of the body together per unit of time [m].
        rounding: length added to every travel bound [m].
    """

    def __init__(
        self,
        body: MovingBody,
        query: ObstacleQuery,
        placements: NominalPlacements,
        travel: EdgeTravel,
        layer: int,
        offsets: tuple[Array, Array],
        base_step: Array,
        times: tuple[float, float],
        rounding: float,
    ) -> None:
        """An edge whose ends are displaced from the nominal motion.

        Args:
            body: the body.
            query: distances to its scene.
            placements: placements along the nominal motion.
            travel: travel bounds along it.
            layer: the edge of the nominal motion.
            offsets: displacement of the base at both ends, (3,) each, world axes [m].
            base_step: (3,) displacement of the base origin over the edge, world axes [m].
            times: begin and end of the edge [s].
            rounding: length added to every travel bound [m].
        """
        self._body, self._query, self._placements = body, query, placements
        self._travel, self._layer, self._offsets, self._times = travel, layer, offsets, times
        self._parts: dict[float, Array] = {}
        self._base_step, self.rounding = base_step, rounding
        own = float(np.linalg.norm(base_step) + travel.speeds[layer])
        motion, span = body.motion, times[1] - times[0]
        fastest = getattr(motion, "largest_rate", None)
        turned = motion.turned(*times) if fastest is None else fastest * span
        self._uniform = hasattr(motion, "velocity")
        self.speed = own + motion.path(*times) + turned * body.reach if self._uniform else np.inf

    def instant(self, time: float) -> float:
        """The time [s] at a place in [0, 1] on the edge."""
        begin, end = self._times
        return begin + time * (end - begin)

    def clearance(self, time: float) -> float:
        """Least distance of any shape to the body [m]."""
        placed = self._in_body(time)
        return float(
            self._query.distances_at(placed, np.zeros(1, dtype=np.int64), np.zeros((1, 3)))[0]
        )

    def parts(self, time: float) -> Array:
        """(g,) lower bound on the distance of each shape to the body [m]."""
        if time not in self._parts:
            self._parts[time] = self._query.links_at(self._in_body(time), 0, np.zeros(3))
        return self._parts[time]

    def travel(self, begin: float, end: float) -> Array:
        """(g,) bound on the way of each shape and of the body together between two times [m]."""
        own = self._travel.bounds(self._layer, begin, end, self._base_step)
        return own + self._body.travel(self.instant(begin), self.instant(end))

    def _in_body(self, time: float) -> Placements:
        """The placement of the shapes in the body's axes, the only one."""
        tail, head = self._offsets
        placed, pose = self._placements.at(time), self._body.poses([self.instant(time)])
        frames = placed.frames[self._layer : self._layer + 1].copy()
        shift = (1.0 - time) * tail + time * head - pose.positions[0]
        turn = rotations.matrix(pose.attitudes[0])
        frames[..., 9:12] = (frames[..., 9:12] + shift) @ turn
        frames[..., :9] = (turn.T @ placed.rotations[self._layer]).reshape(1, -1, 9)
        return Placements(frames)

"""An edge of a motion past one body that moves, for interval halving.

A point of the robot and a point of the body that touch at some time of an interval were at least
c_a apart at its begin and are at least c_b apart at its end, and their distance changes by no more
than both travel. So c_a + c_b > T + B proves the interval free, where T bounds the travel of the
robot's points and B that of the body's over the same time. Distances are taken in the body's axes,
in which its shapes rest. Where the body's reference point moves at a constant velocity along the
edge, both are watched from it: its path then counts with the base's own, and not beside it.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.collision.body_distances import in_axes, moved_aside
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.motion_edges import NominalPlacements


class BodyEdge:
    """An edge that is run in an interval of time past one moving body.

    Attributes:
        speed: bound on the way of any shape and of the body together per unit of the edge [m].
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
        pace: Timetable,
        rounding: float,
        slot: int | None = None,
        aside: Flags | None = None,
    ) -> None:
        """An edge whose ends are displaced from the nominal motion.

        Args:
            body: the body.
            query: distances to its shapes.
            placements: placements along the nominal motion.
            travel: travel bounds along it.
            layer: the edge of the nominal motion.
            offsets: displacement of the base at both ends, (3,) each, world axes [m].
            base_step: (3,) displacement of the base origin over the edge, world axes [m].
            pace: at which edges follow one another.
            rounding: length added to every travel bound [m].
            slot: the edge of the pace whose time the edge takes; by default that of its number.
            aside: (g,) shapes that may touch the body; None for none.
        """
        self._slot, self._aside = layer if slot is None else slot, aside
        self._body, self._query, self._placements = body, query, placements
        self._travel, self._layer, self._offsets, self._pace = travel, layer, offsets, pace
        self._parts: dict[float, Array] = {}
        self.rounding = rounding
        motion, begin, end = body.motion, self.instant(0.0), self.instant(1.0)
        self._watched = isinstance(motion, (Drift, Spin, Tumble)) and pace.is_even(self._slot)
        self._step, turned = base_step, motion.turned(begin, end)
        if isinstance(motion, (Drift, Spin, Tumble)) and self._watched:
            self._step = base_step - motion.velocity * (end - begin)
        if isinstance(motion, Tumble):
            turned = motion.largest_rate * (end - begin)
        own = float(np.linalg.norm(self._step) + travel.speeds[layer])
        self.speed = own + turned * body.reach if self._watched else np.inf

    def instant(self, time: float) -> float:
        """The time [s] at a place in [0, 1] on the edge."""
        return float(self._pace.instants(np.array(self._slot + time)))

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
        """(g,) bound on the way of each shape and of the body together between two places [m]."""
        own = self._travel.bounds(self._layer, begin, end, self._step)
        first, last = self.instant(begin), self.instant(end)
        if self._watched:
            return own + self._body.motion.turned(first, last) * self._body.reach
        return own + self._body.travel(first, last)

    def _in_body(self, time: float) -> Placements:
        """The placement of the shapes in the body's axes, the only one."""
        tail, head = self._offsets
        frames = self._placements.at(time).frames[self._layer : self._layer + 1]
        shift = (1.0 - time) * tail + time * head
        poses, placed = self._body.poses([self.instant(time)]), Placements(frames)
        if self._aside is not None:
            placed = moved_aside(placed, np.ones(1, dtype=np.bool_), self._aside)
        return in_axes(placed, poses, shift[None])

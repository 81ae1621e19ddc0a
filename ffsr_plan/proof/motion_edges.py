"""Edges of a motion for interval halving: against obstacles, and of links against each other."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.distances import ObstacleQuery, SelfQuery
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.edge_travel import EdgeTravel


class NominalPlacements:
    """Placements of all shapes along the edges of a motion, computed once for each time."""

    def __init__(self, motion: Motion | CurvedMotion) -> None:
        self._motion = motion
        self._known: dict[float, Placements] = {}
        self._levels: dict[int, Placements] = {}

    def at(self, time: float) -> Placements:
        """Placements on every edge at one time; row k belongs to edge k.

        Interval halving needs the same times on many edges, and the other times of the same level
        of halving next, so all of that level are computed together.
        """
        if time not in self._known:
            parts = _level_of(time)
            if parts is None:
                edges = np.arange(self._motion.edges)
                q = self._motion.at(edges, np.full(len(edges), time))
                self._known[time] = shape_placements(self._motion.robot, q)
            else:
                self.between(parts)
        return self._known[time]

    def between(self, parts: int) -> Placements:
        """Placements on every edge at the times 1, 3, 5, ... over `parts`.

        Args:
            parts: 2, 4, 8 or 16.

        Returns:
            Placements, of which row (number of the time) x m + k belongs to edge k.
        """
        if parts not in self._levels:
            times, edges = odd_times(parts), self._motion.edges
            q = self._motion.at(np.tile(np.arange(edges), len(times)), np.repeat(times, edges))
            self._levels[parts] = placed = shape_placements(self._motion.robot, q)
            each = placed.frames.reshape(len(times), edges, *placed.frames.shape[1:])
            self._known |= zip(times.tolist(), map(Placements, each), strict=True)
        return self._levels[parts]


class ObstacleEdge:
    """An edge among the obstacles; its parts are the collision shapes.

    Attributes:
        speed: bound on the travel of any shape per unit of time [m].
        rounding: length added to every travel bound [m].
        base_step: (3,) displacement of the base origin over the edge, world axes [m].
    """

    def __init__(
        self,
        query: ObstacleQuery,
        placements: NominalPlacements,
        travel: EdgeTravel,
        layer: int,
        offsets: tuple[Array, Array],
        base_step: Array,
        rounding: float,
    ) -> None:
        """An edge whose ends are displaced from the nominal motion.

        Args:
            query: distances to the obstacles.
            placements: placements along the nominal motion.
            travel: travel bounds along the nominal motion.
            layer: the edge of the nominal motion.
            offsets: displacement of the base at both ends, (3,) each, world axes [m].
            base_step: (3,) displacement of the base origin over the edge, world axes [m].
            rounding: length added to every travel bound [m].
        """
        self._query, self._placements, self._travel = query, placements, travel
        self._layer, self._offsets = layer, offsets
        self._parts: dict[float, Array] = {}
        self.base_step, self.rounding = base_step, rounding
        self.speed = float(np.linalg.norm(base_step) + travel.speeds[layer])

    def offset(self, time: float) -> Array:
        """(3,) displacement of the base from the nominal motion [m]."""
        tail, head = self._offsets
        return (1.0 - time) * tail + time * head

    def clearance(self, time: float) -> float:
        """Least distance of any shape to any obstacle [m]."""
        placed, layer = self._placements.at(time), np.array([self._layer])
        return float(self._query.distances_at(placed, layer, self.offset(time)[None])[0])

    def parts(self, time: float) -> Array:
        """(g,) lower bound on the distance of each shape to any obstacle [m]."""
        if time not in self._parts:
            placed = self._placements.at(time)
            self._parts[time] = self._query.links_at(placed, self._layer, self.offset(time))
        return self._parts[time]

    def travel(self, begin: float, end: float) -> Array:
        """(g,) travel bound of each shape in the world between two times [m]."""
        return self._travel.bounds(self._layer, begin, end, self.base_step)

    def margins(self, begin: float, end: float, ways: Array) -> Array:
        """See `interval_halving.Edge`."""
        return self.parts(begin) + self.parts(end) - ways


class SelfCollisionEdge:
    """An edge of the joints alone; its parts are the pairs of links that must not touch.

    Attributes:
        speed: bound on the travel of both shapes of any pair together per unit of time [m].
        rounding: length added to every travel bound [m].
    """

    def __init__(
        self,
        query: SelfQuery,
        motion: Motion | CurvedMotion,
        travel: EdgeTravel,
        layer: int,
        pairs: IntArray,
        rounding: float,
    ) -> None:
        """An edge of a motion.

        Args:
            query: distances between links.
            motion: the motion.
            travel: travel bounds along it.
            layer: the edge.
            pairs: (p,) numbers of the pairs that are its parts.
            rounding: length added to every travel bound [m].
        """
        self._query, self._motion, self._travel, self._layer = query, motion, travel, layer
        self._pairs = pairs
        self._parts: dict[float, Array] = {}
        self.rounding = rounding
        self.speed = 2.0 * float(travel.speeds_in_base[layer])

    def clearance(self, time: float) -> float:
        """Least distance of any of the pairs [m]."""
        return float(self.parts(time).min())

    def parts(self, time: float) -> Array:
        """(p,) distance of each pair [m]."""
        if time not in self._parts:
            q = joint_configuration(self._motion, self._layer, time)
            self._parts[time] = self._query.distances_of(self._pairs, q)
        return self._parts[time]

    def travel(self, begin: float, end: float) -> Array:
        """(p,) sum of both travel bounds of each pair in the base frame [m]."""
        each = self._travel.bounds(self._layer, begin, end)
        both: Array = each[self._query.pairs[self._pairs]].sum(axis=1)
        return both

    def margins(self, begin: float, end: float, ways: Array) -> Array:
        """See `interval_halving.Edge`."""
        return self.parts(begin) + self.parts(end) - ways


def joint_configuration(motion: Motion | CurvedMotion, layer: int, time: float) -> Array:
    """The joints at a time on an edge, with the base at the origin.

    Args:
        motion: the motion.
        layer: the edge.
        time: the time on it, in [0, 1].

    Returns:
        (nq,) configuration.
    """
    at = (layer, time) if layer < motion.edges else (layer - 1, 1.0)
    (joints,) = motion.joints_at(np.array([at[0]]), np.array([at[1]]))
    return motion.robot.assemble(np.zeros(3), rotations.IDENTITY, joints)


def odd_times(parts: int) -> Array:
    """(parts / 2,) the times 1, 3, 5, ... over `parts`, which is even."""
    return np.arange(1, parts, 2) / parts


def _level_of(time: float) -> int | None:
    """The level of halving that a time inside an edge is on; None for other times and levels."""
    levels = (parts for parts in (1, 2, 4, 8, 16) if (time * parts).is_integer())
    level = next(levels, 1)
    return level if level > 1 else None

"""Edges of a motion past what moves: one body, or debris; for interval halving.

A point of the robot and a point of a body that touch at some time of an interval were at least c_a
apart at its begin and are at least c_b apart at its end, and their distance changes by no more than
both travel. So c_a + c_b > T + B proves the interval free, where T bounds the travel of the robot's
points and B that of the body's over the same time. Distances are taken in the body's axes, in which
its shapes rest. Where the body's reference point moves at a constant velocity along the edge, both
are watched from it: its path then counts with the base's own, and not beside it.

Of debris each sphere counts with its own path w. With all spheres inflated by w / 2 at both ends,
their least distances prove the interval free if they sum to more than T: a fast sphere far away
costs nothing.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.collision.body_distances import in_axes, moved_aside
from ffsr_plan.collision.coal_measures import iteration_error
from ffsr_plan.collision.debris.debris_distances import DebrisDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.interval_halving import Verdict, certify, clearance_bound
from ffsr_plan.proof.motion_edges import NominalPlacements
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

if TYPE_CHECKING:
    from ffsr_plan.proof.kernels.passage import Passage

PLACE_ERROR = 1e-9
"""Of a sphere's place [m]."""


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
        self._slot, self.aside = layer if slot is None else slot, aside
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

    def margins(self, begin: float, end: float, ways: Array) -> Array:
        """See `interval_halving.Edge`."""
        return self.parts(begin) + self.parts(end) - ways

    @property
    def ends(self) -> tuple[int, Array, Array]:
        """The edge of the nominal motion, and the offsets (3,) at both ends [m]."""
        return self._layer, *self._offsets

    def tabulate(self, passage: Passage) -> None:
        """Fill in the body's poses and ways over the edge, and its displacement."""
        count, motion = len(passage.poses) - 1, self._body.motion
        places = self._slot + np.arange(count + 1) / count
        times = self._pace.instants(places)
        poses = self._body.poses(times)
        passage.poses[:, :9] = rotations.matrix(poses.attitudes).reshape(-1, 9)
        passage.poses[:, 9:] = poses.positions
        passage.step[:] = 0.0
        if isinstance(motion, (Drift, Spin, Tumble)) and self._watched:
            passage.step[:] = motion.velocity * (times[-1] - times[0])
        bound = self._body.travel
        if self._watched:
            bound = lambda begin, end: motion.turned(begin, end) * self._body.reach  # noqa: E731
        parts = 1
        while parts <= count:
            at = times[:: count // parts].tolist()
            passage.ways[parts : 2 * parts] = [bound(*pair) for pair in pairwise(at)]
            parts *= 2

    def _in_body(self, time: float) -> Placements:
        """The placement of the shapes in the body's axes, the only one."""
        tail, head = self._offsets
        frames = self._placements.at(time).frames[self._layer : self._layer + 1]
        shift = (1.0 - time) * tail + time * head
        poses, placed = self._body.poses([self.instant(time)]), Placements(frames)
        if self.aside is not None:
            placed = moved_aside(placed, np.ones(1, dtype=np.bool_), self.aside)
        return in_axes(placed, poses, shift[None])


class Passages(NamedTuple):
    """k edges of a motion that are run past debris.

    Attributes:
        layers: (k,) edges of the nominal motion.
        slots: (k,) edges of the pace whose times they take.
        tails: (k, 3) offsets at their starts [m].
        heads: (k, 3) offsets at their ends [m].
        steps: (k, 3) displacements of the base origin, world axes [m].
        corners: (k, 2) rows of the placements at their starts and ends.
    """

    layers: IntArray
    slots: IntArray
    tails: Array
    heads: Array
    steps: Array
    corners: IntArray

    def some(self, which: IntArray) -> Passages:
        """Some of the edges."""
        layers, slots, tails, heads, steps, corners = (column[which] for column in self)
        return Passages(layers, slots, tails, heads, steps, corners)  # type: ignore[arg-type]


class DebrisEdge:
    """An edge that is run in an interval of time past debris, for interval halving.

    Attributes:
        speed: bound on the way of any shape and of the fastest sphere together per unit of the
            edge [m].
        rounding: length added to every travel bound [m].
    """

    def __init__(self, debris: DebrisProof, passages: Passages, k: int) -> None:
        """One of some edges.

        Args:
            debris: the debris along the motion.
            passages: the edges.
            k: which of them.
        """
        self._debris, self.rounding = debris, debris.rounding
        self._layer, self._slot = int(passages.layers[k]), int(passages.slots[k])
        self._offsets, self._step = (passages.tails[k], passages.heads[k]), passages.steps[k]
        lasts = self.instant(1.0) - self.instant(0.0)
        own = float(np.linalg.norm(self._step) + debris.bounds.speeds[self._layer])
        even = debris.pace.is_even(self._slot)
        self.speed = own + debris.distances.fastest * lasts if even else np.inf

    def instant(self, time: float) -> float:
        """The time [s] at a place in [0, 1] on the edge."""
        return float(self._debris.pace.instants(np.array(self._slot + time)))

    def clearance(self, time: float) -> float:
        """Least distance of any shape to a sphere [m]."""
        at = np.array([self._layer]), self._shift(time)[None], np.array([self.instant(time)])
        placed, far = self._debris.placements.at(time), np.full(1, np.inf)
        return float(self._debris.distances.least(placed, *at, np.zeros(1), far)[0])

    def travel(self, begin: float, end: float) -> Array:
        """(g,) bound on the way of each shape and the fastest sphere between two places [m]."""
        spread = self.instant(end) - self.instant(begin)
        return self._own(begin, end) + self._debris.distances.fastest * spread

    def margins(self, begin: float, end: float, ways: Array) -> Array:
        """(g,) what the distances at both ends exceed the travel by, if positive [m]."""
        spread = self.instant(end) - self.instant(begin)
        links = [
            self._debris.distances.links_at(
                self._debris.placements.at(time), self._layer, self._shift(time),
                self.instant(time), spread,
            )
            for time in (begin, end)
        ]  # fmt: skip
        return np.asarray(links[0] + links[1] - self._own(begin, end) - self.rounding)

    def _own(self, begin: float, end: float) -> Array:
        return self._debris.bounds.bounds(self._layer, begin, end, self._step)

    def _shift(self, time: float) -> Array:
        tail, head = self._offsets
        return np.asarray((1.0 - time) * tail + time * head)


class DebrisProof:
    """Proofs past the debris of a scene, along the edges of one motion.

    Attributes:
        pace: at which the edges follow one another.
        bounds: travel bounds along the motion.
        placements: of the shapes along it.
        distances: to the spheres.
        rounding: length added to every travel bound [m].
        travel: (m,) the longest path of a sphere over each edge of the pace [m].
    """

    def __init__(
        self,
        robot: SpaceRobot,
        scene: Scene,
        pace: Timetable,
        bounds: EdgeTravel,
        placements: NominalPlacements,
        rounding: float,
        deadline: Deadline,
    ) -> None:
        """Prepare the proofs.

        Args:
            robot: the robot.
            scene: whose debris counts here, at least one sphere.
            pace: at which the edges follow one another.
            bounds: travel bounds along the motion.
            placements: of the shapes along it.
            rounding: length added to every travel bound for the robot's own errors [m].
            deadline: after which measurements raise `OutOfTime`.
        """
        self.pace, self.bounds, self.placements = pace, bounds, placements
        self._instants = pace.instants(np.arange(len(bounds.speeds) + 1.0))
        middle = 0.5 * float(self._instants[0] + self._instants[-1])
        self.distances = DebrisDistances(robot, scene, middle, deadline)
        largest = max(float(each.radii.max()) for each in scene.debris) + scene.growth
        self.rounding = rounding + 2.0 * PLACE_ERROR
        self.rounding += iteration_error(robot, Scene(np.zeros((1, 3)), [largest]))
        self.travel = self.distances.fastest * np.diff(self._instants)

    def certify(self, placed: Placements, passages: Passages, tolerance: float) -> list[Verdict]:
        """Prove of many edges that no sphere touches the robot on them, or refuse them.

        Args:
            placed: placements at the ends of the edges.
            passages: the edges.
            tolerance: clearance below which an edge may be refused [m].
        """
        begins, ends = self._instants[passages.slots], self._instants[passages.slots + 1]
        moved = np.linalg.norm(passages.steps, axis=1) + self.bounds.speeds[passages.layers]
        first = self._ends(placed, passages, begins, ends, inflated=True)
        verdicts = [Verdict(True, np.inf, 0.0, 0)] * len(begins)
        left = np.flatnonzero(first.sum(axis=1) <= moved + self.rounding)
        if not len(left):
            return verdicts
        some = passages.some(left)
        bare = self._ends(placed, some, begins[left], ends[left], inflated=False).tolist()
        for k, pair in enumerate(bare):
            edge = DebrisEdge(self, some, k)
            verdicts[left[k]] = certify(edge, (pair[0], pair[1]), tolerance)
        return verdicts

    def least_clearance(
        self, placed: Placements, passages: Passages, least: float, precision: float
    ) -> float:
        """Proven lower bound on the clearance from the spheres along edges that are free.

        Args:
            placed: placements at the ends of the edges.
            passages: the edges.
            least: a clearance that the path has somewhere; more than it is not looked at [m].
            precision: relative precision of the bound.

        Returns:
            The bound, or `least` where that is smaller [m].
        """
        begins, ends = self._instants[passages.slots], self._instants[passages.slots + 1]
        moved = np.linalg.norm(passages.steps, axis=1) + self.bounds.speeds[passages.layers]
        inflated = self._ends(placed, passages, begins, ends, inflated=True)
        margins, bound = inflated.sum(axis=1) - moved - self.rounding, least
        bare = self._ends(placed, passages, begins, ends, inflated=False)
        for k in np.flatnonzero(margins < 2.0 * least).tolist():
            edge, pair = DebrisEdge(self, passages, k), bare[k].tolist()
            found, least = clearance_bound(edge, (pair[0], pair[1]), least, precision)
            bound = min(bound, found)
        return bound

    def _ends(
        self, placed: Placements, passages: Passages, begins: Array, ends: Array, inflated: bool
    ) -> Array:
        """(k, 2) distances at both ends, spheres inflated by half of their paths if wanted [m]."""
        spread, far = (ends - begins) * inflated, np.full(len(begins), np.inf)
        found = [
            self.distances.least(placed, passages.corners[:, e], shifts, times, spread, far)
            for e, (shifts, times) in enumerate(((passages.tails, begins), (passages.heads, ends)))
        ]
        return np.stack(found, axis=1)

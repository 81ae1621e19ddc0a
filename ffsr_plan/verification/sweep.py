"""Distances all along a motion: samples, halved until nothing can be hidden between them.

Between two samples no point of a shape travels farther than its speed bound times the time between
them. To touch anything, it would have to cover the distance at one sample to get there, and that at
the other to get back. So nothing is hidden where the sum of both distances exceeds that travel.
Where it does not, a sample is taken in the middle.

A body that moves and a shape that it touches cover these distances together, so that the travel of
the body's points over the same time is added. Samples are even in the path; their times are those
of the pace.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.contacts import ShapeName
from ffsr_plan.verification.motion_samples import Course, Samples
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies

ROUNDING = 1e-9
"""Length [m] added to every travel, for rounding errors of distances."""
FINEST = 1e-8
"""Travel [m] between two samples below which an interval is not halved any more."""
MOST_SAMPLES = 2_000_000
"""Samples between the even ones after which intervals are not halved any more."""
CONFIRMED = 1e-6
"""The plan's proven clearance is confirmed up to this much [m]."""
_VALUES_AT_ONCE = 1_000_000  # distances in one block of samples
_SAMPLES_AT_ONCE = 2048
_MEASURED_AT_ONCE = 256  # distances of links, to find the least one
_TURN_ROUNDING = 1e-9  # [rad]

OnProgress = Callable[[float], object]


class Place(NamedTuple):
    """Something found on a motion.

    Attributes:
        value: a distance or a travel [m].
        edge: the edge.
        names: of the link, or the two links, concerned.
        body: the moving body concerned, in words; empty where it is none.
        time: when [s]; zero without a duration.
    """

    value: float
    edge: int
    names: tuple[str, ...]
    body: str = ""
    time: float = 0.0


class Swept:
    """What was found all along a motion.

    Attributes:
        clearance: least measured distance of a link to an obstacle; None without any.
        obstacle: that obstacle in words, where the distance is not positive.
        separation: least measured distance of two links that must not touch; None without any.
        clearance_bound: lower bound on the clearance at and between all samples [m].
        hidden: where two samples may hide a contact, and the travel between them: with an obstacle
            first, of two links second; None where nothing can be hidden.
        nodes: (m + 1,) clearances at the nodes [m].
        drift: largest distance of the centre of mass from where it was at the start [m].
        deviation: largest distance of joints and base from straight lines between nodes [m, rad].
        excess_turn: largest rotation of the base between two samples beyond its bound [rad].
        excess_ways: (B,) largest way or turn of each moving body beyond its bound [m, rad].
        samples: number of configurations.
        largest_step: longest way of any point of a shape between two samples [m].
        finite: whether all configurations are numbers.
    """

    def __init__(self, edges: int, bodies: int) -> None:
        self.excess_ways = np.zeros(bodies)
        self.clearance: Place | None = None
        self.obstacle: str = ShapeName("an obstacle")
        self.separation: Place | None = None
        self.clearance_bound = np.inf
        self.hidden: list[Place | None] = [None, None]
        self.nodes = np.full(edges + 1, np.inf)
        self.drift = self.deviation = self.largest_step = self.excess_turn = 0.0
        self.samples = 0
        self.finite = True


class _Intervals(NamedTuple):
    """Intervals.

    Attributes:
        edge: (n,) their edges.
        begin: (n,) places on these at which they begin, from 0 to 1.
        end: (n,) places at which they end.
        first: (n,) numbers of the samples at their begins.
        last: (n,) numbers of those at their ends.
        turn: (n,) bound on the angular velocity of the base [rad per edge].
        ways: (n, 1 + B + G) bounds on the travel of what is measured against: of the first, which
            is at rest, zero, then of each moving body, and of each class of debris [m].
    """

    edge: IntArray
    begin: Array
    end: Array
    first: IntArray
    last: IntArray
    turn: Array
    ways: Array

    def travel(self, interval: IntArray, speeds: Array, reach: Array) -> Array:
        """Travel of parts of the robot in intervals, by speeds and reaches of each [m]."""
        time = (self.end - self.begin)[interval]
        return np.asarray(time * (speeds + self.turn[interval] * reach) + ROUNDING)


class _Items(NamedTuple):
    """What is open: interval, part (shapes, then pairs), and its distances at both ends."""

    interval: IntArray
    part: IntArray
    at_first: Array
    at_last: Array

    def chosen(self, flags: Flags) -> _Items:
        return _Items(
            self.interval[flags], self.part[flags], self.at_first[flags], self.at_last[flags]
        )


def sweep(
    course: Course, bodies: Bodies, samples: int, on_progress: OnProgress | None = None
) -> Swept:
    """Measure distances all along a motion.

    Args:
        course: the motion.
        bodies: the robot, from its URDF.
        samples: least number of equal time steps on each edge.
        on_progress: called with the share that is done, from 0 to 1.
    """
    run = _Sweep(course, bodies, samples)
    total = run.course.edges * samples
    size = max(1, min(_SAMPLES_AT_ONCE, _VALUES_AT_ONCE // max(1, run.distances.parts)))
    for begin in range(0, total, size):
        run.block(begin, min(begin + size, total))
        if not run.found.finite:
            break
        if on_progress is not None:
            on_progress(min(begin + size, total) / total)
    run.name_obstacle()
    return run.found


class _Sweep:
    """A sweep under way."""

    def __init__(self, course: Course, bodies: Bodies, samples: int) -> None:
        self._per_edge = samples
        self.course, problem = course, course.problem
        self.distances = SampledDistances(bodies, problem.obstacles, problem.start[:3])
        self.found = Swept(course.edges, len(problem.scene.bodies))
        self._rates = rates = course.rates
        floats = problem.mode.floats
        speeds, reach = rates.afloat() if floats else (rates.shapes, rates.reach)
        shape_of, pairs = self.distances.shape_of, self.distances.pairs
        self._speeds = np.hstack(
            [speeds[:, shape_of] + course.base_speeds[:, None], rates.of_pairs(pairs)]
        )
        self._reach = np.append(reach[shape_of], np.zeros(len(pairs)))
        classes = np.full(len(self.distances.debris.speeds), ROUNDING)
        roundings = np.concatenate([[0.0], course.moving.roundings, classes])
        spare = roundings[self.distances.bodies]
        self._spare = ROUNDING + spare
        self._claim = course.clearance
        self._touching = course.touching
        self._ignored: Flags = np.zeros(self.distances.parts, dtype=np.bool_)
        if self._touching is not None:
            named = [names[0] in self._touching.links for names in self.distances.names]
            self._ignored = (self.distances.bodies == self._touching.body) & named
        self._start = course.at(np.zeros(1, dtype=np.int64), np.zeros(1)).centers_of_mass[0]
        self._halvings = 0
        self._nearest: tuple[Samples, int, int] | None = None

    def name_obstacle(self) -> None:
        """Note which obstacle the least distance is from, if it is touched."""
        least = self.found.clearance
        if least is not None and least.value <= 0.0 and self._nearest is not None:
            self.found.obstacle = self.distances.nearest_obstacle(*self._nearest)

    def block(self, begin: int, end: int) -> None:
        """The even intervals from `begin` to `end`, and what they are halved into."""
        points, parts = np.arange(begin, end + 1), np.arange(self.distances.parts)
        edge = np.minimum(points // self._per_edge, self.course.edges - 1)
        time = (points - edge * self._per_edge) / self._per_edge
        samples = self._sampled(edge, time)
        self.found.samples -= int(begin > 0)  # the first is the last of the block before
        if not self.found.finite:
            return
        self._samples, self._first_edge = samples, int(edge[0])
        order = np.arange(end - begin)
        last = np.where(edge[1:] > edge[:-1], 1.0, time[1:])
        intervals = self._intervals(edge[:-1], time[:-1], last, order, order + 1)
        which, part = np.repeat(order, len(parts)), np.tile(parts, len(order))
        travel = self._travel(intervals, which, part).reshape(len(order), len(parts))
        beside = np.maximum(np.vstack([travel[:1], travel]), np.vstack([travel, travel[-1:]]))
        middles = self.distances.middles(samples)
        self.distances.stretches(edge - edge[0], samples.instants, middles, beside)
        asked = np.repeat(points - begin, len(parts)), np.tile(parts, len(points))
        values = self._measured(samples, edge, *asked, beside.ravel())
        table = values.reshape(len(points), len(parts))
        nodes = points % self._per_edge == 0
        outer = table[nodes][:, : self.distances.outer]
        self.found.nodes[points[nodes] // self._per_edge] = outer.min(axis=1, initial=np.inf)
        items = _Items(which, part, table[:-1].ravel(), table[1:].ravel())
        while self.found.finite and len(items.interval):
            travel = self._travel(intervals, items.interval, items.part)
            is_open = self._judge(intervals, items, travel)
            intervals, items = self._halved(intervals, items.chosen(is_open), travel[is_open])

    def _sampled(self, edge: IntArray, time: Array) -> Samples:
        """Samples, and what they say of the motion itself."""
        samples, found = self.course.at(edge, time), self.found
        found.samples += len(edge)
        drift = float(np.linalg.norm(samples.centers_of_mass - self._start, axis=1).max())
        deviation = float(samples.deviation.max())
        found.drift, found.deviation = max(found.drift, drift), max(found.deviation, deviation)
        found.finite &= bool(np.isfinite(drift) and np.isfinite(deviation))
        return samples

    def _intervals(
        self, edge: IntArray, begin: Array, end: Array, first: IntArray, last: IntArray
    ) -> _Intervals:
        """Intervals, with a bound on the angular velocity of the base that both ends allow."""
        apart = end - begin
        if self.course.held_turns is not None:
            turn = self.course.held_turns[edge]
        else:
            momentum, rates, half = self._samples.momentum, self._samples.rates, 0.5 * apart
            turn = np.maximum(
                *(self._rates.turn(momentum.at(k), rates[k], edge, half) for k in (first, last))
            )
        turns = self._samples.base_turns
        sine = np.linalg.norm(turns[first] - turns[last], axis=(1, 2)) / np.sqrt(8.0)
        turned = 2.0 * np.arcsin(np.minimum(sine, 1.0))
        excess = float(np.max(turned - np.minimum(turn * apart, np.pi), initial=0.0))
        self.found.excess_turn = max(self.found.excess_turn, excess)
        return _Intervals(edge, begin, end, first, last, turn, self._ways(first, last))

    def _ways(self, first: IntArray, last: IntArray) -> Array:
        """(n, 1 + B + G) see `_Intervals`; that bodies keep to it is noted too."""
        bodies, found = self.course.moving, self.found
        poses, instants = self._samples.moving, self._samples.instants
        times = instants[first], np.maximum(instants[last], instants[first])
        excess = bodies.excess(poses.at(first), poses.at(last), *times)
        found.excess_ways = np.maximum(found.excess_ways, excess)
        debris = self.distances.debris.ways(*times)
        return np.column_stack([np.zeros(len(first)), bodies.ways(*times), debris])

    def _travel(self, intervals: _Intervals, interval: IntArray, part: IntArray) -> Array:
        """Travel of parts, and of what they are measured against, in intervals [m]."""
        own = intervals.travel(
            interval, self._speeds[intervals.edge[interval], part], self._reach[part]
        )
        return np.asarray(own + intervals.ways[interval, self.distances.bodies[part]])

    def _measured(
        self, samples: Samples, edge: IntArray, which: IntArray, part: IntArray, enough: Array
    ) -> Array:
        """Distances; the least ones are noted."""
        stretch = edge[which] - self._first_edge
        values = self.distances.at(samples, which, part, stretch, enough)
        if self._touching is not None:
            times, may = samples.instants[which], self._touching
            values[(times > may.since) & (times < may.until) & self._ignored[part]] = np.inf
        outer, found = part < self.distances.outer, self.found
        if outer.any():
            k = int(np.flatnonzero(outer)[np.argmin(values[outer])])
            if found.clearance is None or values[k] < found.clearance.value:
                time = samples.instants[which[k]]
                found.clearance = self._place(values[k], edge[which[k]], part[k], time)
                self._nearest = samples, int(which[k]), int(part[k])
        inner = np.flatnonzero(~outer)
        if found.separation is not None:
            inner = inner[values[inner] < found.separation.value]
        inner = inner[np.argsort(values[inner], kind="stable")]
        for begin in range(0, len(inner), _MEASURED_AT_ONCE):  # values are bounds here
            some = inner[begin : begin + _MEASURED_AT_ONCE]
            if found.separation is not None:
                some = some[values[some] < found.separation.value]
            if not len(some):
                break
            far = np.full(len(some), np.inf)
            exact = self.distances.at(samples, which[some], part[some], stretch[some], far)
            k = int(np.argmin(exact))
            if found.separation is None or exact[k] < found.separation.value:
                row = which[some[k]]
                time = samples.instants[row]
                found.separation = self._place(exact[k], edge[row], part[some[k]], time)
        return values

    def _place(self, value: float, edge: int, part: int, time: float) -> Place:
        names, body = self.distances.names[part], self.distances.body_name(part)
        return Place(float(value), int(edge), names, body, float(time))

    def _judge(self, intervals: _Intervals, items: _Items, travel: Array) -> Flags:
        """Which items have to be halved; the others are noted."""
        found, outer = self.found, items.part < self.distances.outer
        bound = 0.5 * (items.at_first + items.at_last - travel)
        nearest = found.clearance.value if found.clearance is not None else np.inf
        held = nearest >= self._claim - ROUNDING  # otherwise there is nothing to confirm
        enough = np.where(outer, max(self._claim - CONFIRMED, 0.0) if held else 0.0, 0.0)
        touching = np.minimum(items.at_first, items.at_last) <= 0.0
        is_open = ~((bound > 0.0) & (bound >= enough)) & ~touching
        ends_here = is_open & (travel - self._spare[items.part] <= FINEST)
        if self._halvings > MOST_SAMPLES:
            ends_here = is_open
        for k, flags in enumerate((outer, ~outer)):
            rest = np.flatnonzero(ends_here & flags & (bound <= 0.0))
            if len(rest):
                worst = rest[np.argmax(travel[rest])]
                interval, part = items.interval[worst], items.part[worst]
                edge, first = intervals.edge[interval], intervals.first[interval]
                time = self._samples.instants[first]
                place = self._place(travel[worst] - self._spare[part], edge, part, time)
                found.hidden[k] = max(filter(None, (found.hidden[k], place)))
        is_open &= ~ends_here
        done = ~is_open
        found.clearance_bound = min(found.clearance_bound, bound[done & outer].min(initial=np.inf))
        found.largest_step = max(found.largest_step, travel[done].max(initial=0.0))
        return is_open

    def _halved(
        self, intervals: _Intervals, items: _Items, travel: Array
    ) -> tuple[_Intervals, _Items]:
        """Both halves of the intervals of open items, with the distances at their middles."""
        chosen, inverse = np.unique(items.interval, return_inverse=True)
        of_item: IntArray = inverse.ravel()
        edge, begin, end = intervals.edge[chosen], intervals.begin[chosen], intervals.end[chosen]
        first, last = intervals.first[chosen], intervals.last[chosen]
        middle = 0.5 * (begin + end)
        if not len(chosen):
            return intervals, items
        samples = self._sampled(edge, middle)
        values = self._measured(samples, edge, of_item, items.part, travel)
        number = len(self._samples.base_turns) + np.arange(len(chosen))
        self._halvings += len(chosen)
        self._samples = self._samples.with_turns_of(samples)
        halves = self._intervals(
            np.tile(edge, 2), np.append(begin, middle), np.append(middle, end),
            np.append(first, number), np.append(number, last),
        )  # fmt: skip
        return halves, _Items(
            np.append(of_item, of_item + len(chosen)), np.tile(items.part, 2),
            np.append(items.at_first, values), np.append(values, items.at_last),
        )  # fmt: skip

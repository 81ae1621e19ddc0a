"""Refinement of a path's lateral offsets to a small change of velocity, polygon and curve proven.

Stations lie on the control polygon and on its curve, and offsets descend to a small change of
velocity (`descent`). They are lateral only: with layers free to move along the way too, a path
could jump across an obstacle between two of them. Then the edges of the polygon and the pieces of
the curve are proven free. Where one is refused, the place becomes a station.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.distances import Nearest
from ffsr_plan.collision.near_pairs import NearPairs
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.fuel.descent import Descent
from ffsr_plan.fuel.least_change_programme import Programme
from ffsr_plan.fuel.stations import Stations, on_curve, on_polygon, usual_stations
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

_SAME = 1e-6  # relative: changes that differ by less are equal
PROOFS = 8  # how often a path is proven and corrected
SPARE = 3.0  # clearance asked for at stations, in the tolerance of proofs
GROWTH = 1.6  # of that where edges are refused at stations


class RefinedOffsets(NamedTuple):
    """Offsets of control points; the edges between them and their curve are proven free.

    Attributes:
        offsets: (m + 1, 3) displacement of the base from the nominal positions [m].
        change: change of velocity for a flight of unit duration [m].
    """

    offsets: Array
    change: float


class BestRefined(NamedTuple):
    """The best of several descents.

    Attributes:
        start: name of its start.
        path: the path.
        cut_short: whether the deadline ended the descents.
    """

    start: str
    path: RefinedOffsets
    cut_short: bool


class FuelRefinement:
    """Descents from several starts over one lattice.

    Attributes:
        nearest: layer that was left, and link and obstacle that came too close on the edge that was
            refused last; None without any.
        edges_free: edges proven free so far.
        edges_refused: edges refused so far.
    """

    def __init__(
        self, lattice: LayeredLattice, prover: Prover, scene: Scene, deadline: Deadline
    ) -> None:
        """Prepare descents.

        Args:
            lattice: gives the nominal motion, the axes and their reach; one axis at least.
            prover: proofs along the lattice's nominal motion.
            scene: its obstacles, larger by the margin that is to be kept.
            deadline: after which descents raise `OutOfTime`.
        """
        problem, self._lattice, self._prover = lattice.problem, lattice, prover
        self._deadline, self._pairs = deadline, NearPairs(problem.robot, scene, deadline)
        axes = [getattr(problem.given_lattice, name) for name in problem.given_lattice.axes]
        rim = np.array([axis.half_count * axis.spacing for axis in axes])
        step = float(np.linalg.norm(problem.base_displacement)) / lattice.divisions
        self._programme = Programme.lateral(lattice.divisions, step, rim)
        self._descent = Descent(self._programme, self._pairs, lattice.directions, step)
        self._tolerance = problem.tolerance
        self.edges_free = self.edges_refused = 0
        self.nearest: tuple[int, Nearest] | None = None
        self._scene, self._node_queries, self._other_queries = scene, 0, 0
        self._queries_before = prover.queries

    def counts(self) -> Counts:
        """Edges decided and queries spent so far."""
        queries = self._prover.queries - self._queries_before + self._other_queries
        queries -= self._node_queries
        stations = self._node_queries + self._pairs.count
        return Counts(self.edges_free, self.edges_refused, stations, queries)

    def refined(self, offsets: Array) -> RefinedOffsets | None:
        """A path made better from a start, which need not be free.

        Args:
            offsets: (m + 1, 3) displacement of the base at the start of the descent [m].

        Returns:
            The path; None if none was proven.

        Raises:
            OutOfTime: at the deadline.
        """
        lattice = self._lattice
        present = offsets @ lattice.directions.T
        stations, spare = usual_stations(lattice.divisions), SPARE * self._tolerance
        for _ in range(PROOFS):
            q = lattice.nominal.at(stations.edges, stations.times)
            placed = shape_placements(lattice.problem.robot, q)
            present = self._descent.descended(placed, stations, present, spare)
            at = present @ lattice.directions
            refused = self._refused(at)
            if not len(refused.edges):
                change = lattice.divisions * self._programme.change(present)
                return RefinedOffsets(frozen(at), change)
            stations = stations.with_others(refused)
            spare *= GROWTH
        return None

    def _refused(self, offsets: Array) -> Stations:
        """Where edges of the polygon, or then pieces of the curve, are refused."""
        m, motion = self._lattice.divisions, self._lattice.nominal.displaced(offsets)
        edges, times = self._proven(self._prover, offsets)
        refused = on_polygon(edges, times)
        if not len(edges):  # a polygon that is refused has to change anyway
            control = control_points_on(motion, np.arange(m + 1.0))
            curve = CurvedMotion(motion, control)
            prover = Prover(curve, self._scene, self._tolerance, self._deadline)
            pieces, times = self._proven(prover, np.zeros((m + 1, 3)))
            self._other_queries += prover.queries
            refused = refused.with_others(on_curve(m, pieces, times))
        return refused

    def _proven(self, prover: Prover, offsets: Array) -> tuple[IntArray, Array]:
        """Edges not proven free, and times on them."""
        layers = np.arange(len(offsets))
        before = prover.queries
        clearances = prover.clearances(layers, offsets)
        self._node_queries += prover.queries - before
        ends = np.column_stack([clearances[:-1], clearances[1:]])
        verdicts = prover.certify_all(layers[:-1], offsets[:-1], offsets[1:], ends)
        free = np.array([verdict.free for verdict in verdicts])
        self.edges_free += int(np.count_nonzero(free))
        self.edges_refused += int(np.count_nonzero(~free))
        edges = np.flatnonzero(~free)
        for k in edges[:1].tolist():
            near = prover.nearest(k, offsets[k], offsets[k + 1], verdicts[k].time)
            self.nearest = k, near
        return edges, np.array([verdicts[k].time for k in edges.tolist()])


def best_refined(refinement: FuelRefinement, starts: dict[str, Array]) -> BestRefined | None:
    """The best of the descents from several starts.

    Args:
        refinement: the descents.
        starts: (m + 1, 3) offsets [m] by name; of equals the first wins.

    Returns:
        None if no path was proven. At the deadline, the best that was proven by then.

    Raises:
        OutOfTime: at the deadline, if none was proven by then.
    """
    best: BestRefined | None = None
    try:
        for name, offsets in starts.items():
            found = refinement.refined(offsets)
            if found is None:
                continue
            if best is None or found.change < best.path.change * (1.0 - _SAME):
                best = BestRefined(name, found, cut_short=False)
    except OutOfTime:
        if best is None:
            raise
        return best._replace(cut_short=True)
    return best

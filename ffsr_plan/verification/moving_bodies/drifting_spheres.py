"""Distances of placed solids to drifting spheres, in classes of similar speed.

Of a class the path of its fastest sphere is added to the travel of a solid. With classes a few fast
spheres do not make all others seem fast. On a stretch of a way only those spheres are listed that
can be the nearest one of their class to a solid; each is then placed anew at the time of a sample.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.distances.solid_arrays import SolidArrays
from ffsr_plan.verification.distances.solid_distance_kernels import near_spheres, sphere_distances
from ffsr_plan.verification.distances.sphere_blocks import sphere_blocks

_CLASSES, _FACTOR = 6, 3.0  # of speeds at most, and by which those of a class may differ
_AT_ONCE = 500_000  # spheres that are placed at once
_SPARE = 1e-6  # [m] by which the lists of near spheres are longer than they need to be

_Placed = tuple[SolidArrays, IntArray, Array, Array, Array, Array]


class DriftingSpheres:
    """Drifting spheres in G classes of speed.

    Attributes:
        speeds: (G,) of the fastest sphere of each class [m/s].
    """

    def __init__(self, clouds: Sequence[DebrisCloud], growth: float, origin: Array) -> None:
        """Put the spheres into classes.

        Args:
            clouds: the debris.
            growth: distance by which the spheres are grown [m].
            origin: (3,) point from which base positions are counted, world [m].
        """
        none = [np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3))]
        columns = [none, *([each.centers, each.radii, each.velocities] for each in clouds)]
        centers, radii, velocities = map(np.concatenate, zip(*columns, strict=True))
        self._centers, self._radii, self._velocities = centers - origin, radii + growth, velocities
        speeds = np.sqrt((velocities**2).sum(axis=1))
        most = float(np.max(speeds, initial=0.0))
        steps = np.log(np.maximum(most, 1e-300) / np.maximum(speeds, 1e-300)) / np.log(_FACTOR)
        number = np.minimum(np.floor(steps), _CLASSES - 1)
        self._members = [np.flatnonzero(number == k) for k in np.unique(number)]
        self.speeds: Array = np.array([speeds[own].max() for own in self._members])
        self._lists: list[tuple[IntArray, IntArray]] = []

    def ways(self, begins: Array, ends: Array) -> Array:
        """(N, G) longest path of a sphere of each class between times (N,) and (N,) [m]."""
        return np.asarray((ends - begins)[:, None] * self.speeds)

    def stretches(
        self, sizes: Array, stretch: IntArray, instants: Array, tracks: Array, travels: Array
    ) -> None:
        """List the spheres that can be the nearest ones to each solid on stretches of its way.

        Args:
            sizes: (s,) radius of the sphere about its middle that contains each solid [m].
            stretch: (N,) number of the stretch that each sample lies on, from 0, ascending.
            instants: (N,) times of the samples [s].
            tracks: (N, s, 3) middles of the solids at the samples.
            travels: (N, G, s) how much a solid and a sphere of a class may approach each other from
                the nearest sample on [m].
        """
        self._lists, count = [], int(stretch[-1]) + 1 if len(stretch) else 0
        for g, own in enumerate(self._members):
            found, starts = [np.zeros(0, dtype=np.int64)], [np.zeros(1, dtype=np.int64)]
            for k in range(count):
                rows = np.flatnonzero(stretch == k)
                track, times = tracks[rows], instants[rows]
                middle, time = 0.5 * (track.min(axis=0) + track.max(axis=0)), float(times.mean())
                reaches = np.linalg.norm(track - middle, axis=2).max(axis=0)
                reaches += travels[rows, g].max(axis=0) + _SPARE
                reaches += self.speeds[g] * float(np.abs(times - time).max())
                centers = self._centers[own] + time * self._velocities[own]
                blocks = sphere_blocks(centers, self._radii[own])
                near, begins = near_spheres(middle, reaches, sizes, blocks)
                starts.append(starts[-1][-1] + begins[1:])
                found.append(own[blocks.order[near]])
            self._lists.append((np.concatenate(found), np.concatenate(starts)))

    def at(self, placed: _Placed, group: IntArray, row: IntArray, instants: Array) -> Array:
        """Distances for some questions.

        Args:
            placed: solids and questions (q, 2), as kernels are told of them.
            group: (q,) the class of each question.
            row: (q,) its stretch times the number of solids, and its solid.
            instants: (q,) its time [s].

        Returns:
            (q,) signed distances [m].
        """
        result = np.empty(len(group))
        for g, (near, starts) in enumerate(self._lists):
            rows = np.flatnonzero(group == g)
            counts = np.cumsum(starts[row[rows] + 1] - starts[row[rows]])
            parts = np.unique(np.searchsorted(counts, np.arange(0, counts[-1:].sum(), _AT_ONCE)))
            for some in np.split(rows, parts[1:]):
                begins = starts[row[some]]
                result[some] = self._measured(
                    placed, some, near, begins, starts[row[some] + 1] - begins, instants[some]
                )
        return result

    def nearest(self, placed: _Placed, group: int, time: float) -> int:
        """Number of the sphere of a class that is nearest to a solid.

        Args:
            placed: solids and one question (1, 2).
            group: the class.
            time: [s].
        """
        own, solids, asked = self._members[group], placed[0], placed[1]
        order, centers = np.arange(len(own)), self._centers[own] + time * self._velocities[own]
        ranges = np.column_stack([order, order + 1])
        every = (solids, np.repeat(asked, len(own), axis=0), *placed[2:])
        found = sphere_distances(*every, centers, self._radii[own], order, ranges)
        return int(own[np.argmin(found)])

    def _measured(
        self,
        placed: _Placed,
        some: IntArray,
        near: IntArray,
        begins: IntArray,
        counts: IntArray,
        instants: Array,
    ) -> Array:
        """Least distances for the questions `some` (k,), whose lists begin where they do."""
        ends = np.cumsum(counts)
        total = int(ends[-1]) if len(ends) else 0
        entry = np.arange(total) + np.repeat(begins - ends + counts, counts)
        numbers, times = near[entry], np.repeat(instants, counts)
        centers = self._centers[numbers] + times[:, None] * self._velocities[numbers]
        questions = (placed[0], np.ascontiguousarray(placed[1][some]), *placed[2:])
        ranges, order = np.column_stack([ends - counts, ends]), np.arange(total)
        return sphere_distances(*questions, centers, self._radii[numbers], order, ranges)

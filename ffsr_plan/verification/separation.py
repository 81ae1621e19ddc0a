"""Distances of placed shapes: to the obstacles along a motion, and to one another.

Obstacles are spheres, shapes of other kinds, the outside of zones that the robot stays in, and
bodies that move, each where it is at the time of a sample.

The distances are computed by hand on purpose: python-fcl is the library from which Coal, the
planner's, was derived, and would not be independent of it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.contacts import ShapeName
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.scene_contents import cloud_title
from ffsr_plan.verification.distances.obstacle_arrays import (
    shape_arrays,
    zone_arrays,
)
from ffsr_plan.verification.distances.obstacle_distance_kernels import (
    shape_distances,
    zone_distances,
)
from ffsr_plan.verification.distances.solid_arrays import SolidArrays, solid_arrays
from ffsr_plan.verification.distances.solid_distance_kernels import (
    near_spheres,
    pair_distances,
    sphere_distances,
)
from ffsr_plan.verification.distances.sphere_blocks import sphere_blocks
from ffsr_plan.verification.motion_samples import Samples
from ffsr_plan.verification.moving_bodies.body_distances import BodyDistances
from ffsr_plan.verification.moving_bodies.drifting_spheres import DriftingSpheres
from ffsr_plan.verification.solids import Shape
from ffsr_plan.verification.urdf_reading import Bodies

_Placed = tuple[SolidArrays, IntArray, Array, Array, Array, Array]
_SHARP = 0.02  # [m] distances of links below this are exact; larger ones may be those of spheres
_SPARE = 1e-6  # [m] by which the lists of near obstacles are longer than they need to be


class SampledDistances:
    """Distances of a robot's parts.

    First come all shapes to the obstacles at rest, then all shapes to the first moving body, to the
    second one and so on, to each class of debris, and then the pairs of shapes.

    Attributes:
        shapes: number of shapes that are measured against obstacles at rest; 0 if there are none.
        outer: number of parts that are measured against obstacles, all that moves included.
        bodies: (parts,) number of the body or class of debris from 1 on; 0 of other parts.
        debris: the classes of debris.
        shape_of: (outer,) the shape of each of these parts.
        pairs: (p, 2) the shapes of each pair that must not touch.
        names: names of the links that each part belongs to.
        parts: number of parts.
    """

    def __init__(self, bodies: Bodies, scene: Scene, origin: Array) -> None:
        """Prepare distances.

        Args:
            bodies: the robot, from its URDF.
            scene: the obstacles.
            origin: (3,) point from which base positions are counted, world [m].
        """
        number = {shape: k for k, shape in enumerate(bodies.shapes)}
        pairs = bodies.pairs()
        self.debris = DriftingSpheres(scene.debris, scene.growth, origin)
        own, moving = len(bodies.shapes), len(scene.bodies) + len(self.debris.speeds)
        self.shapes = own if len(scene.at_rest) else 0
        self.outer = self.shapes + moving * own
        self.pairs: IntArray = np.array(
            [(number[a], number[b]) for a, b in pairs], dtype=np.int64
        ).reshape(-1, 2)
        order = np.arange(own)
        self.shape_of: IntArray = np.append(order[: self.shapes], np.tile(order, moving))
        self.names: list[tuple[str, ...]] = [(bodies.shapes[s].link,) for s in self.shape_of]
        self.names += [(a.link, b.link) for a, b in pairs]
        self.parts = len(self.names)
        self.bodies: IntArray = np.zeros(self.parts, dtype=np.int64)
        self.bodies[self.shapes : self.outer] = 1 + np.repeat(np.arange(moving), own)
        self._solids = arrays_of(bodies.shapes)
        self._scene, self._count = scene, len(scene.bodies)
        self._blocks = sphere_blocks(scene.centers - origin, scene.radii)
        self._obstacles, self._around = shape_arrays(scene.shapes, scene.growth, origin)
        self._zones = zone_arrays(scene.keep_in, scene.growth, origin)
        self._moving = BodyDistances(scene.bodies, scene.growth, self._solids)
        self.stretches(
            np.zeros(0, dtype=np.int64),
            np.zeros(0),
            np.zeros((0, own, 3)),
            np.zeros((0, self.outer)),
        )

    def middles(self, samples: Samples) -> Array:
        """(N, s, 3) middles of the shapes at some samples, from the origin of base positions."""
        inside = np.einsum("nsij,sj->nsi", samples.turns, self._solids.middles) + samples.places
        turned: Array = np.einsum("nij,nsj->nsi", samples.base_turns, inside)
        return turned + samples.base_places[:, None]

    def stretches(self, stretch: IntArray, instants: Array, tracks: Array, travels: Array) -> None:
        """List the obstacles that can be the nearest ones to each shape on stretches of its way.

        Args:
            stretch: (N,) number of the stretch that each sample lies on, from 0, ascending.
            instants: (N,) times of the samples [s].
            tracks: (N, s, 3) middles of the shapes at the samples.
            travels: (N, >= outer) how far the shape of each part, and what it is measured against
                together, may be from the nearest sample of its stretch [m].
        """
        count, shapes = int(stretch[-1]) + 1 if len(stretch) else 0, self.shapes
        middles, reaches = np.zeros((count, shapes, 3)), np.zeros((count, shapes))
        for k in range(count):
            track = tracks[stretch == k][:, :shapes]
            middles[k] = 0.5 * (track.min(axis=0) + track.max(axis=0))
            reaches[k] = np.linalg.norm(track - middles[k], axis=2).max(axis=0)
            reaches[k] += travels[stretch == k][:, :shapes].max(axis=0) + _SPARE
        sizes = np.tile(self._solids.radii[:shapes], count)
        way = middles.reshape(-1, 3), reaches.ravel(), sizes
        self._near, self._starts = near_spheres(*way, self._blocks)
        near, self._shape_starts = near_spheres(*way, self._around)
        self._near_shapes = self._around.order[near]
        own, classes = len(self._solids.radii), len(self.debris.speeds)
        beside = travels[:, self.outer - classes * own : self.outer]
        beside = beside.reshape(len(stretch), classes, own)
        self.debris.stretches(self._solids.radii, stretch, instants, tracks, beside)

    def at(
        self, samples: Samples, which: IntArray, part: IntArray, stretch: IntArray, enough: Array
    ) -> Array:
        """Distances at some samples.

        Args:
            samples: the samples.
            which: (q,) the sample of each question.
            part: (q,) the part of each question.
            stretch: (q,) the stretch that it lies on.
            enough: (q,) lower bound on the distance of two links that will do [m].

        Returns:
            (q,) signed distances to obstacles, and lower bounds on those of pairs [m].
        """
        found = np.empty(len(which))
        rest, inner = part < self.shapes, part >= self.outer
        asked = np.column_stack([which, part])
        begin = stretch[rest] * self.shapes + part[rest]
        found[rest] = self._to_obstacles(
            samples,
            asked[rest],
            np.column_stack([self._starts[begin], self._starts[begin + 1]]),
            np.column_stack([self._shape_starts[begin], self._shape_starts[begin + 1]]),
        )
        moving = ~rest & ~inner
        if moving.any():
            found[moving] = self._to_moving(samples, which[moving], part[moving], stretch[moving])
        asked[:, 1] -= self.outer
        found[inner] = pair_distances(
            self._solids, asked[inner], self.pairs, samples.turns, samples.places,
            np.maximum(enough[inner], _SHARP),
        )  # fmt: skip
        return found

    def _to_moving(
        self, samples: Samples, which: IntArray, part: IntArray, stretch: IntArray
    ) -> Array:
        """Distances to bodies and debris, for questions as of `at`."""
        shape, body = self.shape_of[part], self.bodies[part] - 1
        placed, bodies = self._placed(samples, np.column_stack([which, shape])), body < self._count
        found = np.empty(len(which))
        if bodies.any():
            asked = placed[1][bodies]
            found[bodies] = self._moving.at(asked, body[bodies], placed[2:], samples.moving)
        left = ~bodies
        if left.any():
            row = stretch[left] * len(self._solids.radii) + shape[left]
            some = (placed[0], placed[1][left], *placed[2:])
            group, instants = body[left] - self._count, samples.instants[which[left]]
            found[left] = self.debris.at(some, group, row, instants)
        return found

    def _to_obstacles(
        self, samples: Samples, asked: IntArray, spheres: IntArray, shapes: IntArray
    ) -> Array:
        """Distances to all obstacles, for questions (q, 2) and their lists (q, 2)."""
        placed = self._placed(samples, asked)
        found = sphere_distances(
            *placed, self._blocks.centers, self._blocks.radii, self._near, spheres
        )  # fmt: skip
        if len(self._zones.planes) + len(self._zones.balls):
            found = zone_distances(*placed, self._zones, found)
        if len(self._obstacles.radii):
            found = shape_distances(*placed, self._obstacles, self._near_shapes, shapes, found)
        return found

    def _placed(self, samples: Samples, asked: IntArray) -> _Placed:
        """What the kernels are told of solids and questions."""
        return (
            self._solids, asked, samples.turns, samples.places, samples.base_turns,
            samples.base_places,
        )  # fmt: skip

    def nearest_obstacle(self, samples: Samples, which: int, part: int) -> str:
        """The obstacle that is nearest to a shape, in words.

        Args:
            samples: the samples.
            which: one of them.
            part: the shape, among the obstacles at rest or a moving body.

        Returns:
            The name of a shape, zone, body or sphere of debris, "an obstacle" for other spheres.
        """
        scene = self._scene
        number = int(self.bodies[part]) - 1
        if number >= self._count:
            placed = self._placed(samples, np.array([[which, self.shape_of[part]]]))
            group, time = number - self._count, float(samples.instants[which])
            first = len(scene.at_rest) + self._count
            return scene.source_of(first + self.debris.nearest(placed, group, time))
        if body := self.body_name(part):
            return body
        spheres, shapes = len(scene.radii), len(scene.shapes)
        row = np.array([[which, part]], dtype=np.int64)

        def each(count: int) -> tuple[_Placed, IntArray, IntArray]:
            order = np.arange(count)
            ranges = np.column_stack([order, order + 1])
            return self._placed(samples, np.repeat(row, count, axis=0)), order, ranges

        placed, order, ranges = each(spheres)
        to_spheres = sphere_distances(
            *placed, self._blocks.centers, self._blocks.radii, order, ranges
        )
        placed, order, ranges = each(shapes)
        far = np.full(shapes, np.inf)
        to_shapes = shape_distances(*placed, self._obstacles, order, ranges, far)
        to_zones = [
            zone_distances(*self._placed(samples, row), self._zones.only(k), np.full(1, np.inf))
            for k in range(len(scene.keep_in))
        ]
        nearest = int(np.argmin(np.concatenate([to_spheres, to_shapes, *to_zones])))
        return ShapeName("an obstacle") if nearest < spheres else scene.source_of(nearest)

    def body_name(self, part: int) -> str:
        """The moving body, or debris, that a part is measured against; empty where it is none."""
        number, still = int(self.bodies[part]), len(self._scene.at_rest)
        if number > self._count:
            first, *others = self._scene.debris
            return "debris" if others else cloud_title(first, 0)
        return self._scene.source_of(still + number - 1) if number else ""

    def clearances(self, samples: Samples) -> Array:
        """(N,) least distances of any shape to an obstacle [m]; infinite without obstacles."""
        count, outer = len(samples.base_places), self.outer
        order = np.arange(count)
        still = np.zeros((count, outer))
        self.stretches(order, samples.instants, self.middles(samples), still)
        which, part = np.repeat(order, outer), np.tile(np.arange(outer), count)
        each = self.at(samples, which, part, which, np.zeros(len(which)))
        return np.min(each.reshape(count, outer), axis=1, initial=np.inf)


def arrays_of(shapes: Sequence[Shape]) -> SolidArrays:
    """Shapes as arrays for compiled functions.

    Args:
        shapes: the shapes.
    """
    return solid_arrays(
        [shape.points for shape in shapes],
        [shape.swell for shape in shapes],
        [shape.half for shape in shapes],
    )

"""The bodies of a scene at many times: their poses, and bounds on the travel of their points.

Let a body's reference point move by a path p and the body turn by an angle a, along the way, over
an interval of time. A point of the body at a distance r from the reference point has at any time
the velocity v + w x r, of which the norm is at most |v| + |w| r; so its way is at most p + a r. For
a spin, whose axis rests in the body, r is the distance from this axis. Bodies that are widened by a
radius count by what is widened: its distance from a robot, less the radius, is the clearance.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.body_motion import Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.distances.obstacle_arrays import shape_arrays
from ffsr_plan.verification.moving_bodies.body_courses import course_of
from ffsr_plan.verification.moving_bodies.turns import angles_between

_POSE_ROUNDING = 1e-10  # of poses [m] and [rad]
_WIDE = 3.0  # [rad] from which on an angle says nothing of a bound, up to half a turn


class BodyPoses(NamedTuple):
    """Poses of B bodies at N times.

    Attributes:
        places: (N, B, 3) reference points, from the origin of base positions, world axes [m].
        turns: (N, B, 3, 3) rotations of the bodies' axes, world axes.
    """

    places: Array
    turns: Array

    def at(self, rows: IntArray) -> BodyPoses:
        """The poses at some of the times."""
        return BodyPoses(self.places[rows], self.turns[rows])

    def followed_by(self, other: BodyPoses) -> BodyPoses:
        """These poses and those of other times behind them."""
        return BodyPoses(*map(np.concatenate, zip(self, other, strict=True)))


NO_BODIES = BodyPoses(np.zeros((0, 0, 3)), np.zeros((0, 0, 3, 3)))
"""Poses of no bodies at no times."""


class SceneBodies:
    """The bodies of a scene.

    Attributes:
        reaches: (B,) largest distance of a body's points from its reference point or axis [m].
        roundings: (B,) how far its points may be from where they are said to be [m].
    """

    def __init__(self, bodies: Sequence[MovingBody], origin: Array, until: float) -> None:
        """Prepare poses.

        Args:
            bodies: the bodies.
            origin: (3,) point from which base positions are counted, world [m].
            until: time up to which poses are asked for [s].

        Raises:
            IntegrationError: a tumble that cannot be integrated accurately.
        """
        self._courses, self._origin = [course_of(body, until) for body in bodies], origin
        self.reaches: Array = np.array([reach_of(body) for body in bodies])
        errors = np.array([course.error for course in self._courses])
        self.roundings: Array = (_POSE_ROUNDING + errors) * (1.0 + self.reaches)

    def poses(self, times: Array) -> BodyPoses:
        """Poses at times (N,) [s].

        Raises:
            InvalidInput: a function tells something that is no pose.
        """
        count, bodies = len(times), len(self._courses)
        places, turns = np.zeros((count, bodies, 3)), np.zeros((count, bodies, 3, 3))
        for k, course in enumerate(self._courses):
            places[:, k], turns[:, k] = course.poses(times)
        return BodyPoses(places - self._origin, turns)

    def ways(self, begins: Array, ends: Array) -> Array:
        """Bounds on the way of any point of each body in intervals of time.

        Args:
            begins: (N,) [s].
            ends: (N,) [s].

        Returns:
            (N, B) [m].
        """
        found = np.zeros((len(begins), len(self._courses)))
        for k, course in enumerate(self._courses):
            found[:, k] = course.paths(begins, ends)
            found[:, k] += course.angles(begins, ends) * self.reaches[k]
        return found + self.roundings

    def excess(self, first: BodyPoses, last: BodyPoses, begins: Array, ends: Array) -> Array:
        """By how much bodies move farther than their motion allows.

        Args:
            first: poses at the begins.
            last: poses at the ends.
            begins: (N,) [s].
            ends: (N,) [s].

        Returns:
            (B,) largest excess of the way of the reference point [m], or the angle [rad].
        """
        moved = np.linalg.norm(last.places - first.places, axis=2)
        turned = angles_between(first.turns, last.turns)
        found = np.zeros(len(self._courses))
        for k, course in enumerate(self._courses):
            far = moved[:, k] - course.paths(begins, ends)
            allowed = course.angles(begins, ends)
            wide = np.where(allowed < _WIDE, turned[:, k] - allowed, 0.0)
            found[k] = max(np.max(far, initial=0.0), np.max(wide, initial=0.0))
        return found


def reach_of(body: MovingBody) -> float:
    """Largest distance of a body's points from its reference point, of a spin from its axis [m].

    Args:
        body: the body; what its shapes are widened by does not count.
    """
    arrays, _ = shape_arrays(body.shapes, 0.0, np.zeros(3))
    middles = arrays.middles
    if isinstance(body.motion, Spin) and (rate := float(np.linalg.norm(body.motion.rate))) > 0.0:
        middles = np.cross(middles, body.motion.rate / rate)
    return float(np.max(np.linalg.norm(middles, axis=1) + arrays.radii - arrays.skins))

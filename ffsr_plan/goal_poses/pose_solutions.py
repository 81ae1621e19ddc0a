"""End configurations that meet a pose: the first one found, or several, the best ones first."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.contacts import goal_in_collision
from ffsr_plan.collision.distances import ObstacleQuery, SelfQuery
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.errors import GoalInCollision, InvalidInput
from ffsr_plan.goal_poses.descent import COARSE, DESCENTS, FINE, Descent
from ffsr_plan.goal_poses.pose_error import PoseTarget
from ffsr_plan.goal_poses.pose_out_of_reach import PoseOutOfReach
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

MOST_SOLUTIONS = 8
"""Solutions that are kept; arms with more joints than the pose needs have any number."""
ROOM = 0.05
"""Clearance [m] with which a solution has enough of it, so that the nearest comes first."""
_ROUNDED = 1e-6  # [m, rad] by which a pose given in rounded numbers may be missed
_DISTINCT = 0.3  # [rad or m] of a joint by which two solutions differ at least


class PoseSolution(NamedTuple):
    """An end configuration that meets the pose.

    Attributes:
        end: (nq,) configuration, base reaction included.
        change: size of the change of the joint values from the start [rad and m].
        obstacles: clearance from obstacles [m]; infinite if they are not looked at.
        links: distance of the robot's links from each other [m]; infinite likewise.
        detour: whether a joint goes a whole turn out of its way.
    """

    end: Array
    change: float
    obstacles: float
    links: float
    detour: bool

    @property
    def clearance(self) -> float:
        """The lesser of both distances [m]."""
        return min(self.obstacles, self.links)

    @property
    def rank(self) -> tuple[bool, float, float]:
        """What solutions are sorted by: those with room by distance, the others by clearance."""
        crowded = self.obstacles < ROOM
        return self.detour, -self.obstacles if crowded else -ROOM, self.change


class PoseSearch:
    """A search for end configurations that meet a pose and are free of collision."""

    def __init__(
        self, frame: str, target: PoseTarget, scene: Scene | None, rng: np.random.Generator
    ) -> None:
        """Prepare the search.

        Args:
            frame: name of the frame, for errors.
            target: what is wanted.
            scene: obstacles; if None, collisions are not checked, not even between links.
            rng: of the joint values at which descents begin.

        Raises:
            InvalidInput: no scene.
        """
        self._frame, self._robot, self._scene = frame, target.robot, scene
        self._descent, self._rng = Descent(target), rng
        self._distances = _Distances(target.robot, scene)
        self._best, self._least = self._descent.no_change, np.inf
        self._touching: list[PoseSolution] = []

    def first(self) -> Array:
        """(nq,) the first solution found.

        One in which a joint goes a whole turn out of its way is returned only if no other is found.

        Raises:
            PoseOutOfReach, GoalInCollision: see `several`.
        """
        detour: Array | None = None
        for solution in self._solutions(DESCENTS):
            if not solution.detour:
                return solution.end
            detour = solution.end if detour is None else detour
        return self._refined() if detour is None else detour

    def several(self, tries: int) -> Array:
        """(S, nq) solutions that differ by 0.3 rad or m of some joint, at most 8.

        Those clear of obstacles by 5 cm come first, the nearest to the start before others; then
        those with less room, the clearest first. Ways on which a joint goes a whole turn out of its
        way come last.

        Args:
            tries: number of descents.

        Raises:
            PoseOutOfReach: there is none; the best configuration, without its cause.
            GoalInCollision: there are some in collision only.
        """
        kept: list[Array] = []
        for solution in sorted(self._solutions(tries), key=lambda each: each.rank):
            changes = [self._robot.joint_change(other, solution.end) for other in kept]
            if all(np.abs(change).max() > _DISTINCT for change in changes):
                kept.append(solution.end)
        return frozen(np.array(kept[:MOST_SOLUTIONS] or [self._refined()]))

    def _solutions(self, tries: int) -> Iterator[PoseSolution]:
        """Solutions that are free of collision, as they are found."""
        descent = self._descent
        for attempt in range(tries):
            first = descent.no_change if attempt == 0 else descent.random_change(self._rng)
            change = descent.run(first, COARSE)
            error = float(np.linalg.norm(descent.error(change)))
            if error < self._least:
                self._best, self._least = change, error
            for candidate in descent.solutions(change):
                solution = self._solution(candidate)
                if solution.clearance > 0.0:
                    yield solution
                else:
                    self._touching.append(solution)

    def _solution(self, change: Array) -> PoseSolution:
        end = self._descent.end(change)
        turns = bool(self._descent.turns(change).any())
        return PoseSolution(
            frozen(end), float(np.linalg.norm(change)), *self._distances.of(end), turns
        )

    def _refined(self) -> Array:
        """(nq,) the best configuration, if a pose given in rounded numbers is met there."""
        descent = self._descent
        best = descent.run(self._best, FINE)
        best = next(iter(descent.solutions(best)), best)
        rest, solution = descent.error(best), self._solution(best)
        if np.linalg.norm(rest) < _ROUNDED:
            if not self._touching and solution.clearance > 0.0:
                return solution.end
            raise self._in_collision([*self._touching, solution])
        rotation_error = float(np.linalg.norm(rest[3:])) if len(rest) > 3 else None
        raise PoseOutOfReach(
            self._frame, float(np.linalg.norm(rest[:3])), rotation_error, solution.end
        )

    def _in_collision(self, touching: list[PoseSolution]) -> GoalInCollision:
        """The error for solutions in collision, with what touches at the clearest of them."""
        assert self._scene is not None
        clearest = max(touching, key=lambda solution: solution.clearance)
        error = goal_in_collision(self._robot, self._scene, clearest.end)
        error.advice = ("another seed", "another pose or base position", *error.advice)
        return error


class _Distances:
    """Distances of a configuration from obstacles, and of links from one another."""

    def __init__(self, robot: SpaceRobot, scene: Scene | None) -> None:
        if scene is not None and not isinstance(scene, Scene):
            raise InvalidInput("scene", scene, "a Scene, or None")
        self._queries: list[ObstacleQuery | SelfQuery] = []
        if scene is not None:
            self._queries = [ObstacleQuery(robot, scene), SelfQuery(robot)]

    def of(self, q: Array) -> tuple[float, float]:
        """Both distances [m], infinite where nothing is looked at."""
        if not self._queries:
            return np.inf, np.inf
        obstacles, links = (
            np.inf if query.empty else query.nearest(q).distance for query in self._queries
        )
        return obstacles, links

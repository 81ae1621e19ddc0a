"""Inverse kinematics at the true end of a motion: goals given by the pose of an end effector."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.collision.contacts import goal_in_collision
from ffsr_plan.collision.distances import ObstacleQuery, SelfQuery
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, whole_number
from ffsr_plan.core.errors import (
    GoalInCollision,
    HeldBase,
    InvalidInput,
    PoseOutOfReach,
)
from ffsr_plan.core.rotations import angle_between, from_angles, matrix
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.problem.pose_error import (
    PoseTarget,
    end_configuration,
    end_of_path,
    pose_error,
    pose_jacobian,
)
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

POSE_TOLERANCE = 1e-8
"""Norm of the pose error [m and rad] below which a pose counts as met."""
_ROUNDED = 1e-6  # [m, rad] by which a pose given in rounded numbers may be missed
_DESCENTS = 16
_COARSE, _FINE = (1e-2, 80), (1e-15, 200)
# relative change of the squared error at which a descent ends, and its most evaluations
_TURN_ROUNDING = 1e-9  # of a turn
_BEYOND_HALF_TURN = np.pi + 0.5
# [rad] to which descents may rotate a continuous joint: half a turn itself lies well inside


def inverse_kinematics(
    robot: SpaceRobot,
    scene: Scene | None,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None = None,
    *,
    start: ArrayLike,
    mode: Mode | str = Mode.FREE_FLYING,
    base_position: ArrayLike | None = None,
    base_attitude: ArrayLike | None = None,
    seed: int = 0,
) -> Array:
    """A goal configuration at which a frame has the wanted pose, within the joint limits.

    A plan from `start` ends with this configuration on a lattice without posture axes. With posture
    axes it takes `Problem(..., reach_attitude=True)`, which `Problem.reaching` and scenario files
    set: without it the base arrives at another attitude, and the frame misses its pose.

    The search is local (damped least squares), from the start's joint values and then from random
    ones. Revolute joints leave out whole turns where wheels hold the base; where the base reacts, a
    pose is preferred at which no joint rotates by more than half a turn.

    Args:
        robot: the robot.
        scene: obstacles. Joint values at which a link touches one of them, or another link, are
            rejected. If None, collisions are not checked, not even between links.
        frame: name of a link (first), joint or other frame of the model, such as a tool.
        position: (3,) wanted for the frame's origin, world [m].
        attitude: (3,) wanted for the frame, ZYX angles [rad]; None if any is accepted.
        start: (nq,) configuration at the beginning of the motion.
        mode: what actuates the base; see `Problem`.
        base_position: (3,) base origin at the end if thrusters move it [m]; None for the start's.
        base_attitude: (3,) base attitude at the end, where wheels hold it, ZYX angles [rad]; None
            for the start's.
        seed: of the random joint values, a whole number >= 0.

    Returns:
        (nq,) configuration, base reaction included; the pose is met to 1e-6 m and rad.

    Raises:
        InvalidInput: an argument that is not allowed.
        PoseOutOfReach: no joint values were found; with the error of the best ones.
        GoalInCollision: the pose was met in collision only; with all that touches there.
    """
    target = pose_target(
        robot,
        frame,
        position,
        attitude,
        start=start,
        mode=Mode.parse("mode", mode),
        base_position=base_position,
        base_attitude=base_attitude,
    )
    rng = np.random.default_rng(whole_number("seed", seed, at_least=0))
    try:
        return _solution(frame, _Descent(target), _CollisionCheck(robot, scene), rng)
    except PoseOutOfReach as error:
        raise _explained(error, target) from None


def pose_target(
    robot: SpaceRobot,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None,
    *,
    start: ArrayLike,
    mode: Mode,
    base_position: ArrayLike | None = None,
    base_attitude: ArrayLike | None = None,
) -> PoseTarget:
    """The arguments of `inverse_kinematics`, checked.

    Raises:
        InvalidInput: an argument that is not allowed.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if robot.nd == 0:
        raise InvalidInput("robot", robot.name, "a robot with joints")
    index = frame_index(robot.model, frame)
    if base_position is not None and mode.floats:
        raise InvalidInput(
            "base_position",
            base_position,
            "None in the mode free-floating: it follows from the arms",
        )
    if base_attitude is not None and mode.attitude_reacts:
        raise InvalidInput(
            "base_attitude", base_attitude, f"None in the mode {mode}: it follows from the arms"
        )
    begin = robot.check_configuration("start", start)
    end = begin[:3] if base_position is None else base_position
    held = begin[3:7]
    if base_attitude is not None:
        held = from_angles(finite_array("base_attitude", base_attitude, (3,)))
    rotation = None
    if attitude is not None:
        rotation = matrix(from_angles(finite_array("attitude", attitude, (3,))))
    return PoseTarget(
        robot,
        index,
        finite_array("position", position, (3,), FARTHEST),
        rotation,
        mode,
        begin,
        finite_array("base_position", end, (3,), FARTHEST),
        held,
    )


def _solution(
    frame: str, descent: _Descent, collides: _CollisionCheck, rng: np.random.Generator
) -> Array:
    """(nq,) the first end configuration found that meets the pose and is free of collision.

    One in which a joint goes a whole turn out of its way is returned only if no other is found.
    """
    collision: Array | None = None
    best, least, detour = descent.no_change, np.inf, None
    for attempt in range(_DESCENTS):
        first = descent.no_change if attempt == 0 else descent.random_change(rng)
        change = descent.run(first, _COARSE)
        error = float(np.linalg.norm(descent.error(change)))
        if error < least:
            best, least = change, error
        for candidate in descent.solutions(change):
            end = descent.end(candidate)
            if collides(end):
                collision = end if collision is None else collision
            elif not descent.turns(candidate).any():
                return frozen(end)
            elif detour is None:
                detour = candidate
    if detour is not None:
        return frozen(descent.end(detour))
    best = descent.run(best, _FINE)
    best = next(iter(descent.solutions(best)), best)
    rest, q = descent.error(best), descent.end(best)
    if np.linalg.norm(rest) < _ROUNDED:
        if collision is None and not collides(q):
            return frozen(q)
        raise collides.error(q if collision is None else collision)
    rotation_error = float(np.linalg.norm(rest[3:])) if len(rest) > 3 else None
    raise PoseOutOfReach(frame, float(np.linalg.norm(rest[:3])), rotation_error, frozen(q))


def _explained(error: PoseOutOfReach, target: PoseTarget) -> PoseOutOfReach:
    """The error, with what a held base and a free attitude of the frame would reach."""
    held = _of_held_base(target) if target.mode.attitude_reacts else None
    without = None
    if target.rotation is not None:
        descents = _descents(_Descent(target._replace(rotation=None)))
        without = any(missed < POSE_TOLERANCE for missed, _ in descents)
    advice = ["leave out the attitude: the position alone is reached"] if without else []
    if held is None:
        advice.append(f"{_better_place(target)}, or another base_attitude")
    elif held.reached:
        place = "" if target.mode.floats else " or base_position"
        advice += [
            "the mode attitude-held, if the robot has wheels",
            f"another start{place}, nearer or turned against the reaction",
            "another seed",
        ]
    else:
        advice.append(_better_place(target))
    return PoseOutOfReach(
        error.frame,
        error.position_missed,
        error.attitude_missed,
        error.configuration,
        held,
        without,
        tuple(advice),
    )


def _of_held_base(target: PoseTarget) -> HeldBase:
    """What a held base reaches; of several ways, the one that the reaction falsifies least."""
    quat = target.start[3:7]
    descents = _descents(_Descent(target._replace(mode=Mode.ATTITUDE_HELD, base_quat=quat)))
    reached = [change for missed, change in descents if missed < POSE_TOLERANCE]
    least = min(descents, key=lambda descent: descent[0])[1]
    effects = []
    for change in reached or [least]:
        end = _Descent(target).end(change)
        rotation = float(angle_between(quat, end[3:7]))
        effects.append((float(np.linalg.norm(pose_error(target, end)[:3])), rotation))
    missed, rotation = min(effects)
    if not reached:
        held = target._replace(mode=Mode.ATTITUDE_HELD, base_quat=quat)
        missed = float(np.linalg.norm(pose_error(held, _Descent(held).end(least))[:3]))
    return HeldBase(bool(reached), rotation, missed)


def _better_place(target: PoseTarget) -> str:
    """Where the base should be instead, from how closely a held base reaches the pose from there.

    The pose may be too far from the base, or too close to it.
    """
    quat = target.start[3:7] if target.mode.attitude_reacts else target.base_quat
    held = target._replace(mode=Mode.ATTITUDE_HELD, base_quat=quat)
    least = _least_error(held)
    away = target.base_position - target.position
    distance = float(np.linalg.norm(away))
    what, found = "another start" if target.mode.floats else "another base_position", ""
    for words, sign in (("farther from", 1.0), ("nearer to", -1.0)):
        step = sign * min(least, 0.9 * distance) / max(distance, 1e-9)
        moved = held._replace(base_position=target.base_position + step * away)
        missed = _least_error(moved)
        if missed < 0.9 * least:
            least, found = missed, f", {words} the pose"
    return what + found


def _least_error(target: PoseTarget) -> float:
    return min(error for error, _ in _descents(_Descent(target)))


def _descents(descent: _Descent) -> list[tuple[float, Array]]:
    """Error and change (nd,) at the end of each descent, always from the same first changes."""
    rng = np.random.default_rng(0)
    firsts = [descent.no_change, *(descent.random_change(rng) for _ in range(_DESCENTS - 1))]
    changes = [descent.run(first, _COARSE) for first in firsts]
    return [(float(np.linalg.norm(descent.error(change))), change) for change in changes]


class _CollisionCheck:
    """Whether a configuration touches an obstacle, or links touch one another."""

    def __init__(self, robot: SpaceRobot, scene: Scene | None) -> None:
        if scene is not None and not isinstance(scene, Scene):
            raise InvalidInput("scene", scene, "a Scene, or None")
        self._robot, self._scene = robot, scene
        self._queries: list[ObstacleQuery | SelfQuery] = []
        if scene is not None:
            self._queries = [ObstacleQuery(robot, scene), SelfQuery(robot)]

    def __call__(self, q: Array) -> bool:
        queries = (query for query in self._queries if not query.empty)
        return any(query.nearest(q).distance <= 0.0 for query in queries)

    def error(self, q: Array) -> GoalInCollision:
        """The error for a configuration in collision."""
        assert self._scene is not None
        error = goal_in_collision(self._robot, self._scene, q)
        error.advice = ("another seed", *error.advice)
        return error


class _Descent:
    """Damped least squares over the changes of the joint values (nd,) from start to end."""

    def __init__(self, target: PoseTarget) -> None:
        robot = target.robot
        self._target, self._begin = target, robot.joint_values(target.start)
        continuous = np.isinf(robot.upper)
        self._low = np.where(continuous, -_BEYOND_HALF_TURN, robot.lower - self._begin)
        self._high = np.where(continuous, _BEYOND_HALF_TURN, robot.upper - self._begin)
        self._free = self._high - self._low > 1e-9  # the others are fixed by their limits
        self._turning = ~robot.prismatic

    @property
    def no_change(self) -> Array:
        """(nd,) zeros: the joint values of the start."""
        return np.zeros_like(self._begin)

    def random_change(self, rng: np.random.Generator) -> Array:
        """(nd,) uniform within the limits, revolute joints by at most half a turn."""
        # more than half a turn only makes the path longer
        most = np.where(self._target.robot.prismatic, np.inf, np.pi)
        return rng.uniform(np.maximum(self._low, -most), np.minimum(self._high, most))

    def run(self, first: Array, effort: tuple[float, int]) -> Array:
        """(nd,) local minimum of the squared pose error near a first change (nd,)."""
        from scipy.optimize import least_squares

        low, high, free = self._low, self._high, self._free
        if not free.any():
            return np.clip(first, low, high)
        margin = 1e-6 * (high - low)  # the solver needs an interior point
        result = least_squares(
            lambda values: self._error_of_path(self._whole(values)),
            np.clip(first, low + margin, high - margin)[free],
            lambda values: self._jacobian(self._whole(values))[:, free],
            (low[free], high[free]),
            xtol=1e-14,
            ftol=effort[0],
            gtol=1e-14,
            max_nfev=effort[1],
        )
        return self._whole(result.x)

    def turns(self, change: Array) -> Array:
        """(nd,) whole turns by which a revolute joint may change less, within its limits."""
        whole = 2.0 * np.pi
        turns = np.where(self._turning, np.rint(change / whole), 0.0)
        least = np.ceil((change - self._high) / whole - _TURN_ROUNDING)
        most = np.floor((change - self._low) / whole + _TURN_ROUNDING)
        return np.asarray(np.clip(turns, np.minimum(least, 0.0), np.maximum(most, 0.0)))

    def solutions(self, change: Array) -> list[Array]:
        """The changes (nd,) of `change`, with and without needless turns, that meet the pose.

        Those without turns come first. A whole turn leaves all links where they are, but not a base
        that reacts to it; then the pose is approached again from the change without the turns.
        """
        if np.linalg.norm(self._error_of_path(change)) >= POSE_TOLERANCE:
            return []
        changes, turns = [change], self.turns(change)
        if turns.any():
            less = np.clip(change - 2.0 * np.pi * turns, self._low, self._high)
            reacts = self._target.mode.attitude_reacts
            changes.insert(0, self.run(less, _COARSE) if reacts else less)
        return [each for each in changes if np.linalg.norm(self.error(each)) < POSE_TOLERANCE]

    def end(self, change: Array) -> Array:
        return end_configuration(self._target, self._begin + change)

    def error(self, change: Array) -> Array:
        return pose_error(self._target, self.end(change))

    def _error_of_path(self, change: Array) -> Array:
        """Like `error`, but smooth where a continuous joint goes beyond half a turn."""
        return pose_error(self._target, end_of_path(self._target, self._begin, change))

    def _whole(self, values: Array) -> Array:
        change: Array = np.clip(0.0, self._low, self._high)
        change[self._free] = values
        return change

    def _jacobian(self, change: Array) -> Array:
        return pose_jacobian(self._target, self._begin, change)

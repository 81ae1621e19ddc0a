"""Inverse kinematics at the true end of a motion: goals given by the pose of an end effector."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, whole_number
from ffsr_plan.core.errors import GoalInCollision, InvalidInput, PoseOutOfReach
from ffsr_plan.core.rotations import from_angles, matrix
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.problem.pose_error import PoseTarget, end_configuration, pose_error, pose_jacobian
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

POSE_TOLERANCE = 1e-8
"""Norm of the pose error [m and rad] below which a pose counts as met."""
_DESCENTS = 16
_COARSE, _FINE = (1e-2, 80), (1e-15, 200)
# relative change of the squared error at which a descent ends, and its most evaluations
_HALF_TURN = np.pi - 1e-6  # [rad] most that a continuous joint rotates; pi has two directions


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

    A plan from `start` ends with this configuration on a lattice without posture axes; with posture
    axes, `Problem(..., reach_attitude=True)` brings the base to its attitude. The search is local
    (damped least squares): from the start's joint values first, then from random ones, until the
    pose is met.

    Args:
        robot: the robot.
        scene: obstacles. Joint values at which a link touches one of them, or another link, are
            rejected. If None, collisions are not checked, not even between links.
        frame: name of a link, joint or other frame of the model, such as a tool; of a link and a
            joint of one name, the link.
        position: (3,) wanted for the frame's origin, world [m].
        attitude: (3,) wanted for the frame, ZYX angles (alpha, beta, gamma) [rad]; None if any is
            accepted.
        start: (nq,) configuration at the beginning of the motion.
        mode: what actuates the base; see `Problem`.
        base_position: (3,) base origin at the end of the motion, world [m]; None for the start's.
            Not allowed in the mode `free-floating`.
        base_attitude: (3,) base attitude at the end of the motion, ZYX angles [rad]; None for the
            start's. Allowed in the mode `attitude-held` only.
        seed: of the random joint values, a whole number >= 0.

    Returns:
        (nq,) configuration, base reaction included; the pose is met to 1e-8 m and rad.

    Raises:
        InvalidInput: an argument that is not allowed.
        PoseOutOfReach: no joint values were found; with the error of the best ones.
        GoalInCollision: the pose was met in collision only; with the first collision found.
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
    return _solution(frame, _Descent(target), _CollisionCheck(robot, scene), rng)


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
    index = robot.frame_index(frame)
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
    """(nq,) the first end configuration found that meets the pose and is free of collision."""
    collision: Nearest | None = None
    best, least = descent.no_change, np.inf
    for attempt in range(_DESCENTS):
        first = descent.no_change if attempt == 0 else descent.random_change(rng)
        change = descent.run(first, _COARSE)
        error = float(np.linalg.norm(descent.error(change)))
        if error < least:
            best, least = change, error
        if error < POSE_TOLERANCE:
            contact = collides(descent.end(change))
            if contact is None:
                return frozen(descent.end(change))
            collision = collision or contact
    best = descent.run(best, _FINE)
    rest, q = descent.error(best), descent.end(best)
    if np.linalg.norm(rest) < POSE_TOLERANCE:
        contact = collision or collides(q)
        if contact is None:
            return frozen(q)
        raise GoalInCollision(contact.link, contact.obstacle, -contact.distance)
    rotation_error = float(np.linalg.norm(rest[3:])) if len(rest) > 3 else None
    raise PoseOutOfReach(frame, float(np.linalg.norm(rest[:3])), rotation_error, frozen(q))


class _CollisionCheck:
    """The first contact of a configuration with an obstacle or between links, if any."""

    def __init__(self, robot: SpaceRobot, scene: Scene | None) -> None:
        if scene is not None and not isinstance(scene, Scene):
            raise InvalidInput("scene", scene, "a Scene, or None")
        self._queries: list[ObstacleQuery | SelfQuery] = []
        if scene is not None:
            self._queries = [ObstacleQuery(robot, scene), SelfQuery(robot)]

    def __call__(self, q: Array) -> Nearest | None:
        results = (query.nearest(q) for query in self._queries if not query.empty)
        return next((result for result in results if result.distance <= 0.0), None)


class _Descent:
    """Damped least squares over the changes of the joint values (nd,) from start to end."""

    def __init__(self, target: PoseTarget) -> None:
        robot = target.robot
        self._target, self._begin = target, robot.joint_values(target.start)
        continuous = np.isinf(robot.upper)
        self._low = np.where(continuous, -_HALF_TURN, robot.lower - self._begin)
        self._high = np.where(continuous, _HALF_TURN, robot.upper - self._begin)
        self._free = self._high - self._low > 1e-9  # the others are fixed by their limits

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
            lambda values: self.error(self._whole(values)),
            np.clip(first, low + margin, high - margin)[free],
            lambda values: self._jacobian(self._whole(values))[:, free],
            (low[free], high[free]),
            xtol=1e-14,
            ftol=effort[0],
            gtol=1e-14,
            max_nfev=effort[1],
        )
        return self._whole(result.x)

    def end(self, change: Array) -> Array:
        return end_configuration(self._target, self._begin + change)

    def error(self, change: Array) -> Array:
        return pose_error(self._target, self.end(change))

    def _whole(self, values: Array) -> Array:
        change: Array = np.clip(0.0, self._low, self._high)
        change[self._free] = values
        return change

    def _jacobian(self, change: Array) -> Array:
        return pose_jacobian(self._target, self._begin, change)

"""Goals given by the pose of an end effector: the joint values that bring it there.

A plan moves the joints steadily from start to goal, and the base answers on the way. Where the base
ends, and with it the end effector, therefore depends on the way, not on the goal's joint values
alone: poses are taken at the true end of the straight joint path. With theta the joint values there
and D the rotation of the base at the end of the path for each unit of change of theta, base axes,
the pose changes by

    J = J_mode + [-[r]x; 1] R (D - A)

J_mode is the Jacobian of a robot that moves on from there: the generalized one in the mode
free-floating, the ordinary one where wheels hold the base, and in the mode free-flying the ordinary
one with the turn of the base, A (`momentum.connection`). The rest is what the way adds, a turn
about the centre of mass where the base floats and about the base's origin where it flies; r leads
from there to the end effector. It is the holonomy of the thin triangle between two joint paths.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array, whole_number
from ffsr_plan.core.errors import GoalInCollision, InvalidInput, PoseOutOfReach, unknown_name
from ffsr_plan.core.rotations import from_angles, inverse, log, matrix, multiply
from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.dynamics.momentum import connection, generalized_jacobian
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

REACHED = 1e-8
"""Metres and radians by which a pose may be missed."""
_STARTS = 16
_COARSE, _FINE = (1e-2, 80), (1e-15, 200)
# relative change of the squared error at which a descent ends, and most poses that it looks at
_DIFFERENCE = 1e-6  # of joint values, for D
_HALF_TURN = np.pi - 1e-6  # most that a continuous joint turns: half a turn has two directions


class _Target(NamedTuple):
    """What is to be met."""

    robot: SpaceRobot
    frame: int
    position: Array
    rotation: Array | None
    mode: Mode
    start: Array
    base_position: Array
    base_quat: Array


def inverse_kinematics(
    robot: SpaceRobot,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None = None,
    *,
    start: ArrayLike,
    mode: Mode | str = Mode.FREE_FLYING,
    base_position: ArrayLike | None = None,
    base_attitude: ArrayLike | None = None,
    scene: Scene | None = None,
    seed: int = 0,
) -> Array:
    """A goal configuration at which a frame has the wanted pose, joint limits kept.

    The configuration is the one that a plan from `start` ends with, on a lattice without posture
    axes; with posture axes, `Problem(..., reach_attitude=True)` brings the base to its attitude.
    The search is local (damped least squares): from the start's joint values, then from others
    drawn from the seed, until a pose is met.

    Args:
        robot: the robot.
        frame: name of a link, joint or other frame of the model, such as a tool.
        position: (3,) wanted for the frame's origin, world [m].
        attitude: (3,) wanted for the frame, ZYX angles (alpha, beta, gamma) [rad]; None if any
            will do.
        start: (nq,) configuration that the motion begins with.
        mode: what actuates the base; see `Problem`.
        base_position: (3,) where thrusters take the base origin, world [m]; None to stay at the
            start's. Not to be given in the mode `free-floating`.
        base_attitude: (3,) where wheels turn the base, ZYX angles [rad]; None to keep the start's.
            In the mode `attitude-held` only.
        scene: obstacles; with them, joint values at which a link touches one of them, or another
            link, are passed over. None to look at neither.
        seed: a whole number >= 0.

    Returns:
        (nq,) configuration, base reaction included; the pose is met to 1e-8 m and rad.

    Raises:
        InvalidInput: an argument that is not allowed.
        PoseOutOfReach: no joint values were found; with what the best ones miss the pose by.
        GoalInCollision: the pose was met, but always in collision; with the first one found.
    """
    target = _checked(
        robot, frame, position, attitude, start, Mode.parse("mode", mode),
        base_position, base_attitude,
    )  # fmt: skip
    rng = np.random.default_rng(whole_number("seed", seed, at_least=0))
    begin = robot.joint_values(target.start)
    turning = np.isinf(robot.upper)
    low = np.where(turning, -_HALF_TURN, robot.lower - begin)
    high = np.where(turning, _HALF_TURN, robot.upper - begin)
    turn = np.where(robot.prismatic, np.inf, np.pi)  # turns beyond only make the way longer
    nearby = np.maximum(low, -turn), np.minimum(high, turn)
    descent = _Descent(target, begin, low, high)
    touches = _Touches(robot, scene)
    touched: Nearest | None = None
    best, least = np.zeros(robot.nd), np.inf
    for attempt in range(_STARTS):
        first = np.zeros(robot.nd) if attempt == 0 else rng.uniform(*nearby)
        found = descent.run(first, _COARSE)
        missed = float(np.linalg.norm(descent.missed(found)))
        if missed < least:
            best, least = found, missed
        if missed < REACHED:
            near = touches(descent.end(found))
            if near is None:
                return frozen(descent.end(found))
            touched = touched or near
    best = descent.run(best, _FINE)
    rest, q = descent.missed(best), descent.end(best)
    if np.linalg.norm(rest) < REACHED:
        near = touched or touches(q)
        if near is None:
            return frozen(q)
        raise GoalInCollision(near.link, near.obstacle, -near.distance)
    turned = None if attitude is None else float(np.linalg.norm(rest[3:]))
    raise PoseOutOfReach(frame, float(np.linalg.norm(rest[:3])), turned, frozen(q))


def _checked(
    robot: SpaceRobot, frame: str, position: ArrayLike, attitude: ArrayLike | None,
    start: ArrayLike, mode: Mode, base_position: ArrayLike | None, base_attitude: ArrayLike | None,
) -> _Target:  # fmt: skip
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if robot.nd == 0:
        raise InvalidInput("robot", robot.name, "a robot with joints")
    if not isinstance(frame, str) or not robot.model.existFrame(frame):
        raise unknown_name("frame", frame, [f.name for f in robot.model.frames])
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
    given = begin[:3] if base_position is None else base_position
    held = begin[3:7]
    if base_attitude is not None:
        held = from_angles(finite_array("base_attitude", base_attitude, (3,)))
    return _Target(
        robot,
        robot.model.getFrameId(frame),
        finite_array("position", position, (3,), FARTHEST),
        None if attitude is None else matrix(from_angles(finite_array("attitude", attitude, (3,)))),
        mode,
        begin,
        finite_array("base_position", given, (3,), FARTHEST),
        held,
    )


class _Touches:
    """What a configuration is in collision with, if anything; nothing without a scene."""

    def __init__(self, robot: SpaceRobot, scene: Scene | None) -> None:
        if scene is not None and not isinstance(scene, Scene):
            raise InvalidInput("scene", scene, "a Scene, or None")
        self._queries: list[ObstacleQuery | SelfQuery] = []
        if scene is not None:
            self._queries = [ObstacleQuery(robot, scene), SelfQuery(robot)]

    def __call__(self, q: Array) -> Nearest | None:
        found = (query.nearest(q) for query in self._queries if not query.empty)
        return next((near for near in found if near.distance <= 0.0), None)


class _Descent:
    """Damped least squares over the changes of the joints (nd,) from their values at the start."""

    def __init__(self, target: _Target, begin: Array, low: Array, high: Array) -> None:
        self._target, self._begin = target, begin
        self._free = high - low > 1e-9  # the others are held by their limits
        self._low, self._high = low, high

    def run(self, first: Array, effort: tuple[float, int]) -> Array:
        """The change with the least error that is found from `first` on."""
        from scipy.optimize import least_squares

        low, high, free = self._low, self._high, self._free
        if not free.any():
            return np.clip(first, low, high)
        rim = 1e-6 * (high - low)  # the solver begins inside
        found = least_squares(
            lambda values: self.missed(self._whole(values)),
            np.clip(first, low + rim, high - rim)[free],
            lambda values: self._slope(self._whole(values))[:, free],
            (low[free], high[free]),
            xtol=1e-14, ftol=effort[0], gtol=1e-14, max_nfev=effort[1],
        )  # fmt: skip
        return self._whole(found.x)

    def end(self, change: Array) -> Array:
        return _end(self._target, self._begin + change)

    def missed(self, change: Array) -> Array:
        return _missed(self._target, self.end(change))

    def _whole(self, values: Array) -> Array:
        change: Array = np.clip(0.0, self._low, self._high)
        change[self._free] = values
        return change

    def _slope(self, change: Array) -> Array:
        return _jacobian(self._target, self._begin, change)


def _end(target: _Target, joint_values: Array) -> Array:
    """(nq,) where the straight joint path from the start to joint values (nd,) ends."""
    robot = target.robot
    within = np.clip(joint_values, robot.lower, robot.upper)
    goal = robot.assemble(target.base_position, target.base_quat, within)
    places = np.array([target.start[:3], target.base_position])
    motion = Motion(robot, target.mode, target.start, goal, places)
    return np.asarray(motion.configurations()[-1])


def _missed(target: _Target, q: Array) -> Array:
    """(3,) or (6,) position [m] and rotation vector [rad] beyond the wanted pose, world axes."""
    pose = _pose(target, q)
    apart = pose.translation - target.position
    if target.rotation is None:
        return np.asarray(apart)
    return np.concatenate([apart, pin.log3(pose.rotation @ target.rotation.T)])


def _pose(target: _Target, q: Array) -> pin.SE3:
    model = target.robot.model
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return pin.updateFramePlacement(model, data, target.frame)


def _jacobian(target: _Target, begin: Array, change: Array) -> Array:
    """(3, nd) or (6, nd) slope of `_missed` by the joint values at the end of the path."""
    robot, q = target.robot, _end(target, begin + change)
    model, data, pose = robot.model, robot.model.createData(), _pose(target, q)
    if target.mode.floats:
        slope = generalized_jacobian(robot, q, model.frames[target.frame].name)
    else:
        whole = pin.computeFrameJacobian(model, data, q, target.frame, pin.LOCAL_WORLD_ALIGNED)
        slope = np.array(whole[:, 6:])
        if target.mode is Mode.FREE_FLYING:
            slope += whole[:, 3:6] @ connection(robot, q)
    if target.mode.attitude_reacts:
        floats = target.mode.floats
        lever = pose.translation - (pin.centerOfMass(model, data, q) if floats else q[:3])
        beyond = _turn_by_way(robot, begin, change) - connection(robot, q)
        turn = matrix(q[3:7]) @ beyond
        slope += np.vstack([-pin.skew(lever) @ turn, turn])
    if target.rotation is None:
        return np.asarray(slope[:3])
    # from angular velocity to the rate of the rotation vector
    slope[3:] = pin.Jlog3(pose.rotation @ target.rotation.T).T @ slope[3:]
    return np.asarray(slope)


def _turn_by_way(robot: SpaceRobot, begin: Array, change: Array) -> Array:
    """D, (3, nd): turn at the end of the path, in its base axes, for each unit of joint change."""
    steps = change + _DIFFERENCE * np.vstack([np.zeros(robot.nd), np.eye(robot.nd)])
    begins = np.tile(begin, (len(steps), 1))
    ends = Reaction(robot, begins, steps).increments
    return np.asarray(log(multiply(inverse(ends[:1]), ends[1:])).T / _DIFFERENCE)

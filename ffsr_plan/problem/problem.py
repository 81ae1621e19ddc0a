"""`Problem`: robot, obstacles, start, goal and the settings of lattice and objective."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.bodies.pace import Pace
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import html_table
from ffsr_plan.core.rotations import angle_between, rotation_vector, to_angles
from ffsr_plan.core.setting_rules import InstanceOf, Number, Truth, Vector
from ffsr_plan.core.settings import Given, setting, settings
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.goal_poses.descent import DESCENTS
from ffsr_plan.goal_poses.inverse_kinematics import goals_at_pose
from ffsr_plan.problem.base_window import Window, default_window
from ffsr_plan.problem.configuration_rules import Configuration, Configurations, ModeName
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.timing_rules import check_duration, check_progress
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

_LEAST, _LARGEST = 1e-9, 1e9  # of weights and units: no product of them overflows
_FARTHEST_TRAVEL = 500.0  # [rad or m] of a joint; the reaction is worked out every 0.025
_SAME_ATTITUDE = 1e-9  # [rad]
_SAME = 1e-12  # metres or radians by which two positions or joint values may differ and be equal


@settings
class Problem:
    """A planning problem. Two are equal if all their fields are.

    Attributes:
        robot: the robot.
        scene: the obstacles.
        start: (nq,) start configuration.
        goal: (nq,) goal configuration. In the mode `free-flying` its attitude is not demanded: the
            attitude follows from the arms' motion. In the mode `free-floating` its position is not
            demanded either. Joints go straight to its values, a revolute one with limits beyond a
            turn the longer way too, if the values say so; continuous ones go the shorter way.
        mode: what actuates the base. `free-flying`: thrusters translate it along the lattice,
            acting through the centre of mass; the attitude reacts to the arms. `attitude-held`:
            wheels hold the attitude interpolated from start to goal, through the smaller angle; of
            half a turn, within 2e-10 rad, in the sense that is positive about the first axis of the
            base (x, y, z) that takes part. `free-floating`: attitude and
            position react; the centre of mass stays where it is.
        lattice: layers and offsets that the path is sought on; None for any path of the base within
            the window and of the joints within their limits.
        delta: clearance weight of Eq. 8, in units of length squared, >= 0.
        length_unit: metres per unit of length in F. The paper gives no unit, and F is not
            scale-free: the unit decides how much delta weighs.
        clearance_cap: clearance [m] beyond which more distance does not reduce F, or None.
        position_weight: metres of length per metre of translation (Eq. 4).
        rotation_weight: metres of length per radian of joint or held-base rotation (Eq. 4).
        tolerance: clearance [m] below which an edge may count as blocked.
        reach_attitude: whether the arms have to bring the base to the goal's attitude, within 1e-8
            rad; in the modes whose attitude reacts, on a lattice with posture axes or without one.
        window: (2, 3) least and greatest coordinates of the base origin in the world [m], where
            thrusters move it and there is no lattice; along an axis on which both are equal it
            stays where it is. None for the box around start and goal, larger on all sides by half
            their distance and the robot's reach; flat where all joint axes are parallel to an axis
            of the world that start and goal do not differ along.
        min_clearance: distance [m] from all obstacles that is kept, as proven as that nothing is
            touched. Clearances of plans, and those in F, count beyond it.
        alternatives: (A, nq) further goals, any of which may be reached instead; at the same base
            position where thrusters move it, and attitude where wheels hold it. `TreePlanner` takes
            the one whose path costs least, planners on a lattice take `goal`. The problem of a plan
            has the goal that was reached, and no alternatives.
        duration: time from start to goal [s], needed where bodies move: a path is run at the pace
            that `ramp` states, and proven for that pace. None where all is at rest.
        ramp: share of the duration in which the robot speeds up evenly, and in which it slows down
            at the end, 0 to 0.5; between, and with 0, layers follow one another at equal times.

    Raises:
        InvalidInput: naming the field, its value and what is allowed.
    """

    robot: Annotated[SpaceRobot, InstanceOf(SpaceRobot)]
    scene: Annotated[Scene, InstanceOf(Scene)]
    start: Annotated[Vector, Configuration()]
    goal: Annotated[Vector, Configuration()]
    mode: Annotated[Given[Mode, Mode | str], ModeName()] = setting(default=Mode.FREE_FLYING)
    lattice: Lattice | None = None
    delta: Annotated[float, Number(at_least=0.0, at_most=_LARGEST)] = 0.0
    length_unit: Annotated[float, Number(at_least=_LEAST, at_most=_LARGEST)] = 1.0
    clearance_cap: Annotated[float, Number(at_least=_LEAST, at_most=_LARGEST)] | None = None
    position_weight: Annotated[float, Number(at_least=_LEAST, at_most=_LARGEST)] = 1.0
    rotation_weight: Annotated[float, Number(at_least=0.0, at_most=_LARGEST)] = 1.0
    tolerance: Annotated[float, Number(at_least=1e-7, at_most=_LARGEST)] = 1e-4
    reach_attitude: Annotated[bool, Truth()] = False
    window: Annotated[Given[Array | None, ArrayLike | None], Window()] = setting(default=None)
    min_clearance: Annotated[float, Number(at_least=0.0, at_most=_LARGEST)] = 0.0
    alternatives: Annotated[Given[Array, ArrayLike], Configurations()] = setting(default=())
    duration: Annotated[float, Number(above=0.0, at_most=_LARGEST)] | None = None
    ramp: Annotated[float, Number(at_least=0.0, at_most=0.5)] = 0.0

    def __post_init__(self) -> None:
        self._check_travel()
        self._check_attitude()
        self._check_displacement()
        self._check_window()
        self._check_clearance()
        self._check_alternatives()
        check_duration(self.scene, self.duration, self.ramp)
        if self.lattice is not None:
            check_progress(self.lattice, self.mode, self.base_displacement)

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value}" for name, value in self._summary())
        return f"Problem({fields})"

    def _repr_html_(self) -> str:
        return html_table("Problem", dict(self._summary()))

    def reaching(
        self,
        frame: str,
        position: ArrayLike,
        attitude: ArrayLike | None = None,
        *,
        seed: int = 0,
        tries: int | None = None,
    ) -> Problem:
        """The same problem with goals at which a frame has the wanted pose.

        As far as the mode prescribes the base pose, it is that of the present goal. On a lattice
        with posture axes, or without a lattice, the base has to arrive at the attitude that belongs
        to the pose. See `inverse_kinematics`.

        Several joint values that meet the pose and touch nothing are looked for. Those clear of
        obstacles by 5 cm come first, the nearest to the start before others. The first are the
        `goal`, the others, at most 7, the `alternatives`.

        Args:
            frame: name of a link, joint or other frame of the model.
            position: (3,) wanted for the frame's origin, world [m].
            attitude: (3,) wanted for the frame, ZYX angles [rad]; None if any will do.
            seed: a whole number >= 0.
            tries: joint values from which the pose is approached: those of the start, and random
                ones. None for 16 without a lattice; on a lattice, whose planners take one goal,
                for as many as it takes to find one.

        Raises:
            InvalidInput: an argument that is not allowed.
            PoseOutOfReach: no joint values were found; with the error of the best ones, and why.
            GoalInCollision: all joint values found are in collision.

        Returns:
            The new problem; this one does not change.
        """
        held = self.mode.has_wheels
        if tries is None and self.lattice is None:
            tries = DESCENTS
        goals = goals_at_pose(
            self.robot,
            self.obstacles.at(self.duration or 0.0),
            frame,
            position,
            attitude,
            start=self.start,
            mode=self.mode,
            base_position=None if self.mode.floats else self.goal[:3],
            base_attitude=to_angles(self.goal[3:7]) if held else None,
            seed=seed,
            tries=tries,
        )
        turns = self.lattice is None or bool(self.lattice.postures)
        return replace(
            self, goal=goals[0], alternatives=goals[1:], reach_attitude=turns and not held
        )

    @property
    def goals(self) -> Array:
        """(1 + A, nq) the goal and its alternatives."""
        return frozen(np.vstack([self.goal, self.alternatives]))

    def ending_at(self, q: ArrayLike) -> Problem:
        """The same problem with one goal: of all of them, the one nearest to a configuration.

        Revolute joints count as equal a whole turn apart; those with limits take the value in q.

        Args:
            q: (nq,) configuration, such as the end of a motion.
        """
        robot, end = self.robot, self.robot.check_configuration("q", q)
        if not len(self.alternatives) and np.array_equal(end[7:], self.goal[7:]):
            return self
        goals = [self._turned_to(goal, end) for goal in self.goals]
        apart = [
            float(np.linalg.norm(robot.joint_change(end, goal)))
            + float(angle_between(end[3:7], goal[3:7])) * self.reach_attitude
            for goal in goals
        ]
        nearest = goals[int(np.argmin(apart))]
        if not len(self.alternatives) and np.array_equal(nearest, self.goal):
            return self
        return replace(self, goal=nearest, alternatives=())

    def _turned_to(self, goal: Array, end: Array) -> Array:
        """(nq,) a goal, its revolute joints with limits turned to the value in `end`, or close."""
        robot, values = self.robot, self.robot.joint_values(goal)
        turns = np.round((robot.joint_values(end) - values) / (2.0 * np.pi))
        turned = values + 2.0 * np.pi * np.where(
            robot.prismatic | np.isinf(robot.upper), 0.0, turns
        )
        if not np.any(turns) or np.any((turned < robot.lower) | (turned > robot.upper)):
            return goal
        return frozen(robot.assemble(goal[:3], goal[3:7], turned))

    @cached_property
    def obstacles(self) -> Scene:
        """The scene, its spheres larger by `min_clearance`: what plans keep clear of."""
        return self.scene.grown(self.min_clearance)

    @property
    def base_displacement(self) -> Array:
        """(3,) from the base's start to its goal, world axes [m]; zero where it floats."""
        if self.mode.floats:
            return frozen(np.zeros(3))
        return frozen(self.goal[:3] - self.start[:3])

    def pace(self, edges: int) -> Pace | None:
        """The pace of a path of so many equal edges; None without a duration."""
        return None if self.duration is None else Pace(self.duration, self.ramp, edges)

    @cached_property
    def joint_displacement(self) -> Array:
        """(nd,) change of the joint values [rad or m]; continuous joints take the shorter way."""
        return frozen(self.robot.joint_change(self.start, self.goal))

    @property
    def held_rotation(self) -> float:
        """Angle from the start's to the goal's attitude [rad] if wheels hold it, otherwise 0."""
        if self.mode.attitude_reacts:
            return 0.0
        vector = rotation_vector(self.start[3:7], self.goal[3:7])
        return float(np.linalg.norm(vector, axis=-1))

    @cached_property
    def straight_length(self) -> float:
        """Length of the straight way from start to goal [m]: weighted norm of what is prescribed.

        Of the ways round of a continuous joint the shorter one counts, so that no path is shorter.
        """
        slide = self.robot.prismatic
        joints = self.joint_displacement
        metres = np.concatenate([self.base_displacement, joints[slide]]) * self.position_weight
        radians = np.append(joints[~slide], self.held_rotation) * self.rotation_weight
        return float(np.sqrt(np.sum(metres**2) + np.sum(radians**2)))

    @cached_property
    def delta_d(self) -> float:
        """Length of one layer's nominal step, Eq. 4 [m]."""
        return self.straight_length / self.given_lattice.divisions

    @property
    def given_lattice(self) -> Lattice:
        """The lattice, for all that works on a lattice only.

        Raises:
            InvalidInput: the problem has none.
        """
        if self.lattice is None:
            raise InvalidInput("problem", self, "a problem with a lattice")
        return self.lattice

    @property
    def base_window(self) -> Array:
        """(2, 3) least and greatest coordinates of the base origin without a lattice [m]."""
        if self.window is not None:
            return self.window
        return frozen(
            default_window(self.robot, self.start, self.start[:3] + self.base_displacement)
        )

    def _check_travel(self) -> None:
        """Raise `InvalidInput` for joints that travel so far that the reaction takes too long."""
        self._check_way("goal", self.goal)
        allowed = f"at most {_FARTHEST_TRAVEL:g} rad or m"
        begin = self.robot.joint_values(self.start)
        for k, axis in enumerate(self.lattice.postures if self.lattice else ()):
            way = float(np.max(np.abs(axis.displacement(self.robot, begin)), initial=0.0))
            farthest = way * float(np.max(np.abs(axis.factors(np.array(axis.indices)))))
            if farthest > _FARTHEST_TRAVEL:
                raise InvalidInput(f"lattice postures.{k}, displacement", farthest, allowed)

    def _check_attitude(self) -> None:
        """Raise `InvalidInput` if `reach_attitude` is set and cannot be."""
        if self.reach_attitude and self.mode.has_wheels:
            raise InvalidInput("reach_attitude", True, "False where wheels hold the attitude")
        if self.reach_attitude and not self.robot.nd:
            allowed = "False for a robot without joints, whose base does not react"
            raise InvalidInput("reach_attitude", True, allowed)
        if self.reach_attitude and self.lattice and not self.lattice.postures:
            allowed = "a lattice with posture axes, or none"
            raise InvalidInput("reach_attitude", True, allowed)

    def _check_displacement(self) -> None:
        """Raise `InvalidInput` if nothing has to move, or an axis has no direction of travel."""
        translates = float(np.linalg.norm(self.base_displacement)) > _SAME
        joints_move = float(np.max(np.abs(self.joint_displacement), initial=0.0)) > _SAME
        rotates = self.held_rotation > _SAME
        if not (translates or joints_move or rotates or self.reach_attitude):
            allowed = "a configuration that differs from the start in what the mode moves"
            if np.linalg.norm(self.goal[:7] - self.start[:7]) > _SAME:
                allowed += "; a base that reacts reaches an attitude with reach_attitude=True alone"
            raise InvalidInput("goal", self.goal.tolist(), allowed)
        if not translates and self.lattice is not None and self.lattice.axes:
            raise InvalidInput(
                "lattice",
                f"{' and '.join(self.lattice.axes)} axis, "
                + ("no thrusters" if self.mode.floats else "start and goal at one position"),
                "no lateral or normal axis where there is no direction of travel",
            )

    def _check_window(self) -> None:
        """Raise `InvalidInput` for a window that is of no use, or without start or goal in it."""
        if self.window is None:
            return
        if self.lattice is not None:
            raise InvalidInput(
                "window", self.window.tolist(), "None on a lattice, whose axes count"
            )
        if self.mode.floats:
            raise InvalidInput("window", self.window.tolist(), f"None in the mode {self.mode}")
        for name, place in (("start", self.start[:3]), ("goal", self.goal[:3])):
            if np.any(place < self.window[0] - _SAME) or np.any(place > self.window[1] + _SAME):
                allowed = f"a window that holds the base at the {name}, {place.tolist()}"
                raise InvalidInput("window", self.window.tolist(), allowed)

    def _check_clearance(self) -> None:
        """Raise `InvalidInput` if an obstacle and the clearance from it are too large together."""
        most = _LARGEST - float(np.max(self.scene.radii, initial=0.0))
        if self.min_clearance > most:
            allowed = f"at most {most:g} m, with the largest obstacle"
            raise InvalidInput("min_clearance", self.min_clearance, allowed)

    def _check_alternatives(self) -> None:
        """Raise `InvalidInput` for alternatives that prescribe another base pose, or go too far."""
        for k, goal in enumerate(self.alternatives):
            if self.mode.has_thrusters and np.abs(goal[:3] - self.goal[:3]).max() > _SAME:
                allowed = f"the base position of the goal, {self.goal[:3].tolist()}"
                raise InvalidInput(f"alternatives.{k}, base position", goal[:3].tolist(), allowed)
            angle = float(angle_between(goal[3:7], self.goal[3:7]))
            if self.mode.has_wheels and angle > _SAME_ATTITUDE:
                allowed = "the base attitude of the goal, where wheels hold it"
                raise InvalidInput(f"alternatives.{k}, base attitude", goal[3:7].tolist(), allowed)
            self._check_way(f"alternatives.{k}", goal)

    def _check_way(self, what: str, goal: Array) -> None:
        """Raise `InvalidInput` for joints that travel so far that the reaction takes too long."""
        travel = self.robot.joint_change(self.start, goal)
        for name, change in zip(self.robot.joint_names, travel, strict=True):
            if abs(change) > _FARTHEST_TRAVEL:
                allowed = f"at most {_FARTHEST_TRAVEL:g} rad or m"
                raise InvalidInput(f"{what} (joint {name}, travel)", float(change), allowed)

    def _summary(self) -> list[tuple[str, str]]:
        """Names and values for representations."""
        return [
            ("robot", self.robot.name),
            ("mode", str(self.mode)),
            ("obstacles", self.scene.contents),
            ("lattice", "none" if self.lattice is None else self.lattice.summary),
            ("delta", f"{self.delta:g}"),
            ("length_unit", f"{self.length_unit:g} m"),
        ]

"""`Problem`: everything that defines what is to be planned, checked once, immutable after."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import number, truth
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import angle_between, to_angles
from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.problem.end_effector_goal import inverse_kinematics
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

_SAME = 1e-12  # below this, two places or joint values count as one


@dataclass(frozen=True, eq=False)
class Problem:
    """A planning problem.

    Attributes:
        robot: the robot.
        scene: the obstacles.
        start: (nq,) start configuration.
        goal: (nq,) goal configuration. In the mode `free-flying` its attitude is not demanded: the
            attitude follows from the arms' motion. In the mode `free-floating` its position is not
            demanded either.
        mode: `free-flying` (thrusters translate the base along the lattice, acting through the
            centre of mass; the attitude reacts to the arms), `attitude-held` (wheels hold the
            attitude interpolated from start to goal) or `free-floating` (nothing actuates the
            base: attitude and position react, the centre of mass stays put).
        lattice: layers and offsets.
        delta: weight of nearness to obstacles in Eq. 8, in units of length squared, >= 0.
        length_unit: metres per unit of length in F. The paper gives no unit, and F is not
            scale-free: it decides what delta weighs.
        clearance_cap: clearance [m] beyond which more distance counts no further, or None.
        position_weight: metres of length per metre of translation (Eq. 4).
        rotation_weight: metres of length per radian of joint or held-base rotation (Eq. 4).
        tolerance: clearance [m] below which an edge may count as blocked.
        reach_attitude: whether the arms are to bring the base to the goal's attitude; in the modes
            whose attitude reacts, on a lattice with posture axes.
    """

    robot: SpaceRobot
    scene: Scene
    start: Array
    goal: Array
    mode: Mode = Mode.FREE_FLYING
    lattice: Lattice = field(default_factory=Lattice)
    delta: float = 0.0
    length_unit: float = 1.0
    clearance_cap: float | None = None
    position_weight: float = 1.0
    rotation_weight: float = 1.0
    tolerance: float = 1e-4
    reach_attitude: bool = False

    def __init__(  # the annotations differ from the fields': anything array-like may come in
        self,
        robot: SpaceRobot,
        scene: Scene,
        start: ArrayLike,
        goal: ArrayLike,
        mode: Mode | str = Mode.FREE_FLYING,
        lattice: Lattice | None = None,
        delta: float = 0.0,
        length_unit: float = 1.0,
        clearance_cap: float | None = None,
        position_weight: float = 1.0,
        rotation_weight: float = 1.0,
        tolerance: float = 1e-4,
        reach_attitude: bool = False,
    ) -> None:
        """Check and freeze the problem.

        Raises:
            InvalidInput: naming the field, its value and what is allowed.
        """
        kinds: dict[str, tuple[object, type]] = {
            "robot": (robot, SpaceRobot),
            "scene": (scene, Scene),
            "lattice": (Lattice() if lattice is None else lattice, Lattice),
        }
        for name, (given, kind) in kinds.items():
            if not isinstance(given, kind):
                raise InvalidInput(name, given, f"a {kind.__name__}")
        values = {
            "robot": robot,
            "scene": scene,
            "start": robot.check_configuration("start", start),
            "goal": robot.check_configuration("goal", goal),
            "mode": Mode.parse("mode", mode),
            "lattice": lattice or Lattice(),
            "delta": number("delta", delta, at_least=0.0),
            "length_unit": number("length_unit", length_unit, above=0.0),
            "clearance_cap": None
            if clearance_cap is None
            else number("clearance_cap", clearance_cap, above=0.0),
            "position_weight": number("position_weight", position_weight, above=0.0),
            "rotation_weight": number("rotation_weight", rotation_weight, at_least=0.0),
            "tolerance": number("tolerance", tolerance, at_least=1e-7),
            "reach_attitude": truth("reach_attitude", reach_attitude),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        self._check_that_something_is_to_be_done()

    def reaching(
        self, frame: str, position: ArrayLike, attitude: ArrayLike | None = None, *, seed: int = 0
    ) -> Problem:
        """The same problem with a goal at which a frame has the wanted pose.

        The base goes where the goal has it now, as far as the mode prescribes it; on a lattice
        with posture axes it has to reach the attitude that follows. See `inverse_kinematics`.

        Args:
            frame: name of a link, joint or other frame of the model.
            position: (3,) wanted for the frame's origin, world [m].
            attitude: (3,) wanted for the frame, ZYX angles [rad]; None if any will do.
            seed: a whole number >= 0.

        Raises:
            InvalidInput: an argument that is not allowed.
            PoseOutOfReach: with what the best joint values found miss the pose by.
            GoalInCollision: all joint values found touch an obstacle or the robot itself.
        """
        held = self.mode.has_wheels
        goal = inverse_kinematics(
            self.robot, frame, position, attitude,
            start=self.start,
            mode=self.mode,
            base_position=None if self.mode.floats else self.goal[:3],
            base_attitude=to_angles(self.goal[3:7]) if held else None,
            scene=self.scene,
            seed=seed,
        )  # fmt: skip
        return replace(self, goal=goal, reach_attitude=bool(self.lattice.postures) and not held)

    @property
    def travel(self) -> Array:
        """(3,) from the base's start to its goal, world axes [m]; zero where it floats."""
        if self.mode.floats:
            return frozen(np.zeros(3))
        return frozen(self.goal[:3] - self.start[:3])

    @property
    def joint_travel(self) -> Array:
        """(nd,) change of the joint values [rad or m], continuous joints the shorter way round."""
        return frozen(self.robot.joint_change(self.start, self.goal))

    @property
    def turn(self) -> float:
        """Angle from the start's to the goal's attitude [rad], where the mode prescribes both."""
        if self.mode.attitude_reacts:
            return 0.0
        return float(angle_between(self.start[3:7], self.goal[3:7]))

    @property
    def delta_d(self) -> float:
        """Length of one layer's nominal step, Eq. 4 [m]: weighted norm of what is prescribed."""
        slide = self.robot.prismatic
        joints = self.joint_travel
        metres = np.concatenate([self.travel, joints[slide]]) * self.position_weight
        radians = np.append(joints[~slide], self.turn) * self.rotation_weight
        total = float(np.sqrt(np.sum(metres**2) + np.sum(radians**2)))
        return total / self.lattice.divisions

    def _check_that_something_is_to_be_done(self) -> None:
        moves = float(np.linalg.norm(self.travel)) > _SAME
        turns = float(np.max(np.abs(self.joint_travel), initial=0.0)) > _SAME or self.turn > _SAME
        if self.reach_attitude and self.mode.has_wheels:
            raise InvalidInput("reach_attitude", True, "False where wheels turn the base")
        if self.reach_attitude and not self.lattice.postures:
            raise InvalidInput("reach_attitude", True, "a lattice with posture axes")
        if not (moves or turns or self.reach_attitude):
            raise InvalidInput(
                "goal", self.goal.tolist(), "a configuration that differs from the start"
            )
        floats = self.mode.floats
        if not moves and self.lattice.axes:
            raise InvalidInput(
                "lattice",
                f"{' and '.join(self.lattice.axes)} axis, "
                + ("no thrusters" if floats else "start and goal at one position"),
                "no lateral or normal axis where there is no direction of travel",
            )

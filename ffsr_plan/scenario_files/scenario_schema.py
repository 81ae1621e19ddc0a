"""Tables of a scenario file as settings classes: keys, types, ranges and defaults."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import TypeAdapter

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import NamedNumbers, Numbers, OneOf, Text, WholeNumber
from ffsr_plan.core.settings import part_of, setting, settings
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.goal_poses.descent import DESCENTS
from ffsr_plan.goal_poses.inverse_kinematics import MOST_TRIES, goals_at_pose
from ffsr_plan.problem.configuration_rules import ModeName
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.collision_shapes import CONTAINERS
from ffsr_plan.robots.loading import load_robot
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.srdf import NO_POSTURE
from ffsr_plan.robots.urdf.inertias import INERTIA
from ffsr_plan.robots.urdf.links import COLLISION
from ffsr_plan.scenario_files.body_tables import BodyTable, PaceTable
from ffsr_plan.scenario_files.debris_tables import Debris
from ffsr_plan.scenario_files.obstacle_tables import (
    BeltTable,
    CloudTable,
    FileName,
    GateTable,
    Obstacle,
    ScatterTable,
    TrussTable,
)
from ffsr_plan.scenario_files.planner_tables import ByPlannerName, PlannerTable
from ffsr_plan.scenario_files.shape_tables import KeepIn
from ffsr_plan.scene.scene import Scene

Position = Annotated[Array, Numbers(3, at_most=FARTHEST)]
Angles = Annotated[Array, Numbers(3)]
JointValues = Annotated[dict[str, float], NamedNumbers()]
Container = Annotated[str, OneOf(tuple(CONTAINERS))]
_ORIGIN = (0.0, 0.0, 0.0)


@settings
class RobotTable:
    """The table `[robot]`.

    Attributes:
        urdf: name of a bundled robot, or a path relative to the scenario file.
        mode: what actuates the base.
        package_dirs: directories of ROS packages, relative to the scenario file.
        srdf: path of an SRDF, relative to the scenario file.
        meshes: what replaces collision meshes.
        cylinders: what replaces collision cylinders.
        collision: what becomes of links with visual and without collision shapes.
        inertia: what becomes of inertia tensors that no body has.
        locked: joints that are fixed, at a value [rad or m]; of joints that mimic one another, one.
    """

    urdf: Annotated[str, Text("a name or a path", empty=False)]
    mode: Annotated[Mode, ModeName()] = Mode.FREE_FLYING
    package_dirs: tuple[FileName, ...] = ()
    srdf: FileName | None = None
    meshes: Container = "hull"
    cylinders: Container = "hull"
    collision: Annotated[str, OneOf(COLLISION)] = "collision"
    inertia: Annotated[str, OneOf(INERTIA)] = "exact"
    locked: JointValues = field(default_factory=dict)

    def robot(self, folder: Path) -> SpaceRobot:
        """The robot; paths are relative to `folder`."""
        return load_robot(
            folder / self.urdf if self.urdf.endswith(".urdf") else self.urdf,
            [folder / entry for entry in self.package_dirs],
            srdf=None if self.srdf is None else folder / self.srdf,
            meshes=self.meshes,
            cylinders=self.cylinders,
            collision=self.collision,
            inertia=self.inertia,
            locked=self.locked,
        )


@settings
class StartTable:
    """The table `[start]`.

    Attributes:
        position: (3,) base origin in the world [m].
        attitude: (3,) ZYX angles alpha, beta, gamma [rad].
        posture: name of a posture of the robot, whose joint values are taken.
        joints: joint values by name [rad or m], in place of those of the posture; joints that
            neither names are at zero, or at the limit nearest to it.
    """

    position: Position = setting(default=_ORIGIN)
    attitude: Angles = setting(default=_ORIGIN)
    posture: Annotated[str, Text("the name of a posture")] | None = None
    joints: JointValues = field(default_factory=dict)

    def configuration(self, robot: SpaceRobot) -> Array:
        """(nq,) start configuration."""
        joints = joint_values(robot, self.posture, self.joints)
        return robot.configuration(self.position, self.attitude, joints)


@settings
class EndEffectorTable:
    """The table `end_effector` of `[goal]`.

    Attributes:
        frame: name of a link, joint or other frame of the robot.
        position: (3,) wanted for the frame's origin, world [m].
        attitude: (3,) ZYX angles wanted for the frame [rad]; any attitude is accepted without it.
        seed: of the random numbers of inverse kinematics.
        tries: joint values from which it approaches the pose; without it 16 where there is no
            lattice, and on a lattice as many as it takes to find a goal.
    """

    frame: Annotated[str, Text("the name of a frame")]
    position: Position
    attitude: Angles | None = None
    seed: Annotated[int, WholeNumber()] = 0
    tries: Annotated[int, WholeNumber(at_least=1, at_most=MOST_TRIES)] | None = None


@settings
class GoalTable:
    """The table `[goal]`.

    Attributes:
        position: (3,) base origin in the world [m], zero without it; not allowed in the mode
            free-floating.
        attitude: (3,) ZYX angles of the base [rad]. In a mode whose attitude reacts, the arms have
            to bring the base to it.
        posture: name of a posture of the robot, whose joint values are taken.
        joints: joint values by name [rad or m], in place of those of the posture; joints that
            neither names are at zero, or at the limit nearest to it.
        end_effector: pose of a frame, from which the joint values follow by inverse kinematics.
    """

    position: Position | None = None
    attitude: Angles | None = None
    posture: Annotated[str, Text("the name of a posture")] | None = None
    joints: JointValues = field(default_factory=dict)
    end_effector: EndEffectorTable | None = None

    def __post_init__(self) -> None:
        if self.end_effector is not None:
            for key in ("joints", "posture"):
                value = getattr(self, key)
                if value:
                    raise InvalidInput(key, value, "none beside end_effector: they follow from it")

    @property
    def base_position(self) -> Array:
        """(3,) prescribed base origin [m]."""
        return np.zeros(3) if self.position is None else self.position

    @property
    def base_attitude(self) -> Array:
        """(3,) prescribed ZYX angles of the base [rad]."""
        return np.zeros(3) if self.attitude is None else self.attitude

    def configurations(
        self, robot: SpaceRobot, scene: Scene, start: Array, mode: Mode, several: bool
    ) -> Array:
        """(G, nq) goal configuration; several, by inverse kinematics, where a pose is given.

        Args:
            robot: the robot.
            scene: obstacles, for inverse kinematics.
            start: (nq,) start configuration.
            mode: what actuates the base.
            several: whether the planner can take several goals.

        Raises:
            InvalidInput: a joint, posture or frame that the robot does not have.
            PoseOutOfReach, GoalInCollision: see `inverse_kinematics`.
        """
        wanted = self.end_effector
        if wanted is None:
            joints = joint_values(robot, self.posture, self.joints)
            return robot.configuration(self.base_position, self.base_attitude, joints)[None]
        tries = wanted.tries or (DESCENTS if several else None)
        try:
            return goals_at_pose(
                robot,
                scene,
                wanted.frame,
                wanted.position,
                wanted.attitude,
                start=start,
                mode=mode,
                base_position=self.base_position if mode.has_thrusters else None,
                base_attitude=self.base_attitude if mode.has_wheels else None,
                seed=wanted.seed,
                tries=tries,
            )
        except InvalidInput as error:
            raise InvalidInput(f"end_effector.{error.what}", error.value, error.allowed) from None


@settings
class WindowTable:
    """The table `[window]`.

    Attributes:
        low: (3,) least coordinates of the base origin in the world [m].
        high: (3,) greatest ones; along an axis on which both are equal the base stays [m].
    """

    low: Position
    high: Position


if TYPE_CHECKING:
    ObjectiveTable = Any
else:
    ObjectiveTable = part_of(
        Problem,
        "ObjectiveTable",
        "The table `[objective]`.",
        (
            "delta",
            "length_unit",
            "clearance_cap",
            "min_clearance",
            "position_weight",
            "rotation_weight",
        ),
    )


@settings
class ScenarioFile:
    """A scenario file.

    Attributes:
        title: of the scenario.
        robot: the robot and the mode.
        start: the start configuration.
        goal: the goal configuration, or the pose of an end effector.
        obstacles: spheres, files of spheres, meshes, and convex bodies of other shapes.
        keep_in: zones, in each of which the whole robot stays.
        clouds: random spheres in a box.
        belts: random spheres in a ring.
        scatters: a few random spheres in the xy-plane.
        trusses: booms of struts.
        gates: pairs of spheres.
        bodies: bodies that move.
        debris: clouds of spheres that drift.
        pace: the time from start to goal, where bodies move.
        lattice: layers and axes; without it, the base may be anywhere in the window, and joints
            within their limits.
        window: where the base may be without a lattice.
        objective: weights of length and clearance.
        planner: the planner, its settings and seed.
    """

    robot: RobotTable
    goal: GoalTable
    lattice: Lattice | None = None
    window: WindowTable | None = None
    title: Annotated[str, Text()] = ""
    start: StartTable = field(default_factory=StartTable)
    obstacles: tuple[Obstacle, ...] = ()
    keep_in: tuple[KeepIn, ...] = ()
    clouds: tuple[CloudTable, ...] = ()
    belts: tuple[BeltTable, ...] = ()
    scatters: tuple[ScatterTable, ...] = ()
    trusses: tuple[TrussTable, ...] = ()
    gates: tuple[GateTable, ...] = ()
    bodies: tuple[BodyTable, ...] = ()
    debris: tuple[Debris, ...] = ()
    pace: PaceTable = field(default_factory=PaceTable)
    objective: ObjectiveTable = field(default_factory=ObjectiveTable)
    planner: Annotated[PlannerTable, ByPlannerName()] = field(default_factory=PlannerTable)


def joint_values(
    robot: SpaceRobot, posture: str | None, joints: dict[str, float]
) -> dict[str, float]:
    """Joint values of a posture, if one is named, and those given in their place.

    Args:
        robot: gives the postures.
        posture: name of a posture, or None.
        joints: values by joint name [rad or m].

    Raises:
        InvalidInput: an unknown posture; the nearest name is suggested.
    """
    if posture is None:
        return joints
    name = one_of("posture", posture, list(robot.postures), NO_POSTURE)
    return {**robot.postures[name], **joints}


def schema() -> dict[str, Any]:
    """The JSON Schema of scenario files, by which editors complete and check them.

    It holds tables, keys, types, names and ranges; whether they fit together and to the robot is
    checked by `Scenario.load`.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **TypeAdapter(ScenarioFile).json_schema(),
        "title": "ffsr-plan scenario",
    }

"""What the generators share: numbers for files, and the checks that a drawn problem has to pass."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.collision.clearance import clearance
from ffsr_plan.collision.self_collisions import self_collisions
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.robots.loading import load_robot
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scenario_files.scenario import Scenario
from ffsr_plan.scene.scene import Scene

Tables = dict[str, Any]
"""Tables of a scenario file."""
DIGITS = 6
"""Decimals of the numbers in problem files: micrometres and microradians."""
PLANAR, SPATIAL, SATELLITE = "planar_dual_arm", "spatial_dual_arm", "satellite_ur5"
BLOCKED, FREE, NOT_DEFINED = "blocked", "free", "not defined"
"""What the straight motion is; where the arms have to bring about an attitude there is none."""


class Draft(NamedTuple):
    """A problem that was drawn and not checked yet.

    Attributes:
        title: of the problem.
        tables: of a scenario file.
        room: clearance that start and goal have to have [m].
        blocked: whether the straight motion must not be free.
        apart: whether links must not touch one another along the straight motion.
    """

    title: str
    tables: Tables
    room: float = 0.02
    blocked: bool = True
    apart: bool = False


@dataclass(frozen=True)
class Family:
    """Problems of one kind.

    Attributes:
        name: of the family.
        title: what its problems are.
        count: number of problems.
        time_limit: in which the default planner is asked to solve a problem [s].
        draw: a problem of random numbers and of its number in the family; None to draw again.
    """

    name: str
    title: str
    count: int
    time_limit: float
    draw: Callable[[np.random.Generator, int], Draft | None]


@cache
def robot_of(name: str) -> SpaceRobot:
    """A bundled robot, read once."""
    return load_robot(name)


def numbers(values: object) -> Any:  # noqa: ANN401 - a number or nested lists
    """A number or an array as plain numbers of `DIGITS` decimals."""
    rounded: Any = np.round(np.asarray(values, dtype=np.float64), DIGITS) + 0.0
    return rounded.tolist()


def joints(robot: SpaceRobot, values: Array) -> dict[str, float]:
    """Joint values (nd,) by name, within the limits when rounded [rad or m]."""
    inside = np.clip(values, robot.lower + 2e-6, robot.upper - 2e-6)
    return dict(zip(robot.joint_names, numbers(inside), strict=True))


def spheres(centers: object, radii: object) -> list[Tables]:
    """Tables `[[obstacles]]` of spheres (N, 3) and (N,) [m]."""
    rows = zip(numbers(centers), numbers(radii), strict=True)
    return [{"center": center, "radius": radius} for center, radius in rows]


def box(size: object, position: object, name: str, attitude: object = None) -> Tables:
    """The table `[[obstacles]]` of a box; sizes and position (3,) [m], ZYX angles (3,) [rad]."""
    table = {"size": numbers(size), "position": numbers(position), "name": name}
    if attitude is not None:
        table["attitude"] = numbers(attitude)
    return {"box": table}


def clear(robot: SpaceRobot, scene: Scene, q: Array, room: float) -> bool:
    """Whether a configuration (nq,) keeps so much room [m], and no links touch one another."""
    return clearance(robot, scene, q) > room and not len(self_collisions(robot, q))


def accepted(draft: Draft, folder: Path) -> tuple[Problem, str] | None:
    """The problem of a draft and what its straight motion is; None if it does not pass.

    Start and goal keep the room that is asked for. The goal's attitude is that which is demanded,
    or that at which the straight motion arrives.

    Args:
        draft: what was drawn.
        folder: that paths in its tables are relative to.
    """
    problem = Scenario.from_tables(draft.tables, folder).problem
    robot, end = problem.robot, problem.duration or 0.0
    if not clear(robot, problem.scene.at(0.0), problem.start, draft.room):
        return None
    if problem.reach_attitude:
        arrival = _arrival_at_attitude(problem)
        found = clear(robot, problem.scene.at(end), arrival, draft.room)
        return (problem, NOT_DEFINED) if found else None
    ends = np.stack([problem.start[:3], problem.start[:3] + problem.base_displacement])
    motion = Motion(robot, problem.mode, problem.start, problem.goal, ends)
    if not clear(robot, problem.scene.at(end), motion.configurations()[-1], draft.room):
        return None
    prover = Prover(motion, problem.scene, problem.tolerance, pace=problem.pace(1))
    still = np.zeros((2, 3))
    clearances = prover.clearances(np.array([0, 1]), still)
    both = float(clearances[0]), float(clearances[1])
    apart = prover.links.verdicts()[0].free
    no_other = problem.lattice is not None and not problem.lattice.postures
    if not apart and (draft.apart or no_other):  # joints have no other way on such a lattice
        return None
    free = prover.certify(0, still[0], still[0], both).free and apart
    if free and draft.blocked:
        return None
    return problem, FREE if free else BLOCKED


def _arrival_at_attitude(problem: Problem) -> Array:
    """(nq,) the goal; where the base floats, with its origin where conservation puts it."""
    robot, start, goal = problem.robot, problem.start, problem.goal
    if not problem.mode.floats:
        return goal
    values = np.stack([robot.joint_values(start), robot.joint_values(goal)])
    levers = rotations.rotate(np.stack([start[3:7], goal[3:7]]), centers_of_mass(robot, values))
    return robot.assemble(start[:3] + levers[0] - levers[1], goal[3:7], values[1])


def posture(robot: SpaceRobot, name: str) -> Array:
    """(nd,) joint values of a named posture; those it does not name are zero [rad or m]."""
    named: Mapping[str, float] = robot.postures[name]
    return np.array([named.get(joint, 0.0) for joint in robot.joint_names])


def nearest_turn(robot: SpaceRobot, start: Array, goal: Array) -> Array:
    """(nd,) the joint values of a posture that are nearest to others, whole turns apart.

    Args:
        robot: the robot.
        start: (nd,) the others [rad or m].
        goal: (nd,) values of the posture [rad or m].
    """
    turned = goal + 2.0 * np.pi * np.round((start - goal) / (2.0 * np.pi))
    allowed = ~robot.prismatic & (turned >= robot.lower) & (turned <= robot.upper)
    return np.where(allowed, turned, goal)


def angles(vector: Sequence[float] | Array) -> Any:  # noqa: ANN401 - a list of numbers
    """ZYX angles of a rotation vector (3,) [rad]."""
    return numbers(rotations.to_angles(rotations.exp(np.asarray(vector, dtype=np.float64))))

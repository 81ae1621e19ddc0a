"""Checks of start and goal before a search without a lattice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ffsr_plan.collision.clearance import point_distances
from ffsr_plan.collision.contacts import contacts, goal_in_collision, start_in_collision
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.contacts import Contact
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.scene.scene import Scene


def check_ends(problem: Problem) -> Problem:
    """Check that the start touches nothing, and a goal nothing that it touches in any case.

    Where the attitude reacts, it depends on the way whether a goal touches an obstacle, unless one
    touches the base whatever the attitude; whether its links touch each other does not depend.
    Bodies that move are where they are at the begin and at the end of the duration.

    Args:
        problem: a problem without a lattice.

    Returns:
        The problem with those of its goals that do not touch anything in any case.

    Raises:
        StartInCollision: with all that touches there, and at the goal.
        GoalInCollision: with all that touches at the first goal, if every goal is refused.
    """
    robot, first = problem.robot, problem.obstacles.at(0.0)
    last = problem.obstacles.at(problem.duration or 0.0)
    free = [goal for goal in problem.goals if not _touching(problem, last, goal)]
    blocked = None if free else _arrival(problem)
    if contacts(robot, first, problem.start):
        end = None if problem.scene.moves else blocked  # at another time
        raise start_in_collision(robot, first, problem.start, end)
    if blocked is not None:
        around = last if _is_certain(problem, last, problem.goal) else Scene()
        raise goal_in_collision(robot, around, blocked)
    if len(free) == len(problem.goals):
        return problem
    return replace(problem, goal=free[0], alternatives=free[1:])


def _touching(problem: Problem, scene: Scene, goal: Array) -> tuple[Contact, ...]:
    """What touches at a goal whatever the way to it, in a scene where all is at rest."""
    around = scene if _is_certain(problem, scene, goal) else Scene()
    return contacts(problem.robot, around, _demanded(problem, goal))


def _is_certain(problem: Problem, scene: Scene, goal: Array) -> bool:
    """Whether obstacles are touched at a goal, or not, whatever the way to it."""
    demanded = problem.reach_attitude or problem.mode.has_wheels
    return demanded or _touches_at_any_attitude(problem, scene, goal)


def _demanded(problem: Problem, goal: Array) -> Array:
    """(nq,) a goal, its base where the centre of mass leaves it at the attitude demanded."""
    if not (problem.mode.floats and problem.reach_attitude):
        return goal
    ends = np.stack([problem.start, goal])
    joints = np.stack([problem.robot.joint_values(q) for q in ends])
    centers = rotations.rotate(ends[:, 3:7], centers_of_mass(problem.robot, joints))
    position = problem.start[:3] + centers[0] - centers[1]
    return problem.robot.assemble(position, goal[3:7], joints[1])


def _arrival(problem: Problem) -> Array:
    """(nq,) the goal as demanded, or else at the attitude to which the straight way leads."""
    if problem.reach_attitude or problem.mode.has_wheels:
        return _demanded(problem, problem.goal)
    ends = np.stack([problem.start[:3], problem.start[:3] + problem.base_displacement])
    motion = Motion(problem.robot, problem.mode, problem.start, problem.goal, ends)
    return np.asarray(motion.configurations()[-1])


def _touches_at_any_attitude(problem: Problem, scene: Scene, goal: Array) -> bool:
    """Whether an obstacle reaches into a ball about the base origin that some shape contains.

    That ball stays where it is, however the base is turned at the goal.
    """
    robot, shapes = problem.robot, problem.robot.primitives
    if problem.mode.floats or not len(scene) or not len(shapes.kinds):
        return False
    placed = shape_placements(robot, goal[None])
    offsets = goal[:3] - placed.positions[0]
    local = np.abs(np.einsum("gij,gi->gj", placed.rotations[0], offsets))
    box = (shapes.kinds == BOX) & shapes.exact
    depths = np.where(box, np.min(shapes.sizes - local, axis=1), -np.inf)
    beyond = np.maximum(local[:, 2] - shapes.sizes[:, 1], 0.0)
    ways = np.sqrt(local[:, 0] ** 2 + local[:, 1] ** 2 + beyond**2)
    depths = np.where(shapes.exact & ~box, shapes.sizes[:, 0] - ways, depths)
    return bool(np.max(depths) >= point_distances(scene, goal[None, :3])[0])

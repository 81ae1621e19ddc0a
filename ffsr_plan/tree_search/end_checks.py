"""Checks of start and goal before a search without a lattice."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.contacts import contacts, goal_in_collision, start_in_collision
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.scene.scene import Scene


def check_ends(problem: Problem) -> None:
    """Check that the start touches nothing, and the goal nothing that it touches in any case.

    Where the attitude reacts, it depends on the way whether the goal touches an obstacle; whether
    its links touch each other does not.

    Args:
        problem: a problem without a lattice.

    Raises:
        StartInCollision: with all that touches there, and at the goal.
        GoalInCollision: with all that touches there.
    """
    robot, scene = problem.robot, problem.obstacles
    demanded = problem.reach_attitude and not problem.mode.floats
    certain = problem.mode.has_wheels or demanded or _touches_at_any_attitude(problem)
    around = scene if certain else Scene()
    touching = contacts(robot, around, problem.goal)
    if contacts(robot, scene, problem.start):
        there = _arrival(problem) if touching else None
        raise start_in_collision(robot, scene, problem.start, there)
    if touching:
        raise goal_in_collision(robot, around, _arrival(problem))


def _arrival(problem: Problem) -> Array:
    """(nq,) the goal at the attitude to which the straight way leads."""
    ends = np.stack([problem.start[:3], problem.start[:3] + problem.base_displacement])
    motion = Motion(problem.robot, problem.mode, problem.start, problem.goal, ends)
    return np.asarray(motion.configurations()[-1])


def _touches_at_any_attitude(problem: Problem) -> bool:
    """Whether an obstacle reaches into a ball about the base origin that some shape contains.

    That ball stays where it is, however the base is turned at the goal.
    """
    robot, scene, shapes = problem.robot, problem.obstacles, problem.robot.primitives
    if problem.mode.floats or not len(scene) or not len(shapes.kinds):
        return False
    placed = shape_placements(robot, problem.goal[None])
    offsets = problem.goal[:3] - placed.positions[0]
    local = np.abs(np.einsum("gij,gi->gj", placed.rotations[0], offsets))
    box = (shapes.kinds == BOX) & shapes.exact
    depths = np.where(box, np.min(shapes.sizes - local, axis=1), -np.inf)
    beyond = np.maximum(local[:, 2] - shapes.sizes[:, 1], 0.0)
    ways = np.sqrt(local[:, 0] ** 2 + local[:, 1] ** 2 + beyond**2)
    depths = np.where(shapes.exact & ~box, shapes.sizes[:, 0] - ways, depths)
    nearest = np.linalg.norm(scene.centers - problem.goal[:3], axis=1) - scene.radii
    return bool(np.max(depths) >= np.min(nearest))

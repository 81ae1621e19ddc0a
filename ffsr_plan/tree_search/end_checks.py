"""Checks of start and goal before a search without a lattice."""

from __future__ import annotations

from ffsr_plan.collision.contacts import contacts, goal_in_collision, start_in_collision
from ffsr_plan.problem.problem import Problem
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
    robot, scene = problem.robot, problem.scene
    around = scene if problem.mode.has_wheels else Scene()
    touching = contacts(robot, around, problem.goal)
    if contacts(robot, scene, problem.start):
        raise start_in_collision(robot, scene, problem.start, problem.goal if touching else None)
    if touching:
        raise goal_in_collision(robot, around, problem.goal)

"""All that touches at a configuration, and the errors that report it."""

from __future__ import annotations

from functools import partial

import numpy as np

from ffsr_plan.collision.coal_measures import CoalMeasures
from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.contacts import TOUCHING, Contact, ZoneName
from ffsr_plan.core.errors import GoalInCollision, StartInCollision
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.zone_room import missing_room


def contacts(robot: SpaceRobot, scene: Scene, q: Array) -> tuple[Contact, ...]:
    """Links that touch spheres or one another.

    Args:
        robot: the robot.
        scene: the obstacles.
        q: (nq,) configuration.

    Returns:
        One contact for each pair of a link and an obstacle, or of two links: first those with
        obstacles in which depths are not known, then the deepest.
    """
    deepest: dict[tuple[str, int | str | None], float] = {}
    for near in [*ObstacleQuery(robot, scene).touching(q), *SelfQuery(robot).touching(q)]:
        pair = near.link, near.obstacle
        deepest[pair] = max(deepest.get(pair, 0.0), -near.distance)
    found = [named(scene, Nearest(-depth, *pair)) for pair, depth in deepest.items()]
    return tuple(sorted(found, key=lambda each: (not each.is_of_unknown_depth, -each.depth)))


def named(scene: Scene, near: Nearest) -> Contact:
    """A nearest pair with the source of its sphere.

    Args:
        scene: the obstacles.
        near: the pair.
    """
    sphere = near.obstacle
    source = scene.source_of(sphere) if isinstance(sphere, int) else ""
    return Contact(near.link, sphere, -near.distance, source)


def start_in_collision(
    robot: SpaceRobot, scene: Scene, start: Array, goal: Array | None = None
) -> StartInCollision:
    """The error that reports all contacts of the start, and of the goal where it is known.

    Args:
        robot: the robot.
        scene: the obstacles.
        start: (nq,) start, in collision.
        goal: (nq,) end of the motion, or None.
    """
    found = contacts(robot, scene, start)
    at_goal = () if goal is None else contacts(robot, scene, goal)
    advice = _advice(robot, scene, (*found, *at_goal), start)
    return StartInCollision(*found[0][:3], found, at_goal, advice)


def goal_in_collision(robot: SpaceRobot, scene: Scene, goal: Array) -> GoalInCollision:
    """The error that reports all contacts of the goal.

    Args:
        robot: the robot.
        scene: the obstacles.
        goal: (nq,) end of the motion, in collision.
    """
    found = contacts(robot, scene, goal)
    return GoalInCollision(*found[0][:3], found, (), _advice(robot, scene, found, goal))


def _advice(
    robot: SpaceRobot, scene: Scene, found: tuple[Contact, ...], q: Array
) -> tuple[str, ...]:
    """What may help against contacts; `q` (nq,) has some of them."""
    advice = []
    zones = [contact for contact in found if isinstance(contact.source, ZoneName)]
    others = [each for each in found if each not in zones and isinstance(each.obstacle, int)]
    spheres = [contact.depth for contact in others]
    links = {contact.link for contact in found}
    links |= {contact.obstacle for contact in found if isinstance(contact.obstacle, str)}
    way = "the base or the joints" if robot.nd else "the base"
    unknown = dict.fromkeys(each.source for each in others if each.is_of_unknown_depth)
    if unknown:
        advice.append(f"move {way} out of {', '.join(unknown)}")
    elif spheres:
        deep = max(spheres) > TOUCHING
        far = f"{max(spheres):.3g} m" if deep else "the tolerance"
        advice.append(f"move {way} out by more than {far}")
    if zones:
        advice.append(_against_zones(robot, scene, zones, q, way))
    if spheres and scene.excess and max(spheres) <= scene.excess:
        advice.append(f"a smaller excess of the cover, which is now up to {scene.excess:g} m")
    if len(others) + len(zones) < len(found):
        advice.append(
            "exempt links that are designed to touch in an SRDF, which "
            "`fp.self_collisions(robot, q)` lists and writes; or change the joint values"
        )
    larger = {r.link: r for r in robot.replacements if r.link in links and np.isfinite(r.excess)}
    for link, replaced in larger.items():
        if replaced.excess >= max(c.depth for c in found if link in (c.link, c.obstacle)):
            advice.append(
                f"a closer shape for link '{link}', whose {replaced.shape} is replaced by a "
                f"{replaced.by} up to {replaced.excess:.3g} m larger"
            )
    return tuple(advice)


def _against_zones(
    robot: SpaceRobot, scene: Scene, zones: list[Contact], q: Array, way: str
) -> str:
    """What may help a robot at `q` (nq,) that stands out of zones; `way` is what could be moved."""
    names = " and ".join(dict.fromkeys(contact.source for contact in zones))
    tree, placed = scene.tree, shape_placements(robot, q[None])
    if (apart := missing_room(tree.planes, tree.balls, lambda n: np.zeros(len(n)))) > TOUCHING:
        return f"zones that overlap: no point is in all of them, they miss it by {apart:.3g} m"
    reach = partial(CoalMeasures(robot, scene).reach, placed)
    if (missing := missing_room(tree.planes, tree.balls, reach)) > TOUCHING:
        return (
            f"larger zones than {names}: at this attitude and these joint values the robot is at "
            f"least {2.0 * missing:.3g} m too wide for them wherever the base is"
        )
    far = max(contact.depth for contact in zones)
    return f"move {way} into {names}" + (f" by more than {far:.3g} m" if far > TOUCHING else "")

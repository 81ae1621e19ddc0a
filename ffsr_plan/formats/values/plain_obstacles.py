"""Obstacles as formats of other tools can hold them: shapes at rest, without zones."""

from __future__ import annotations

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, ObstacleShape


def obstacles_of(scene: object) -> list[ObstacleShape]:
    """The obstacles of a scene as shapes, spheres as balls.

    Args:
        scene: the scene.

    Raises:
        InvalidInput: no scene, or one with zones, bodies that move, or shapes that are grown.
    """
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    for field, held in (
        ("growth", scene.growth),
        ("keep_in", scene.keep_in),
        ("bodies", scene.bodies),
    ):
        if held:
            allowed = "none, as the format has none; `scene.at(time)` places bodies that move"
            raise InvalidInput(f"scene {field}", held, allowed)
    pairs = zip(scene.centers, scene.radii.tolist(), strict=True)
    balls = [Ball(radius, center, f"sphere_{k}") for k, (center, radius) in enumerate(pairs)]
    return [*balls, *scene.shapes]

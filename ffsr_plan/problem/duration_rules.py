"""Checks of the time that a problem with moving bodies has."""

from __future__ import annotations

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.scene.scene import Scene


def check_duration(scene: Scene, duration: float | None, ramp: float) -> None:
    """Raise `InvalidInput` for a duration that the bodies need, or know no motion for.

    Args:
        scene: the obstacles.
        duration: of the problem [s], or None.
        ramp: of the problem.
    """
    if duration is None:
        if scene.bodies:
            raise InvalidInput("duration", None, "a time [s], as bodies of the scene move")
        if ramp != 0.0:
            raise InvalidInput("ramp", ramp, "0 without a duration")
        return
    for k, body in enumerate(scene.bodies):
        if duration > body.motion.known_until:
            name = f" '{body.name}'" if body.name else ""
            allowed = f"at most {body.motion.known_until:g} s, up to which the motion of body {k}"
            raise InvalidInput("duration", duration, f"{allowed}{name} is known")

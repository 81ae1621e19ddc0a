"""Checks of what a problem says of time: its duration, and progress on its lattice."""

from __future__ import annotations

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.scene.scene import Scene


def check_duration(scene: Scene, duration: float | None, ramp: float) -> None:
    """Raise `InvalidInput` for a duration that the bodies need, or know no motion for.

    Args:
        scene: the obstacles.
        duration: of the problem [s], or None.
        ramp: of the problem.
    """
    if duration is None:
        if scene.moves:
            raise InvalidInput("duration", None, "a time [s], as bodies of the scene move")
        if ramp != 0.0:
            raise InvalidInput("ramp", ramp, "0 without a duration")
        return
    for k, body in enumerate(scene.bodies):
        if duration > body.motion.known_until:
            name = f" '{body.name}'" if body.name else ""
            allowed = f"at most {body.motion.known_until:g} s, up to which the motion of body {k}"
            raise InvalidInput("duration", duration, f"{allowed}{name} is known")


def check_progress(lattice: Lattice, mode: Mode, displacement: Array) -> None:
    """Raise `InvalidInput` for progress on a lattice that it does not fit.

    Args:
        lattice: the lattice.
        mode: what actuates the base.
        displacement: (3,) of the base from start to goal [m].
    """
    if lattice.progress is None:
        return
    if lattice.postures:
        allowed = "none with progress, which the joints follow"
        raise InvalidInput("lattice postures", len(lattice.postures), allowed)
    if not mode.has_thrusters:
        allowed = "None where the robot floats, as in the mode " + mode.value
        raise InvalidInput("lattice progress", lattice.progress, allowed)
    if not displacement.any():
        allowed = "None with start and goal at one position, where there is no way"
        raise InvalidInput("lattice progress", lattice.progress, allowed)

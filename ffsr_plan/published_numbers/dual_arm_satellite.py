"""ManiSat: a planar satellite with two arms, whose yaw is known in closed form."""

from __future__ import annotations

import numpy as np

from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree, rotation
from ffsr_plan.published_numbers.recomputed_number import OWN, RecomputedNumber

_ROD = (0.1, 0.1, 0.1245)
_SIDES = (("left", 0.2, 0.5 * np.pi), ("right", -0.2, -0.5 * np.pi))
BEGIN = np.array([0.2, -0.5, 0.1, 0.4])
"""(4,) joint values at the start: both of the left arm, then of the right one [rad]."""
CHANGE = np.array([1.2, -1.0, -0.6, 1.4])
"""(4,) their change [rad]."""
_YAW = -0.206117  # [rad]
_SOURCE = "ManiSat (simulator of satellites with manipulators), example of a dual arm"


def dual_arm_satellite() -> RigidTree:
    """A base of 13.3 kg with two arms of two links of 2.9 kg each."""
    bodies = [Body("base", 13.3, (0.285, 0.285, 0.285))]
    for side, y, yaw in _SIDES:
        upper, lower = f"{side}_1", f"{side}_2"
        turned = rotation(z=yaw)
        bodies.append(Body(upper, 2.9, _ROD, (0.1926, 0.0, 0.0), "base", (0.0, y, 0.0), turned))
        bodies.append(Body(lower, 2.9, _ROD, (0.1635, 0.0, 0.0), upper, (0.3852, 0.0, 0.0)))
    return RigidTree("dual_arm_satellite", tuple(bodies))


def recomputed() -> list[RecomputedNumber]:
    """The yaw after one straight joint motion of both arms."""
    from ffsr_plan.core.rotations import IDENTITY, to_angles
    from ffsr_plan.dynamics.reaction import Reaction

    path = np.array([BEGIN, BEGIN + CHANGE])
    attitude = Reaction.along(dual_arm_satellite().robot(), path).attitudes(IDENTITY)[-1]
    return [
        RecomputedNumber(
            "yaw of the base, both arms moved", "rad", OWN, _YAW,
            float(to_angles(attitude)[0]), 1e-6, _SOURCE,
            "quoted at second hand, no public copy was found; sums over the bodies give it",
        )
    ]  # fmt: skip

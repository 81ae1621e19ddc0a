"""Bound on the travel of a planar linkage on a base at rest, as Schwarzer, Saha and Latombe need.

No point of a chain travels farther than the sum over its joints of the rotation, times the farthest
distance that a point behind the joint can have from it. For three links of length 1 this is
3 |dq_1| + 2 |dq_2| + |dq_3|. The coarse part of this package's bound is the same if all joints turn
in one direction, and less otherwise.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree
from ffsr_plan.published_numbers.recomputed_number import OWN, RecomputedNumber

CHANGE = np.array([0.3, 0.2, 0.4])
"""(3,) change of the joint values over the edge, all in one direction [rad]."""
_SOURCE = (
    "F. Schwarzer, M. Saha, J.-C. Latombe (2005). Adaptive dynamic collision checking for single "
    "and multiple articulated robots in complex environments. IEEE Trans. Robotics 21(3)"
)
_DIFFERS = (
    "linkage and closed form are ours: no copy of the article was found to take its example from"
)


def linkage() -> RigidTree:
    """Three links of 1 m and 1 kg, their shapes segments of no width."""
    bodies, parent, place = [Body("base", 1e3, 3 * (1e3,))], "base", (0.0, 0.0, 0.0)
    for name in ("link_1", "link_2", "link_3"):
        middle = (0.5, 0.0, 0.0)
        bodies.append(Body(name, 1.0, (0.1, 0.1, 0.1), middle, parent, place, capsule=(1e-6, 1.0)))
        parent, place = name, (1.0, 0.0, 0.0)
    return RigidTree("linkage", tuple(bodies))


def recomputed() -> list[RecomputedNumber]:
    """The bound for the tip of the linkage, over a whole edge."""
    from ffsr_plan.dynamics.actuation_mode import Mode
    from ffsr_plan.dynamics.motion import Motion
    from ffsr_plan.proof.edge_travel import EdgeTravel

    robot = linkage().robot()
    identity = np.array([0.0, 0.0, 0.0, 1.0])
    begin, goal = (
        robot.assemble(np.zeros(3), identity, values) for values in (np.zeros(3), CHANGE)
    )
    motion = Motion(robot, Mode.ATTITUDE_HELD, begin, goal, np.zeros((2, 3)))
    travel = EdgeTravel(motion).over(0.0, 1.0)[0]
    found = float(travel.points["speed"].max())
    expected = float(np.array([3.0, 2.0, 1.0]) @ np.abs(CHANGE))
    return [
        RecomputedNumber("travel bound of a linkage's tip, 3 links of 1 m", "m", OWN, expected,
                         found, 1e-9, _SOURCE, _DIFFERS)
    ]  # fmt: skip

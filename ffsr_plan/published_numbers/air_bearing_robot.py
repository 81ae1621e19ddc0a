"""The planar air-bearing robot of the Space Research Centre of the Polish Academy of Sciences.

Its simulator's repository has all parameters, a start and the equations; the file of joint
velocities that it reads, and what came out, are not in it.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree
from ffsr_plan.published_numbers.models.summed_momentum import base_rotation, body_states, straight
from ffsr_plan.published_numbers.recomputed_number import OWN, RecomputedNumber

START = np.array([-1.0882, 0.7349, 1.9241])
"""(3,) joint values at the start [rad]."""
_LINKS = (  # mass [kg], inertia [kg m^2], centre [m], place on the body before [m]
    (2.9130, 0.091391, 0.1805, (0.3696, 0.001279, 0.0)),
    (2.6460, 0.081375, 0.2000, (0.4488, 0.0, 0.0)),
    (1.6990, 0.021904, 0.1029, (0.4499, 0.0, 0.0)),
)
_SOURCE = (
    "space-robot-planar-case (github.com/FatinaBasmadji/space-robot-planar-case), for F. L. "
    "Basmadji, G. Chmaj, T. Rybus, K. Seweryn (2019). Microgravity testbed for the development of "
    "space robot control systems. Proc. SPIE 11176"
)
_DIFFERS = "model and start are the source's; the motion is ours: all joints straight to zero"


def air_bearing_robot() -> RigidTree:
    """A satellite of 64.859 kg with an arm of three links; `hand` is its end."""
    bodies, parent = [Body("base", 64.859, 3 * (2.6952,))], "base"
    for k, (mass, inertia, center, place) in enumerate(_LINKS):
        name = f"link_{k + 1}"
        bodies.append(Body(name, mass, 3 * (inertia,), (center, 0.0, 0.0), parent, place))
        parent = name
    hand = Body("hand", 0.0, parent=parent, place=(0.3545, 0.0, 0.0), moves=False)
    return RigidTree("air_bearing_robot", (*bodies, hand))


def recomputed() -> list[RecomputedNumber]:
    """Yaw of the base and place of the hand after the arm is stretched out."""
    import pinocchio as pin

    from ffsr_plan.core.rotations import to_angles
    from ffsr_plan.dynamics.actuation_mode import Mode
    from ffsr_plan.dynamics.motion import Motion

    tree, end = air_bearing_robot(), np.zeros(3)
    robot = tree.robot()
    identity = np.array([0.0, 0.0, 0.0, 1.0])
    begin, goal = (robot.assemble(np.zeros(3), identity, values) for values in (START, end))
    last = Motion(robot, Mode.FREE_FLOATING, begin, goal, np.zeros((2, 3))).configurations()[-1]
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, last)
    hand = data.oMf[robot.model.getFrameId("hand")].translation

    turned = base_rotation(tree, straight(START, end), 40)
    yaw = float(np.arctan2(turned[1, 0], turned[0, 0]))
    rest = _center(tree, START)  # the centre of mass rests, and the base began at the origin
    expected = rest + turned @ (body_states(tree, end, end)["hand"].place - _center(tree, end))
    numbers = [("yaw of the base", "rad", yaw, float(to_angles(last[3:7])[0]))]
    for axis in range(2):
        numbers.append((f"{'xy'[axis]} of the hand", "m", float(expected[axis]), float(hand[axis])))
    return [
        RecomputedNumber(f"air-bearing robot: {what}", unit, OWN, known, found, 1e-7, _SOURCE,
                         _DIFFERS)
        for what, unit, known, found in numbers
    ]  # fmt: skip


def _center(tree: RigidTree, values: np.ndarray) -> np.ndarray:
    """(3,) centre of mass in the base frame [m]."""
    states = body_states(tree, values, np.zeros(3))
    moments = [
        body.mass * (states[body.name].place + states[body.name].rotation @ np.array(body.center))
        for body in tree.bodies
    ]
    return np.sum(moments, axis=0) / tree.mass

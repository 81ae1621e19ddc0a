"""ETS-VII, the satellite with a robot arm that flew in 1997 to 1999: model and a first segment.

Masses, inertias and places are those of a public model. Figures of the flight to compare with were
not found in public, so the segment is predicted, and computed a second time in another way.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree, rotation
from ffsr_plan.published_numbers.models.summed_momentum import base_rotation, straight
from ffsr_plan.published_numbers.recomputed_number import OWN, RecomputedNumber

_PI = np.pi
_BASE = ((6206.0, 48.16, 78.52), (48.16, 3541.0, -29.22), (78.52, -29.22, 7087.0))
_LINKS = (  # mass [kg], inertia [kg m^2], centre [m], place on the body before [m], turns x, y, z
    (35.01, ((1.218, -0.07309, 0.00071), (-0.07309, 0.5132, 0.1132), (0.00071, 0.1132, 1.692)),
     (0.0, 0.0, 0.175), (-0.785, -0.295, 1.0), (0.0, 0.0, 0.0)),
    (22.45, ((0.102, 0.0, -0.00214), (0.0, 3.378, 0.0), (-0.00214, 0.0, 3.752)),
     (0.435, 0.0, 0.0), (0.0, 0.275, 0.35), (-0.5 * _PI, 0.0, -0.5 * _PI)),
    (21.89, ((0.4327, 0.0, -0.6328), (0.0, 2.266, 0.0), (-0.6328, 0.0, 2.528)),
     (0.315, 0.0, 0.275), (0.87, 0.0, 0.0), (0.0, 0.0, 0.5 * _PI)),
    (16.54, ((0.3878, 0.0, 0.01675), (0.0, 0.3963, 0.0), (0.01675, 0.0, 0.07271)),
     (0.0, 0.0, -0.1335), (0.63, 0.0, 0.275), (0.0, 0.0, -0.5 * _PI)),
    (26.0, ((0.5727, 0.0, -0.2313), (0.0, 0.5987, 0.0), (-0.2313, 0.0, 0.1290)),
     (0.0, 0.0, 0.1385), (0.0, 0.0, -0.267), (0.5 * _PI, 0.5 * _PI, 0.0)),
    (18.49, ((0.165, 0.000781, -0.0145), (0.000781, 0.241, -0.000137), (-0.0145, -0.000137, 0.259)),
     (0.0, 0.0, 0.266), (0.0, 0.0, 0.277), (_PI, 0.5 * _PI, 0.0)),
)  # fmt: skip
_WHEELS = (  # place [m], turns x, y, z [rad]
    ((0.8, 0.0, 0.0), (0.0, 0.5 * _PI, 0.0)),
    ((0.0, 0.8, 0.0), (-0.5 * _PI, 0.0, 0.0)),
    ((0.0, 0.0, 0.8), (0.0, 0.0, 0.0)),
)
_FIRST = np.array([0.6, 0.8, -0.8, 0.0, 0.0, 0.0])  # [rad] change of the joints, from zero
_SOURCE = (
    "bMSd (github.com/drdv/bmsd), models/model_ETS7.m; inertias as in K. Yoshida, S. Abiko (2002). "
    "Inertia parameter identification for a free-flying space robot. AIAA GNC"
)


def ets_vii() -> RigidTree:
    """Base of 2552 kg, arm of six joints and 140 kg, and three wheels that stand still."""
    bodies, parent = [Body("base", 2552.0, _BASE)], "base"
    for k, (mass, inertia, center, place, turns) in enumerate(_LINKS):
        name = f"link_{k + 1}"
        bodies.append(Body(name, mass, inertia, center, parent, place, rotation(*turns)))
        parent = name
    for k, (place, turns) in enumerate(_WHEELS):
        body = Body(f"wheel_{k + 1}", 1.0, (0.5, 0.5, 1.0), parent="base", place=place)
        bodies.append(body._replace(rotation=rotation(*turns), moves=False))
    return RigidTree("ets_vii", tuple(bodies))


def recomputed() -> list[RecomputedNumber]:
    """The rotation of the base in a first segment of the arm's motion."""
    from ffsr_plan.core.rotations import IDENTITY, log
    from ffsr_plan.dynamics.reaction import Reaction

    tree = ets_vii()
    robot = tree.robot(inertia="balance")
    path = np.array([np.zeros(6), _FIRST])
    turned = log(Reaction.along(robot, path).attitudes(IDENTITY)[-1])
    again = base_rotation(tree, straight(*path), 40)
    cosine = np.clip(0.5 * (np.trace(again) - 1.0), -1.0, 1.0)
    expected = float(np.degrees(np.arccos(cosine)))
    balanced = ", ".join(each.link for each in robot.balanced)
    return [
        RecomputedNumber(
            "ETS-VII: rotation of the base, joints 1 to 3 moved", "deg", OWN, expected,
            float(np.degrees(np.linalg.norm(turned))), 2e-3, _SOURCE,
            f"no body has the identified inertias of {balanced}: the nearest ones were taken, "
            "which the second computation does not do",
        ),
    ]  # fmt: skip

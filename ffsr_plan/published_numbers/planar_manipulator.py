"""A planar manipulator as Papadopoulos and Dubowsky's: the determinant of J* in closed form.

A base and two links in a plane. With the barycentric vectors a, b, c of base and links, and D_k
the rows of the inertia matrix of the absolute rotations, summed,

    det J* = (a b D_2 sin q_1 + b c D_0 sin q_2 - a c D_1 sin(q_1 + q_2)) / (D_0 + D_1 + D_2) .

J* consists here of the two rows of the end effector's velocity in the plane.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.published_numbers.models.rigid_trees import Body, RigidTree
from ffsr_plan.published_numbers.recomputed_number import FORMULA, OWN, RecomputedNumber
from ffsr_plan.robots.robot import SpaceRobot

_MASSES = (40.0, 4.0, 3.0)  # base, links [kg]
_INERTIAS = (6.667, 0.333, 0.25)  # about their centres, in the plane [kg m^2]
_HALF = 0.5  # from the centre of each body to its joints, and to the end effector [m]
SINGULAR_FIRST = -65.0
"""Value of the first joint at which a singular value of the second is looked for [deg]."""
_TRIED = (0.7, 1.1)  # [rad] joint values at which the determinants are compared
_SOURCE = (
    "E. Papadopoulos, S. Dubowsky (1993). Dynamic singularities in free-floating space "
    "manipulators. J. Dynamic Systems, Measurement, and Control 115"
)
_UNCHECKED = (
    "no copy of the article was found: its parameters and the angles -65 and -11.41 deg are quoted "
    "at second hand, and the root of the closed form is expected"
)


def planar_manipulator() -> RigidTree:
    """A base of 40 kg and links of 4 and 3 kg, all joints half a metre from the centres."""
    base, upper, lower = (
        Body(name, mass, 3 * (inertia,), center, parent, place)
        for name, mass, inertia, center, parent, place in zip(
            ("base", "link_1", "link_2"), _MASSES, _INERTIAS,
            ((0.0, 0.0, 0.0), (_HALF, 0.0, 0.0), (_HALF, 0.0, 0.0)),
            ("", "base", "link_1"),
            ((0.0, 0.0, 0.0), (_HALF, 0.0, 0.0), (2.0 * _HALF, 0.0, 0.0)),
            strict=True,
        )
    )  # fmt: skip
    place = (2.0 * _HALF, 0.0, 0.0)
    tip = Body("end_effector", 0.0, parent="link_2", place=place, moves=False)
    return RigidTree("planar_manipulator", (base, upper, lower, tip))


def determinant_by_formula(first: float, second: float) -> float:
    """Determinant of J* [m^2] by the closed form, at joint values [rad]."""
    m0, m1, m2 = _MASSES
    whole, h = sum(_MASSES), _HALF
    a = h * m0 / whole
    b = (h * m0 + h * (m0 + m1)) / whole
    c = h * (m0 + m1) / whole + h
    d00 = _INERTIAS[0] + m0 * (m1 + m2) / whole * h**2
    d11 = _INERTIAS[1] + (m0 * m1 + m1 * m2 + 4.0 * m0 * m2) / whole * h**2
    d22 = _INERTIAS[2] + m2 * (m0 + m1) / whole * h**2
    d01 = m0 * (m1 + 2.0 * m2) / whole * h**2 * np.cos(first)
    d12 = m2 * (m1 + 2.0 * m0) / whole * h**2 * np.cos(second)
    d02 = m0 * m2 / whole * h**2 * np.cos(first + second)
    d0, d1, d2 = d00 + d01 + d02, d01 + d11 + d12, d02 + d12 + d22
    three = a * b * d2 * np.sin(first) + b * c * d0 * np.sin(second)
    return float((three - a * c * d1 * np.sin(first + second)) / (d0 + d1 + d2))


def determinant(robot: SpaceRobot, first: float, second: float) -> float:
    """Determinant of J* [m^2] by this package, at joint values [rad]."""
    from ffsr_plan.dynamics.momentum import generalized_jacobian

    jacobian = generalized_jacobian(robot, _configuration(robot, first, second), "end_effector")
    return float(np.linalg.det(jacobian[:2]))


def recomputed() -> list[RecomputedNumber]:
    """The determinant at one configuration, and the dynamic singularity."""
    from scipy.optimize import brentq

    from ffsr_plan.dynamics.dynamic_singularity import least_singular_value

    robot = planar_manipulator().robot()
    first = np.radians(SINGULAR_FIRST)
    expected = brentq(lambda second: determinant_by_formula(first, second), -0.5, 0.0, xtol=1e-13)
    found = brentq(lambda second: determinant(robot, first, second), -0.5, 0.0, xtol=1e-13)
    at = _configuration(robot, first, found)
    least = least_singular_value(robot, at, "end_effector", attitude=False)
    return [
        RecomputedNumber(
            "planar manipulator: det J* at (.7, 1.1) rad", "m^2", OWN,
            determinant_by_formula(*_TRIED), determinant(robot, *_TRIED), 1e-12, _SOURCE,
            "the closed form was derived here, with barycentric vectors as in the article",
        ),
        RecomputedNumber(
            "planar manipulator: singular q2 at q1 = -65 deg", "deg", OWN,
            float(np.degrees(expected)), float(np.degrees(found)), 1e-6, _SOURCE, _UNCHECKED,
        ),
        RecomputedNumber(
            "planar manipulator: least singular value there", "m", FORMULA, 0.0, least, 1e-9,
            _SOURCE, "the article's condition det J* = 0",
        ),
    ]  # fmt: skip


def _configuration(robot: SpaceRobot, first: float, second: float) -> Array:
    joints = {"link_1_joint": float(first), "link_2_joint": float(second)}
    return robot.configuration(joints=joints)

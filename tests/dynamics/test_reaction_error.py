"""The claimed error of the base reaction, against the closed form of two bodies in a plane.

The arm carries the centre of mass past the base's own, so that the base's rate has a peak as narrow
as the base's inertia is small.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.urdf.number_texts import attribute_text
from tests.helpers.urdf_builders import inertial, joint, link, urdf

ARM = 1e-3  # the arm's inertia, relative to the base's


def two_bodies(rng, moment, base, arm):
    """Two bodies of 1 kg, axes turned at random, and the axis of their plane in the base frame."""
    turn, more = Rotation.random(random_state=rng), Rotation.random(random_state=rng)
    center = rng.uniform(-0.5, 0.5, 3)
    yaw, pitch, roll = (turn * more).as_euler("ZYX")
    hinge = joint("j", "revolute", "b", "a", (0, 0, 0), (0, 0, 0), (0, 0, 1), limit=9.0)
    hinge = hinge.replace(
        "<origin xyz='0.0 0.0 0.0' rpy='0.0 0.0 0.0'/>",
        f"<origin xyz='{attribute_text(center + turn.apply([base, 0, 0]))}' "
        f"rpy='{attribute_text([roll, pitch, yaw])}'/>",
    ).replace("axis xyz='0.0 0.0 1.0'", f"axis xyz='{attribute_text(more.inv().apply([0, 0, 1]))}'")
    text = urdf(
        link("b", inertial(1.0, (moment,) * 3, center)),
        link("a", inertial(1.0, (ARM * moment,) * 3, more.inv().apply([arm, 0, 0]))),
        hinge,
    )
    return robot_from_urdf(text, "made"), turn.apply([0, 0, 1])


def closed_form(moment, base, arm, begin, end):
    """Rotation of the base [rad] while the joint goes from `begin` to `end`."""

    def rate(angle):
        x, y = base + arm * np.cos(angle), arm * np.sin(angle)
        swept = 0.5 * (x * arm * np.cos(angle) + y * arm * np.sin(angle))
        return -(ARM * moment + swept) / (moment * (1 + ARM) + 0.5 * (x * x + y * y))

    steps = [np.pi + side * 10.0**-k for k in range(1, 10) for side in (-1, 1)]
    corners = sorted({begin, end, np.pi, *(s for s in steps if begin < s < end)})
    ends = pairwise(corners)
    return sum(quad(rate, a, b, epsabs=1e-16, epsrel=1e-13, limit=500)[0] for a, b in ends)


@pytest.mark.parametrize("moment", [3e-2, 1e-3, 1e-4, 1e-6])
def test_the_claimed_error_is_at_least_the_true_one(moment):
    rng = np.random.default_rng(7)
    for _ in range(12):
        arm = 0.5 - 10.0 ** rng.uniform(-8, -1)
        width = 10.0 ** rng.uniform(-4, -0.5)
        begin, end = np.pi - width * rng.uniform(0.1, 1, 2) * [1, -1]
        robot, normal = two_bodies(rng, moment, 0.5, arm)
        reaction = Reaction(robot, np.array([[begin]]), np.array([[end - begin]]))
        *vector, scalar = reaction.increments[0]
        angle = 2.0 * np.arctan2(np.dot(vector, normal), scalar)
        wrong = angle - closed_form(moment, 0.5, arm, begin, end)
        wrong = abs((wrong + np.pi) % (2.0 * np.pi) - np.pi)
        assert wrong <= reaction.errors[0] + 1e-15
        assert reaction.errors[0] < (3e-10 if moment > 1e-6 else 3e-8)


def test_peaks_too_narrow_to_be_seen_are_refused_with_the_robot():
    with pytest.raises(fp.InvalidInput, match="made, link 'b', least moment: got 1e-14"):
        two_bodies(np.random.default_rng(0), 1e-14, 0.5, 0.5)

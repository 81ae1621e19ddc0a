"""Each term of the travel bound is needed: motions on which it is the only large one."""

import numpy as np
import pytest

from tests.helpers.random_robots import Z, at, body, dot, put_together
from tests.helpers.sampled_travel import SAMPLES, STILL, SampledEdge, limb, tightness

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
# each edge makes one term of the bound's acceleration the only large one: the base compensates the
# sphere's velocity, so that only the curvature of its path remains
TERMS = {
    "centripetal acceleration of a turning link": SampledEdge(
        put_together(body(1.0, 1.0), [], [limb("revolute", shapes=[dot(x=1.0)])]),
        np.zeros(1), np.array([0.05]), turn=STILL,
    ),
    "centripetal acceleration of a joint on a turning link": SampledEdge(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, at(x=1.0), shapes=[dot()], parent=1)],
        ),
        np.zeros(2), np.array([0.05, 0.0]), turn=STILL,
    ),
    "a prismatic joint that has slid far": SampledEdge(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, shapes=[dot()], parent=1)],
        ),
        np.array([0.0, 2.0]), np.array([0.05, 0.0]), turn=STILL,
    ),
    "Coriolis acceleration of a sliding link": SampledEdge(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, shapes=[dot()], parent=1)],
        ),
        np.array([0.0, -0.025]), np.array([0.02, 0.05]), turn=STILL,
    ),
    "a link's axis that its parent turns": SampledEdge(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("revolute", X, shapes=[dot(0.5**0.5, 0.0, -(0.5**0.5))],
                                    parent=1)],
        ),
        np.array([0.0, -0.0]), np.array([0.02, 0.02]), turn=STILL,
    ),
    "centripetal acceleration of the base's turn": SampledEdge(
        put_together(body(1.0, 1.0), [dot(x=1.0)], []),
        np.zeros(0), np.zeros(0), turn=np.array([0.0, 0.0, 0.05]),
    ),
    "Coriolis acceleration of the base's turn": SampledEdge(
        put_together(body(1.0, 1.0), [], [limb("prismatic", X, shapes=[dot()])]),
        np.array([-0.01]), np.array([0.02]), turn=np.array([0.0, 0.0, 0.02]),
    ),
    "a reaction that sets in: the arm's momentum grows": SampledEdge(
        # a point mass that just moves towards the base's centre: no momentum now, soon some
        put_together(
            body(10.0, 5.0), [dot(y=5.0)],
            [limb("revolute", place=at(x=1.0), mass=0.1, moment=1e-9, lever=(0.5, 0, 0))],
        ),
        np.array([np.arccos(-0.5) - 0.05]), np.array([0.1]),
    ),
    "a reaction to a top that is tilted": SampledEdge(
        put_together(
            body(10.0, 10.0), [dot(x=5.0)],
            [limb("revolute"), limb("revolute", X, mass=1.0, moment=0.2, parent=1)],
        ),
        np.zeros(2), np.array([0.1, 0.1]),
    ),
    "a reaction to a top that spins along its carrier's axis, but only for a moment": SampledEdge(
        put_together(
            body(10.0, 10.0), [dot(x=4.0, z=4.0)],
            [limb("revolute"), limb("revolute", X, parent=1),
             limb("revolute", (0.5**0.5, 0.0, 0.5**0.5), mass=1.0, moment=1e-4, parent=2)],
        ),
        np.array([0.0, -0.15, 0.0]), np.array([0.3, 0.3, 6.0]),
    ),
    "a reaction to an unbalanced wheel": SampledEdge(
        put_together(
            body(10.0, 10.0), [dot(x=5.0)],
            [limb("revolute", (0.5**0.5, 0.0, 0.5**0.5), mass=1.0, moment=(0.02, 0.03, 0.04))],
        ),
        np.array([-0.05]), np.array([0.1]),
    ),
    "a base that slows down as a mass slides out": SampledEdge(
        put_together(
            body(1e3, 10.0), [dot(y=5.0)],
            [limb("prismatic", X, at(x=2.0, y=0.02), mass=0.1)],
        ),
        np.array([-0.1]), np.array([0.2]),
    ),
    "a base that slows down as a mass leaves its centre": SampledEdge(
        put_together(
            body(1e3, 10.0), [dot(y=5.0)],
            [limb("prismatic", X, mass=1.0), limb("revolute", mass=1.0, moment=0.1)],
        ),
        np.array([-1.0, 0.0]), np.array([2.0, 0.01]),
    ),
    "a base that a wheel spins while a rod turns": SampledEdge(
        put_together(
            body(100.0, 0.01), [dot(x=5.0)],
            [limb("revolute", X, mass=1.0, moment=0.01),
             limb("revolute", mass=1.0, moment=(1.0, 0.08, 1.08))],
        ),
        np.array([-0.5, -0.005]), np.array([1.0, 0.01]),
    ),
}  # fmt: skip


LEAST_SHARE = {
    "a link's axis that its parent turns": 0.7,
    "a reaction to a top that spins along its carrier's axis, but only for a moment": 0.3,
    "a base that slows down as a mass leaves its centre": 0.2,
    "a base that a wheel spins while a rod turns": 0.35,
}
"""Least share of the bound for terms that are perpendicular or grow from zero; otherwise 0.9."""


@pytest.mark.parametrize("name", TERMS)
def test_each_term_of_the_acceleration_can_be_attained(name):
    assert tightness(TERMS[name])[-1] > LEAST_SHARE.get(name, 0.9)


def test_a_link_may_rotate_faster_than_at_the_middle():
    """Rotations about one axis cancel until the joint between them separates the axes."""
    joints = [limb("revolute"), limb("revolute", X, parent=1)]
    made = put_together(
        body(1.0, 1.0), [], [*joints, limb("revolute", shapes=[dot(z=1.0)], parent=2)]
    )
    way = SampledEdge(made, np.array([0.0, -0.05, 0.0]), np.array([3.0, 0.1, -3.0]), turn=STILL)
    assert tightness(way, STILL) < 1.0


def test_a_slider_is_fastest_at_its_largest_offset():
    """At the middle it passes the rotation axis; only its ends have a speed of rotation."""
    made = put_together(
        body(1.0, 1.0), [], [limb("revolute"), limb("prismatic", X, shapes=[dot()], parent=1)]
    )
    way = SampledEdge(made, np.array([0.0, -1.0]), np.array([2.0, 2.0]), turn=STILL)
    travel = way.travel(np.array([0.5]), np.ones(1))
    speeds = np.linalg.norm(np.diff(way.places(0.5, 1.0)[0], axis=0), axis=2) * SAMPLES
    assert (
        1.3 * np.linalg.norm(travel.points["velocity"])
        < np.max(speeds)
        <= np.max(travel.points["speed"])
    )


def test_sliding_along_a_rotation_axis_adds_no_curvature():
    """The axes stay parallel, although another joint slides between them."""
    slider = limb("prismatic", Z, parent=2, shapes=[dot()])
    made = put_together(
        body(1.0, 1.0), [], [limb("revolute"), limb("prismatic", X, parent=1), slider]
    )
    way = SampledEdge(made, np.array([0.0, 0.0, -0.05]), np.array([0.5, 0.0, 0.1]), turn=STILL)
    bound = way.travel(np.array([0.5]), np.ones(1)).bounds(0, STILL)
    assert bound == pytest.approx([0.1], rel=0.05)


def test_a_base_gets_faster_when_masses_are_drawn_in():
    """The inertia falls far below that at the middle."""
    drawn = [limb("prismatic", axis, mass=1.0, moment=1e-6) for axis in (X, Y, Z)]
    wheel = limb("revolute", (0.6, 0.0, 0.8), mass=1.0, moment=1e-3)
    made = put_together(body(1e3, 1e-3), [dot(x=0.48, y=0.6, z=0.64)], [*drawn, wheel])
    way = SampledEdge(made, np.array([1.0, 1.0, 1.0, 0.0]), np.array([-0.9, -0.9, -0.9, 1.0]))
    travel = way.travel(np.array([0.5]), np.ones(1))
    speeds = np.linalg.norm(np.diff(way.places(0.5, 1.0)[0], axis=0), axis=2) * SAMPLES
    assert (
        5.0 * np.linalg.norm(travel.points["velocity"])
        < np.max(speeds)
        <= np.max(travel.points["speed"])
    )

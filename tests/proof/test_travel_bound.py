"""The travel bound: no point of any shape may outrun it, with the base reacting or turned.

What points really travel is sampled: Pinocchio's kinematics along the motion, `Reaction` for the
attitude, and the length of a polyline, which is never longer than the path itself.
"""

from itertools import product
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ffsr_plan.core import rotations
from ffsr_plan.dynamics.momentum import connections
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.proof.travel_bound import TravelBound
from tests.helpers.random_trees import Limb, Z, at, body, dot, put_together, random_tree

seeds = st.integers(0, 100_000)
SAMPLES = 24
ROUNDING = 1e-12


class Way(NamedTuple):
    """An edge: joints from `begin` by `step`, base from attitude `start`, reacting or turned."""

    robot: object
    begin: np.ndarray
    step: np.ndarray
    start: np.ndarray = rotations.IDENTITY
    turn: "np.ndarray | None" = None

    def attitudes(self, times):
        if self.turn is not None:
            return rotations.multiply(self.start, rotations.exp(times[:, None] * self.turn))
        if self.robot.nd == 0:
            return np.tile(self.start, (len(times), 1))
        reaction = Reaction(self.robot, np.array([self.begin, self.begin + self.step]))
        edge = np.zeros(len(times), dtype=int)
        return rotations.multiply(self.start, reaction.rotation(edge, times))

    def joints(self, times):
        return self.begin + times[:, None] * self.step

    def travel(self, middles, lengths, error=0.0):
        bound, rates = TravelBound(self.robot), np.tile(self.step, (len(middles), 1))
        given_ = self.joints(middles), rates, self.attitudes(middles), lengths
        if self.turn is None:
            return bound.reacting(*given_, error).world
        return bound.held(*given_, np.tile(self.turn, (len(middles), 1))).world

    def in_base(self, middles, lengths):
        rates = np.tile(self.step, (len(middles), 1))
        bound, given_ = TravelBound(self.robot), (self.joints(middles), rates)
        travels = bound.reacting(*given_, self.attitudes(middles), lengths, 0.0)
        return travels.in_base.bounds(np.arange(len(middles)), np.zeros((len(middles), 3)))

    def places(self, middle, length, in_base=False):
        """Points of each shape, [(SAMPLES + 1, n, 3)], about the base origin."""
        times = middle + length * np.linspace(-0.5, 0.5, SAMPLES + 1)
        quats = rotations.IDENTITY if in_base else self.attitudes(times)
        shapes, data = self.robot.collision_model.geometryObjects, self.robot.model.createData()
        outlines = [outline(g) for g in shapes]
        found = [[] for _ in shapes]
        for q in self.robot.assemble(np.zeros(3), quats, self.joints(times)):
            pin.forwardKinematics(self.robot.model, data, q)
            for k, g in enumerate(shapes):
                pose = data.oMi[g.parentJoint]
                found[k].append(outlines[k] @ pose.rotation.T + pose.translation)
        return [np.array(f) for f in found]


def outline(geometry):
    """Points of a shape, corners and others, or the core that it surrounds at a distance."""
    solid, rng = geometry.geometry, np.random.default_rng(0)
    if isinstance(solid, coal.Sphere):
        points = np.zeros((1, 3))
    elif isinstance(solid, coal.Capsule):
        points = np.outer([-1.0, -0.3, 0.5, 1.0], [0.0, 0.0, solid.halfLength])
    elif isinstance(solid, coal.Box):
        points = np.array(list(product((-1.0, 1.0), repeat=3)))
        points = np.concatenate([points, rng.uniform(-1, 1, (3, 3))]) * solid.halfSide
    else:
        points = solid.points()
    return points @ geometry.placement.rotation.T + geometry.placement.translation


def lengths_of(places, base_step, length):
    """The longest way (g,) of any point of each shape."""
    shift = length * np.linspace(0.0, 1.0, SAMPLES + 1)[:, None, None] * base_step
    steps = [np.linalg.norm(np.diff(p + shift, axis=0), axis=2) for p in places]
    return np.array([np.sum(s, axis=0).max() for s in steps])


def case(seed, held):
    """A way of a random robot and four intervals on it, from the whole of it to 1/64."""
    rng, robot = np.random.default_rng(seed), random_tree(seed)
    step = rng.normal(size=robot.nd) * 10.0 ** rng.uniform(-2.0, 0.3)
    turn = rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.3) if held else None
    start = rotations.exp(rng.normal(size=3))
    way = Way(robot, rng.uniform(-1.5, 1.5, robot.nd), step, start, turn)
    lengths = 0.5 ** rng.uniform(0.0, 6.0, 4)
    lengths[0] = 1.0
    return way, rng, rng.uniform(0.5 * lengths, 1.0 - 0.5 * lengths), lengths


def base_steps(rng, travel):
    """Of the base: at random, or so that some point hardly moves and only its bend remains."""
    count, points = travel.speed.shape
    steps = rng.normal(size=(count, 3)) * rng.uniform(0, 0.5, (count, 1))
    against = -travel.velocity[np.arange(count), rng.integers(points, size=count)]
    return np.where(rng.random((count, 1)) < 0.5, steps, against)


@pytest.mark.parametrize("held", [False, True])
@settings(max_examples=100)
@given(seeds)
def test_no_point_travels_farther_than_the_bound(held, seed):
    way, rng, middles, lengths = case(seed, held)
    travel = way.travel(middles, lengths)
    steps = base_steps(rng, travel)
    bounds = travel.bounds(np.arange(4), steps)
    for k in range(4):
        sampled = lengths_of(way.places(middles[k], lengths[k]), steps[k], lengths[k])
        assert np.all(sampled <= bounds[k] + ROUNDING)


@given(seeds)
def test_no_point_travels_farther_in_the_base_than_the_bound_there(seed):
    way, _, middles, lengths = case(seed, held=True)
    bounds = way.in_base(middles, lengths)
    for k in range(4):
        places = way.places(middles[k], lengths[k], in_base=True)
        assert np.all(lengths_of(places, np.zeros(3), lengths[k]) <= bounds[k] + ROUNDING)


@pytest.mark.parametrize("held", [False, True])
@settings(max_examples=60)
@given(seeds)
def test_no_point_is_faster_or_bends_more_than_bounded(held, seed):
    """Second differences are means of the acceleration, first ones of the velocity."""
    way, _, middles, lengths = case(seed, held)
    travel = way.travel(middles, lengths)
    ends = np.append(travel.first[1:], travel.speed.shape[1])
    for k in range(4):
        for p, first, end in zip(
            way.places(middles[k], lengths[k]), travel.first, ends, strict=True
        ):
            speed = np.linalg.norm(np.diff(p, axis=0), axis=2) * SAMPLES / lengths[k]
            bend = np.linalg.norm(np.diff(p, 2, axis=0), axis=2) * SAMPLES**2 / 4.0
            assert np.all(speed <= np.max(travel.speed[k, first:end]) + 1e-9)
            assert np.all(bend <= np.max(travel.bend[k, first:end]) + 1e-9)


@given(seeds)
def test_the_clearance_inside_an_interval_is_bounded_by_those_at_its_ends(seed):
    """What the proof of an edge needs, for whole shapes and an obstacle anywhere."""
    way, rng, middles, lengths = case(seed, held=False)
    travel = way.travel(middles, lengths)
    steps = base_steps(rng, travel)
    bounds = travel.bounds(np.arange(4), steps)
    obstacle, place = coal.Sphere(0.3), pin.SE3(np.eye(3), rng.uniform(-2, 2, 3))
    for k in range(4):
        times = middles[k] + lengths[k] * np.linspace(-0.5, 0.5, SAMPLES + 1)
        q = way.robot.assemble(times[:, None] * steps[k], way.attitudes(times), way.joints(times))
        clearance = np.array([distances(way.robot, x, obstacle, place) for x in q])
        assert np.all(clearance >= 0.5 * (clearance[0] + clearance[-1] - bounds[k]) - 1e-7)


def distances(robot, q, obstacle, place):
    """(g,) signed distances of the robot's shapes to an obstacle."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    result = []
    for g in robot.collision_model.geometryObjects:
        pose = data.oMi[g.parentJoint] * g.placement
        poses = [coal.Transform3s(p.rotation, p.translation) for p in (pose, place)]
        answer = coal.DistanceResult()
        request = coal.DistanceRequest()
        result.append(coal.distance(g.geometry, poses[0], obstacle, poses[1], request, answer))
    return np.array(result)


def test_many_edges_share_an_interval():
    way, rng, middles, lengths = case(3, held=False)
    travel, steps = way.travel(middles, lengths), rng.normal(size=(6, 3))
    each = travel.bounds(np.repeat(2, 6), steps)
    assert np.array_equal(travel.bounds(2, steps), each)
    assert np.array_equal(travel.bounds(2, steps[4]), each[4])


def test_the_base_rotation_is_the_connection_times_the_joint_rates():
    """A sphere on the base, far out, moves with omega alone."""
    for seed in range(20):
        made = random_tree(seed)
        rng = np.random.default_rng(seed)
        arm = np.array([3.0, -2.0, 1.0])
        sphere = pin.GeometryObject("far", 1, at(*arm), coal.Sphere(0.1))
        made.collision_model.addGeometryObject(sphere)
        way = Way(made, rng.uniform(-1, 1, made.nd), rng.normal(size=made.nd))
        omega = connections(made, way.begin[None])[0] @ way.step
        velocity = way.travel(np.zeros(1), np.ones(1)).velocity[0, -1]
        assert velocity == pytest.approx(np.cross(omega, arm), abs=1e-12)


def test_the_attitude_error_adds_what_it_may_displace():
    """A sphere on a base that keeps still: at both ends it may be off by the error times rho."""
    base = put_together(body(1.0, 1.0), [dot(x=2.0)], [])
    way = Way(base, np.zeros(0), np.zeros(0))
    travel = way.travel(np.array([0.5]), np.ones(1), error=1e-3)
    assert travel.bounds(0, np.zeros(3)) == pytest.approx([4e-3])


def test_without_arms_the_bound_is_the_base_travel(point):
    way = Way(point, np.zeros(0), np.zeros(0))
    step = np.array([0.3, -0.4, 1.2])
    travel = way.travel(np.array([0.5, 0.25]), np.array([1.0, 0.5]))
    assert travel.bounds(np.arange(2), np.tile(step, (2, 1))) == pytest.approx(
        np.array([[1.3], [0.65]])
    )
    assert way.in_base(np.array([0.5]), np.ones(1)) == pytest.approx(np.zeros((1, 1)))


def tightness(way, base_step=None, length=1.0, middle=0.5):
    """Sampled travel / T of each shape, (g,); by default the base's step stops the last point."""
    travel = way.travel(np.array([middle]), np.array([length]))
    step = -travel.velocity[0, -1] if base_step is None else base_step
    bound = travel.bounds(0, step)
    sampled = lengths_of(way.places(middle, length), step, length)
    assert np.all(sampled <= bound + ROUNDING)
    return sampled / bound


def test_the_bound_is_met_where_it_can_be(robot):
    """Arms swung by a free base: a tenth of the bound less would be too little."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        step = 0.1 * rng.uniform(-1, 1, robot.nd)
        way = Way(robot, rng.uniform(-1, 1, robot.nd), step)
        assert np.max(tightness(way, np.zeros(3), length=1 / 8)) > 0.93
        assert np.max(tightness(way, np.array([0.25, 0.0, 0.0]))) > 0.93


STILL = np.zeros(3)


def limb(kind, axis=Z, place=None, mass=1e-9, moment=1e-12, lever=(0, 0, 0), shapes=(), parent=0):
    """By default of next to no mass, so that the base does not react."""
    return Limb(parent, kind, axis, place or at(), body(mass, moment, lever), list(shapes))


X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
# each way makes one term of the bound's acceleration the only large one: the base keeps step with
# the sphere watched, so that what the sphere travels is its bend alone
TERMS = {
    "centripetal acceleration of a turning link": Way(
        put_together(body(1.0, 1.0), [], [limb("revolute", shapes=[dot(x=1.0)])]),
        np.zeros(1), np.array([0.05]), turn=STILL,
    ),
    "centripetal acceleration of a joint on a turning link": Way(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, at(x=1.0), shapes=[dot()], parent=1)],
        ),
        np.zeros(2), np.array([0.05, 0.0]), turn=STILL,
    ),
    "a prismatic joint that has slid far": Way(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, shapes=[dot()], parent=1)],
        ),
        np.array([0.0, 2.0]), np.array([0.05, 0.0]), turn=STILL,
    ),
    "Coriolis acceleration of a sliding link": Way(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("prismatic", X, shapes=[dot()], parent=1)],
        ),
        np.array([0.0, -0.025]), np.array([0.02, 0.05]), turn=STILL,
    ),
    "a link's axis that its parent turns": Way(
        put_together(
            body(1.0, 1.0), [],
            [limb("revolute"), limb("revolute", X, shapes=[dot(0.5**0.5, 0.0, -(0.5**0.5))],
                                    parent=1)],
        ),
        np.array([0.0, -0.0]), np.array([0.02, 0.02]), turn=STILL,
    ),
    "centripetal acceleration of the base's turn": Way(
        put_together(body(1.0, 1.0), [dot(x=1.0)], []),
        np.zeros(0), np.zeros(0), turn=np.array([0.0, 0.0, 0.05]),
    ),
    "Coriolis acceleration of the base's turn": Way(
        put_together(body(1.0, 1.0), [], [limb("prismatic", X, shapes=[dot()])]),
        np.array([-0.01]), np.array([0.02]), turn=np.array([0.0, 0.0, 0.02]),
    ),
    "a reaction that sets in: the arm's momentum grows": Way(
        # a point mass that just moves towards the base's centre: no momentum now, soon some
        put_together(
            body(10.0, 5.0), [dot(y=5.0)],
            [limb("revolute", place=at(x=1.0), mass=0.1, moment=1e-9, lever=(0.5, 0, 0))],
        ),
        np.array([np.arccos(-0.5) - 0.05]), np.array([0.1]),
    ),
    "a reaction to a top that is tilted": Way(
        put_together(
            body(10.0, 10.0), [dot(x=5.0)],
            [limb("revolute"), limb("revolute", X, mass=1.0, moment=0.2, parent=1)],
        ),
        np.zeros(2), np.array([0.1, 0.1]),
    ),
    "a reaction to a top that spins along its carrier's axis, but only for a moment": Way(
        put_together(
            body(10.0, 10.0), [dot(x=4.0, z=4.0)],
            [limb("revolute"), limb("revolute", X, parent=1),
             limb("revolute", (0.5**0.5, 0.0, 0.5**0.5), mass=1.0, moment=1e-4, parent=2)],
        ),
        np.array([0.0, -0.15, 0.0]), np.array([0.3, 0.3, 6.0]),
    ),
    "a reaction to an unbalanced wheel": Way(
        put_together(
            body(10.0, 10.0), [dot(x=5.0)],
            [limb("revolute", (0.5**0.5, 0.0, 0.5**0.5), mass=1.0, moment=(0.02, 0.03, 0.04))],
        ),
        np.array([-0.05]), np.array([0.1]),
    ),
    "a base that slows down as a mass slides out": Way(
        put_together(
            body(1e3, 10.0), [dot(y=5.0)],
            [limb("prismatic", X, at(x=2.0, y=0.02), mass=0.1)],
        ),
        np.array([-0.1]), np.array([0.2]),
    ),
    "a base that slows down as a mass leaves its centre": Way(
        put_together(
            body(1e3, 10.0), [dot(y=5.0)],
            [limb("prismatic", X, mass=1.0), limb("revolute", mass=1.0, moment=0.1)],
        ),
        np.array([-1.0, 0.0]), np.array([2.0, 0.01]),
    ),
    "a base that a wheel spins while a rod turns": Way(
        put_together(
            body(100.0, 0.01), [dot(x=5.0)],
            [limb("revolute", X, mass=1.0, moment=0.01),
             limb("revolute", mass=1.0, moment=(1.0, 0.08, 1.08))],
        ),
        np.array([-0.5, -0.005]), np.array([1.0, 0.01]),
    ),
}  # fmt: skip


SIDE_BY_SIDE = {
    "a link's axis that its parent turns": 0.7,
    "a reaction to a top that spins along its carrier's axis, but only for a moment": 0.3,
    "a base that slows down as a mass leaves its centre": 0.2,
    "a base that a wheel spins while a rod turns": 0.35,
}
"""Where terms stand at right angles, or grow from nothing: what of the bound is met at least."""


@pytest.mark.parametrize("name", TERMS)
def test_each_term_of_the_acceleration_can_be_met(name):
    assert tightness(TERMS[name])[-1] > SIDE_BY_SIDE.get(name, 0.9)


def test_a_link_may_turn_faster_than_in_the_middle():
    """Two turns about one axis cancel until the joint between them takes the axes apart."""
    joints = [limb("revolute"), limb("revolute", X, parent=1)]
    made = put_together(
        body(1.0, 1.0), [], [*joints, limb("revolute", shapes=[dot(z=1.0)], parent=2)]
    )
    way = Way(made, np.array([0.0, -0.05, 0.0]), np.array([3.0, 0.1, -3.0]), turn=STILL)
    assert tightness(way, STILL) < 1.0


def test_sliding_along_the_axis_of_a_turn_bends_nothing():
    """Whatever slides in between: the axes stay parallel."""
    slider = limb("prismatic", Z, parent=2, shapes=[dot()])
    made = put_together(
        body(1.0, 1.0), [], [limb("revolute"), limb("prismatic", X, parent=1), slider]
    )
    way = Way(made, np.array([0.0, 0.0, -0.05]), np.array([0.5, 0.0, 0.1]), turn=STILL)
    bound = way.travel(np.array([0.5]), np.ones(1)).bounds(0, STILL)
    assert bound == pytest.approx([0.1], rel=0.05)


def test_a_base_gets_faster_when_masses_are_drawn_in():
    """The inertia falls far below the one in the middle."""
    drawn = [limb("prismatic", axis, mass=1.0, moment=1e-6) for axis in (X, Y, Z)]
    wheel = limb("revolute", (0.6, 0.0, 0.8), mass=1.0, moment=1e-3)
    made = put_together(body(1e3, 1e-3), [dot(x=0.48, y=0.6, z=0.64)], [*drawn, wheel])
    way = Way(made, np.array([1.0, 1.0, 1.0, 0.0]), np.array([-0.9, -0.9, -0.9, 1.0]))
    travel = way.travel(np.array([0.5]), np.ones(1))
    speeds = np.linalg.norm(np.diff(way.places(0.5, 1.0)[0], axis=0), axis=2) * SAMPLES
    assert 5.0 * np.linalg.norm(travel.velocity) < np.max(speeds) <= np.max(travel.speed)

"""The travel bound: no point of any shape exceeds it, with the base reacting or rotated."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ffsr_plan.dynamics.momentum import connections
from tests.helpers.random_robots import at, body, dot, put_together, random_tree
from tests.helpers.sampled_travel import (
    ROUNDING,
    SAMPLES,
    SampledEdge,
    base_steps,
    case,
    lengths_of,
    tightness,
)

seeds = st.integers(0, 100_000)


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
def test_no_point_travels_farther_in_the_base_than_its_bound(seed):
    way, _, middles, lengths = case(seed, held=True)
    bounds = way.in_base(middles, lengths)
    for k in range(4):
        places = way.places(middles[k], lengths[k], in_base=True)
        assert np.all(lengths_of(places, np.zeros(3), lengths[k]) <= bounds[k] + ROUNDING)


@pytest.mark.parametrize("held", [False, True])
@settings(max_examples=60)
@given(seeds)
def test_no_point_exceeds_its_speed_and_acceleration_bounds(held, seed):
    """Second differences are means of the acceleration, first ones of the velocity."""
    way, _, middles, lengths = case(seed, held)
    travel = way.travel(middles, lengths)
    ends = np.append(travel.first[1:], travel.points["speed"].shape[1])
    for k in range(4):
        for p, first, end in zip(
            way.places(middles[k], lengths[k]), travel.first, ends, strict=True
        ):
            speed = np.linalg.norm(np.diff(p, axis=0), axis=2) * SAMPLES / lengths[k]
            curvature = np.linalg.norm(np.diff(p, 2, axis=0), axis=2) * SAMPLES**2 / 4.0
            assert np.all(speed <= np.max(travel.points["speed"][k, first:end]) + 1e-9)
            assert np.all(curvature <= np.max(travel.points["curvature"][k, first:end]) + 1e-9)


@given(seeds)
def test_clearances_at_the_ends_bound_those_inside_an_interval(seed):
    """The condition that the proof of an edge needs, for whole shapes and any obstacle."""
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


def test_the_base_rotation_is_the_connection_times_joint_rates():
    """A sphere fixed to the base, far out, moves with omega alone."""
    for seed in range(20):
        made = random_tree(seed)
        rng = np.random.default_rng(seed)
        arm = np.array([3.0, -2.0, 1.0])
        sphere = pin.GeometryObject("far", 1, at(*arm), coal.Sphere(0.1))
        made.collision_model.addGeometryObject(sphere)
        way = SampledEdge(made, rng.uniform(-1, 1, made.nd), rng.normal(size=made.nd))
        omega = connections(made, way.begin[None])[0] @ way.step
        velocity = way.travel(np.zeros(1), np.ones(1)).points["velocity"][0, -1]
        assert velocity == pytest.approx(np.cross(omega, arm), abs=1e-12)


def test_the_attitude_error_adds_its_displacement():
    """A sphere on a base at rest: at both ends its error is the angle times rho."""
    base = put_together(body(1.0, 1.0), [dot(x=2.0)], [])
    way = SampledEdge(base, np.zeros(0), np.zeros(0))
    travel = way.travel(np.array([0.5]), np.ones(1), error=1e-3)
    assert travel.bounds(0, np.zeros(3)) == pytest.approx([4e-3])


def test_without_arms_the_bound_is_the_base_travel(point):
    way = SampledEdge(point, np.zeros(0), np.zeros(0))
    step = np.array([0.3, -0.4, 1.2])
    travel = way.travel(np.array([0.5, 0.25]), np.array([1.0, 0.5]))
    assert travel.bounds(np.arange(2), np.tile(step, (2, 1))) == pytest.approx(
        np.array([[1.3], [0.65]])
    )
    assert way.in_base(np.array([0.5]), np.ones(1)) == pytest.approx(np.zeros((1, 1)))


def test_the_bound_is_nearly_attained_by_arms_on_a_free_base(robot):
    """Arms on a free base: a bound lower by a tenth would be exceeded."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        step = 0.1 * rng.uniform(-1, 1, robot.nd)
        way = SampledEdge(robot, rng.uniform(-1, 1, robot.nd), step)
        assert np.max(tightness(way, np.zeros(3), length=1 / 8)) > 0.93
        assert np.max(tightness(way, np.array([0.25, 0.0, 0.0]))) > 0.93

"""The travel bound: no point of any shape may outrun it, the base reacting."""

from itertools import product

import coal
import numpy as np
import pinocchio as pin
import pytest
from builders import random_robot
from hypothesis import given
from hypothesis import strategies as st

from ffsr_plan import attitude
from ffsr_plan.reaction import Reaction
from ffsr_plan.travel import swing

seeds = st.integers(0, 100_000)
SAMPLES = 60


def corners(geometry):
    """Points of a shape that suffice: a box's corners; poles and axes of a sphere."""
    solid = geometry.geometry
    if isinstance(solid, coal.Sphere):
        rng = np.random.default_rng(0)
        points = rng.normal(size=(20, 3))
        points *= solid.radius / np.linalg.norm(points, axis=1, keepdims=True)
    else:
        points = np.array(list(product((-1, 1), repeat=3))) * solid.halfSide
    return points @ geometry.placement.rotation.T + geometry.placement.translation


def traced(robot, begin, end, base_travel, turn):
    """Length of the way that the points of each shape cover, world and base frame, (g,) each."""
    times = np.linspace(0, 1, SAMPLES + 1)
    joints = begin + times[:, None] * (end - begin)
    if turn is None:
        reaction = Reaction(robot, np.array([begin, end]))
        quats = reaction.rotation(np.zeros(len(times), dtype=int), times)
    else:
        quats = attitude.exp(times[:, None] * turn)
    result = []
    for base in ((times[:, None] * base_travel, quats), (0 * joints[:, :1] + [0, 0, 0], None)):
        q = robot.assemble(base[0], attitude.IDENTITY if base[1] is None else base[1], joints)
        data, shapes = robot.model.createData(), robot.collision_model.geometryObjects
        places = [[] for _ in shapes]
        for configuration in q:
            pin.forwardKinematics(robot.model, data, configuration)
            for k, g in enumerate(shapes):
                pose = data.oMi[g.parentJoint]
                places[k].append(corners(g) @ pose.rotation.T + pose.translation)
        steps = [np.linalg.norm(np.diff(np.array(p), axis=0), axis=2) for p in places]
        result.append(np.array([s.sum(axis=0).max() for s in steps]))
    return result


def case(seed):
    rng = np.random.default_rng(seed)
    robot = random_robot(seed)
    begin = rng.uniform(-1, 1, robot.nd)
    end = begin + rng.uniform(-1, 1, robot.nd) * rng.uniform(0.01, 0.6)
    return robot, rng, begin, end, rng.normal(size=3) * rng.uniform(0, 0.5)


@given(seeds)
def test_no_point_travels_farther_than_the_bound_while_the_base_reacts(seed):
    robot, _, begin, end, base = case(seed)
    bound = swing(robot, end - begin, np.maximum(abs(begin), abs(end)), None)
    world, in_base = traced(robot, begin, end, base, None)
    assert np.all(world <= bound.world + np.linalg.norm(base) + 1e-12)
    assert np.all(in_base <= bound.in_base + 1e-12)


@given(seeds)
def test_no_point_travels_farther_than_the_bound_while_the_attitude_is_turned(seed):
    robot, rng, begin, end, base = case(seed)
    turn = rng.normal(size=3) * 0.3
    reach = np.maximum(abs(begin), abs(end))
    bound = swing(robot, end - begin, reach, float(np.linalg.norm(turn)))
    world, _ = traced(robot, begin, end, base, turn)
    assert np.all(world <= bound.world + np.linalg.norm(base) + 1e-12)


def test_the_bound_is_met_where_it_can_be(robot):
    """One stretched arm turning at its shoulder, base held: the tip goes as fast as bounded."""
    begin, end = np.zeros(6), np.zeros(6)
    end[0] = 0.01
    bound = swing(robot, end - begin, np.maximum(abs(begin), abs(end)), 0.0)
    world, _ = traced(robot, begin, end, np.zeros(3), np.zeros(3))
    names = [robot.link_of(g) for g in robot.collision_model.geometryObjects]
    tip = names.index("left_link_3")
    assert world[tip] == pytest.approx(bound.world[tip], rel=0.05)


def test_without_arms_the_bound_is_the_base_travel(point):
    bound = swing(point, np.zeros(0), np.zeros(0), None)
    assert np.all(bound.world == 0.0)

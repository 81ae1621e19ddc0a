"""Travel bounds along the edges of a motion: no shape exceeds them on any interval."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.edge_travel import EdgeTravel
from ffsr_plan.proof.travel_bound import TravelBound
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.random_robots import random_tree
from tests.helpers.solid_distances import separation
from tests.helpers.urdf_builders import box, inertial, joint, link, random_robot, urdf

seeds = st.integers(0, 100_000)
SAMPLES = 60


def motion_of(seed, mode, edges=3):
    """A motion with equal attitudes at start and goal; the base rotates only by reaction."""
    rng, robot = np.random.default_rng(seed), random_tree(seed)
    begin = rng.uniform(-1, 1, robot.nd)
    step = rng.normal(size=robot.nd) * 10.0 ** rng.uniform(-2.0, 0.3)
    level = np.array([0.0, 0.0, 0.0, 1.0])
    start, goal = (robot.assemble(np.zeros(3), level, v) for v in (begin, begin + step))
    return Motion(robot, mode, start, goal, np.cumsum(rng.normal(size=(edges + 1, 3)), axis=0))


def traced(motion, layer, begin, end, base_step):
    """(P,) path length of every point of the bound [m], and (g,) first point of each shape."""
    times = np.linspace(begin, end, SAMPLES + 1)
    q = motion.at(np.full(len(times), layer), times)
    robot, bound = motion.robot, TravelBound(motion.robot)
    points = bound.points
    poses = robot.tree.poses(robot.joint_values(q))
    about = poses.origins[:, points["link"]] + np.einsum(
        "npij,pj->npi", poses.rotations[:, points["link"]], points["place"]
    )
    turned = np.einsum("nij,npj->npi", rotations.matrix(q[:, 3:7]), about)
    own = q[:, None, :3] if motion.mode.floats else times[:, None, None] * base_step
    places = turned + own
    return np.linalg.norm(np.diff(places, axis=0), axis=2).sum(axis=0), bound.shapes["first"]


@pytest.mark.parametrize("mode", list(Mode))
@given(seeds)
@settings(max_examples=150)
def test_no_shape_exceeds_the_bound_on_any_dyadic_interval(mode, seed):
    motion, rng = motion_of(seed, mode), np.random.default_rng(seed)
    travel = EdgeTravel(motion)
    for _ in range(4):
        layer, level = int(rng.integers(motion.edges)), int(rng.integers(0, 6))
        part = int(rng.integers(2**level))
        begin, end = part / 2**level, (part + 1) / 2**level
        whole = travel.over(0.0, 1.0)[0]
        # the base compensates the velocity of a point, so that its travel is small
        step = -whole.points["velocity"][
            layer, int(rng.integers(whole.points["velocity"].shape[1]))
        ]
        step = step if rng.random() < 0.6 else rng.normal(size=3) * 0.3
        step = np.zeros(3) if motion.mode.floats else step
        ways, first = traced(motion, layer, begin, end, step)
        bounds = travel.bounds(layer, begin, end, step)
        assert np.all(np.maximum.reduceat(ways, first) <= bounds + 1e-12)
        fastest = (travel.speeds[layer] + np.linalg.norm(step)) * (end - begin)
        assert np.all(ways <= fastest + 1e-12)


@given(seeds)
@settings(max_examples=150)
def test_a_part_is_bounded_by_the_numbers_of_its_interval(seed):
    motion, rng = motion_of(seed, "free-flying", edges=1), np.random.default_rng(seed)
    whole = EdgeTravel(motion).over(0.0, 1.0)[0]
    step = -whole.points["velocity"][0, int(rng.integers(whole.points["velocity"].shape[1]))]
    for part in (0, 1, 2, 3, 5, 7):
        ways, first = traced(motion, 0, part / 8, (part + 1) / 8, step)
        bounds = whole.within(0, 1 / 8, (part + 0.5) / 8 - 0.5, step)
        assert np.all(np.maximum.reduceat(ways, first) <= bounds + 1e-12)


def self_apart(robot, begin, end, samples=300):
    """Lower bound on the distance of links that must not touch, by the verification's code."""
    motion = Motion(robot, "attitude-held", begin, end, np.zeros((2, 3)))
    q = motion.at(np.zeros(samples + 1, dtype=int), np.linspace(0, 1, samples + 1))
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    joints = dict(zip(robot.joint_names, robot.joint_values(q).T, strict=True))
    poses = bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)
    found = [
        separation(a, poses[a.link] @ a.placement, b, poses[b.link] @ b.placement).min()
        for a, b in bodies.pairs()
    ]
    return min(found, default=np.inf)


@given(seeds)
@settings(max_examples=60)
def test_links_that_are_proven_apart_never_touch(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    values = rng.uniform(-2.0, 2.0, robot.nd)
    steps = rng.normal(size=robot.nd)
    begin, end = (
        robot.configuration(joints=dict(zip(robot.joint_names, np.clip(v, -3, 3), strict=True)))
        for v in (values, values + steps)
    )
    proof = fp.certify_edge(robot, fp.Scene(), begin, end)
    apart = self_apart(robot, begin, end)
    assert apart > 0.0 if proof.free else apart <= 1e-3


def test_two_sliders_that_pass_through_each_other_are_caught():
    """Each travels less than the sum of the clearances at the ends; both together travel more."""
    small = inertial(1.0, (0.01, 0.01, 0.01))
    robot = robot_from_urdf(
        urdf(
            link("base", inertial(10.0, (1.0, 1.0, 1.0)), box((0.1, 0.1, 0.1), (0, 0, -3))),
            link("a", small, box((0.2, 0.2, 0.2))),
            link("b", small, box((0.2, 0.2, 0.2))),
            joint("slide_a", "prismatic", "base", "a", (0, 0, 0), axis=(1, 0, 0)),
            joint("slide_b", "prismatic", "base", "b", (0, 0, 0), axis=(1, 0, 0)),
        ),
        "sliders",
    )
    begin = robot.configuration(joints={"slide_a": -1.0, "slide_b": 1.0})
    end = robot.configuration(joints={"slide_a": 1.0, "slide_b": -1.0})
    proof = fp.certify_edge(robot, fp.Scene(), begin, end, mode="attitude-held")
    assert not proof.free
    assert {proof.link, proof.obstacle} == {"a", "b"}

"""The reading of a URDF that verification relies on, against Pinocchio and closed forms."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes.mesh_files import hull
from ffsr_plan.robots.collision_shapes import convex
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.verification import solids
from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.closed_forms import clearance, clearances
from tests.helpers.solid_distances import separation
from tests.helpers.urdf_builders import (
    box,
    cylinder,
    inertial,
    joint,
    link,
    random_configuration,
    random_robot,
    random_scene,
    urdf,
)

seeds = st.integers(0, 10_000)


@given(seeds)
def test_link_poses_agree_with_pinocchio(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = random_configuration(robot, rng)
    joints = {k: np.array([v]) for k, v in robot.components(q).joints.items()}
    poses = Bodies(robot.urdf).link_poses(pose(q[None, :3], q[None, 3:7]), joints)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    for name, found in poses.items():
        expected = data.oMf[robot.model.getFrameId(name)].homogeneous
        assert np.allclose(found[0], expected, atol=1e-12)


@given(seeds)
def test_the_pairs_that_must_not_touch_are_those_of_the_robot(seed):
    robot = random_robot(seed)
    shapes = robot.collision_model.geometryObjects
    planned = {
        frozenset(robot.link_of(shapes[k]) for k in (p.first, p.second))
        for p in robot.collision_model.collisionPairs
    }
    assert {frozenset((a.link, b.link)) for a, b in Bodies(robot.urdf).pairs()} == planned


def test_rigidly_joined_links_are_no_pair_but_others_are():
    cube = inertial(1.0, (1.0, 1.0, 1.0)) + box((0.2, 0.2, 0.2))
    text = urdf(
        link("base", cube), link("mast", cube), link("arm", cube), link("hand", cube),
        joint("weld", "fixed", "base", "mast", (0, 0, 0.3)),
        joint("shoulder", "revolute", "mast", "arm", (0.3, 0, 0)),
        joint("wrist", "revolute", "arm", "hand", (0.3, 0, 0)),
    )  # fmt: skip
    pairs = {frozenset((a.link, b.link)) for a, b in Bodies(text).pairs()}
    assert pairs == {frozenset(p) for p in (("base", "hand"), ("mast", "hand"), ("base", "arm"))}
    assert len(robot_from_urdf(text, "welded").collision_model.collisionPairs) == 3


@given(seeds)
def test_distances_agree_with_the_scalar_closed_form(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    q = np.array([random_configuration(robot, rng) for _ in range(3)])
    expected = [clearance(robot, scene, each) for each in q]
    assert np.allclose(clearances(robot, scene, q), expected, atol=1e-12)


@given(seeds)
def test_separation_is_positive_exactly_when_two_boxes_are_apart(seed):
    rng = np.random.default_rng(seed)
    halves = rng.uniform(0.1, 1.0, (2, 3))
    placed = [
        pin.SE3(pin.exp3(rng.normal(size=3)), far * rng.uniform(-1, 1, 3)) for far in (0.0, 2.0)
    ]
    boxes = [coal.Box(2 * h) for h in halves]
    transforms = [coal.Transform3s(p.rotation, p.translation) for p in placed]
    distance = coal.distance(
        boxes[0], transforms[0], boxes[1], transforms[1],
        coal.DistanceRequest(), coal.DistanceResult(),
    )  # fmt: skip
    shapes = [solids.box("", np.eye(4), h) for h in halves]
    poses = [p.homogeneous[None] for p in placed]
    found = separation(shapes[0], poses[0], shapes[1], poses[1])[0]
    assert (found > 0) == (distance > 0) or abs(distance) < 1e-6
    assert found <= max(distance, 0.0) + 1e-6


def test_separation_of_a_box_and_a_sphere_is_their_distance():
    cube = solids.box("", np.eye(4), np.ones(3))
    ball = solids.ball("", np.eye(4), 0.5)
    away = np.eye(4)[None].copy()
    away[0, 0, 3] = 2.0
    here = np.eye(4)[None]
    assert separation(cube, here, ball, away)[0] == pytest.approx(0.5)
    assert separation(ball, away, cube, here)[0] == pytest.approx(0.5)


@given(seeds, st.sampled_from(["capsule", "prism", "box"]), st.sampled_from(["capsule", "prism"]))
def test_separation_is_positive_for_solids_ten_micrometres_apart(seed, first, second):
    rng = np.random.default_rng(seed)

    def solid(kind):
        radius, length = rng.uniform((0.03, 0.05), (0.2, 0.6))
        if kind == "capsule":
            return solids.capsule("", np.eye(4), radius, length), coal.Capsule(radius, length)
        if kind == "box":
            half = rng.uniform(0.03, 0.3, 3)
            return solids.box("", np.eye(4), half), coal.Box(2 * half)
        turn = np.arange(24) * np.pi / 12
        ring = np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
        points = np.vstack([np.insert(ring, 2, z, axis=1) for z in (-length, length)])
        corners, triangles = hull(points, "", "")
        return solids.Shape("", np.eye(4), corners), convex(corners, triangles)

    (a, coal_a), (b, coal_b) = solid(first), solid(second)
    parallel = seed % 2  # faces and axes side by side are the hardest
    here = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    turn = np.eye(3) if parallel else pin.exp3(rng.normal(size=3))
    towards = rng.normal(size=3)
    towards /= np.linalg.norm(towards)

    def planned(far):
        there = here * pin.SE3(turn, far * towards)
        transforms = [coal.Transform3s(p.rotation, p.translation) for p in (here, there)]
        found = coal.distance(
            coal_a, transforms[0], coal_b, transforms[1],
            coal.DistanceRequest(), coal.DistanceResult(),
        )  # fmt: skip
        return found, there

    low, high = 0.0, 3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if planned(middle)[0] > 1e-5 else (middle, high)
    distance, there = planned(high)
    found = separation(a, here.homogeneous[None], b, there.homogeneous[None])[0]
    assert 0.0 < found <= distance + 1e-9


def test_a_cylinder_without_a_replacement_is_refused():
    can = urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0)), cylinder(0.3, 1.0)))
    with pytest.raises(InvalidInput, match="cylinder of link 'base'"):
        Bodies(can)

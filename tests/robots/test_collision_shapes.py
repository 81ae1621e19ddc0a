"""Collision shapes: capsules as they are, cylinders and meshes inside a solid, all on record."""

import pickle

import coal
import numpy as np
import pinocchio as pin
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.meshes.mesh_files import hull
from ffsr_plan.robots.collision_shapes import Containers, convex, sharpen
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.verification.solids import Shape
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers import closed_forms
from tests.helpers.single_link_robots import MASS, blob, inside_out, one_link
from tests.helpers.solid_distances import sphere_distance
from tests.helpers.urdf_builders import (
    box,
    capsule,
    cylinder,
    joint,
    link,
    mesh,
    random_configuration,
    random_robot,
    random_scene,
    sphere,
    urdf,
)

seeds = st.integers(0, 10_000)
KINDS = ("hull", "capsule")


@given(seeds)
def test_clearance_of_capsules_equals_the_closed_form(seed):
    robot, rng = random_robot(seed, solids=(capsule,)), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    q = random_configuration(robot, rng)
    expected = closed_forms.clearance(robot, scene, q)
    assert fp.clearance(robot, scene, q) == pytest.approx(expected, abs=1e-12)
    assert closed_forms.clearances(robot, scene, q[None])[0] == pytest.approx(expected, abs=1e-12)


@given(seeds, st.sampled_from(KINDS))
def test_clearance_with_cylinders_equals_the_independent_one(seed, kind):
    robot = random_robot(seed, solids=(capsule, cylinder), containers=Containers(cylinders=kind))
    rng = np.random.default_rng(seed)
    scene = random_scene(rng, low=-1, high=1)
    q = random_configuration(robot, rng, spread=0.5)
    assert fp.clearance(robot, scene, q) == pytest.approx(
        closed_forms.clearances(robot, scene, q[None])[0], abs=1e-9
    )
    assert Bodies(robot.urdf, "", robot.replacements).uncovered({}) == []


def test_a_link_with_a_capsule_keeps_all_its_shapes():
    """Pinocchio's own reader drops them all."""
    tip = link(
        "tip", MASS, box((0.2, 0.2, 0.2)), capsule(0.1, 0.5), sphere(0.1), cylinder(0.1, 0.3)
    )
    text = urdf(link("base", MASS), tip, joint("j", "fixed", "base", "tip", (0, 0, 1)))
    robot = robot_from_urdf(text, "made")
    names = [g.name for g in robot.collision_model.geometryObjects]
    assert names == ["tip_0", "tip_1", "tip_2", "tip_3"]
    assert {robot.link_of(g) for g in robot.collision_model.geometryObjects} == {"tip"}
    assert sum(i.mass for i in robot.model.inertias) == 4.0
    above = fp.Scene([[0, 0, 2]], [0.1])
    assert fp.clearance(robot, above, robot.neutral()) == pytest.approx(2 - 1 - 0.25 - 0.1 - 0.1)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("radius", "length"), [(0.1, 0.6), (0.2, 0.1), (0.05, 0.1)])
def test_a_cylinder_lies_inside_its_replacement(kind, radius, length):
    place = {"xyz": (0.3, -0.2, 0.1), "rpy": (0.4, -0.7, 1.1)}
    robot = one_link(cylinder(radius, length, **place), containers=Containers(cylinders=kind))
    (replaced,) = robot.replacements
    assert replaced.shape == "cylinder"
    turn = pin.rpy.rpyToMatrix(*place["rpy"])
    rng = np.random.default_rng(0)
    angle, up = rng.uniform(0, 2 * np.pi, 300), rng.choice([-0.5, 0.5], 300) * length
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), up])
    out = rng.normal(size=(300, 3)) * 2
    for points, sign in ((rim, 1), (out, -1)):
        world = points @ turn.T + place["xyz"]
        gap = np.array([fp.clearance(robot, fp.Scene([p], [1e-9]), robot.neutral()) for p in world])
        beyond = np.maximum(np.hypot(*points[:, :2].T) - radius, 0.0)
        true = np.hypot(beyond, np.maximum(np.abs(points[:, 2]) - 0.5 * length, 0.0))
        assert np.all(gap <= true + 1e-9)
        if sign < 0:
            assert np.all(gap >= true - replaced.excess - 1e-8)
    if kind == "hull":
        assert replaced.excess < 0.01 * radius
    elif length >= 2 * radius:
        assert replaced.excess == pytest.approx((np.sqrt(2) - 1) * radius)


@pytest.mark.parametrize("seed", range(5))
def test_the_capsule_around_a_cylinder_has_the_least_excess(seed):
    radius, length = np.random.default_rng(seed).uniform(0.05, 0.5, 2).tolist()
    (replaced,) = one_link(
        cylinder(radius, length), containers=Containers(cylinders="capsule")
    ).replacements
    inset = np.linspace(0.0, 0.5 * length, 5001)
    outer = np.hypot(radius, inset)
    least = np.min(np.maximum(outer - radius, outer - inset))
    assert replaced.excess == pytest.approx(least, rel=1e-3)
    assert replaced.excess <= least + 1e-12


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_scaled_and_placed_mesh_lies_in_its_replacement(tmp_path, suffix, kind):
    blob(1).export(tmp_path / f"blob.{suffix}")
    scale, place = (0.5, -2.0, 1.5), {"xyz": (0.3, -0.2, 0.1), "rpy": (0.4, -0.7, 1.1)}
    solid = trimesh.load_mesh(tmp_path / f"blob.{suffix}")
    robot = one_link(
        mesh(f"blob.{suffix}", scale, **place),
        package_dirs=[str(tmp_path)],
        containers=Containers(meshes=kind),
    )
    turn = pin.rpy.rpyToMatrix(*place["rpy"])
    solid.vertices = np.array(solid.vertices * scale) @ turn.T + place["xyz"]
    solid = trimesh.convex.convex_hull(solid)
    for vertex in solid.vertices:
        assert fp.clearance(robot, fp.Scene([vertex], [1e-3]), robot.neutral()) <= -1e-3 + 1e-9
    points = np.random.default_rng(0).uniform(-0.8, 0.8, (60, 3)) + solid.vertices.mean(axis=0)
    found = [fp.clearance(robot, fp.Scene([p], [0.05]), robot.neutral()) for p in points]
    true = inside_out(solid, points) - 0.05
    (replaced,) = robot.replacements
    assert np.all(found <= true + 1e-9)
    assert np.all(found >= true - replaced.excess - 1e-9)
    assert replaced.shape == f"mesh blob.{suffix}"
    if kind == "hull":
        assert np.allclose(found, true, atol=1e-9)
        assert replaced.by == f"convex hull of {len(solid.vertices)} vertices"


@given(seeds)
@settings(max_examples=20)
def test_the_excess_of_a_fitted_capsule_is_attained(seed):
    points = blob(seed).vertices
    address = "kept"
    robot = one_link(mesh(address), meshes={address: points}, containers=Containers("capsule"))
    (replaced,) = robot.replacements
    ends, radius = np.array(replaced.points), replaced.radius
    rng = np.random.default_rng(seed)
    out = rng.normal(size=(2000, 3))
    out /= np.linalg.norm(out, axis=1)[:, None]
    surface = np.vstack([end + radius * out for end in ends])
    beyond = inside_out(trimesh.convex.convex_hull(points), surface)
    assert beyond.max() <= replaced.excess + 1e-9
    assert beyond.max() >= 0.98 * replaced.excess


def rounded(seed):
    """An ellipsoid of 2000 corners, off its frame's origin."""
    rng = np.random.default_rng(seed)
    out = rng.normal(size=(2000, 3))
    out /= np.linalg.norm(out, axis=1)[:, None]
    return out * rng.uniform(0.02, 0.5, 3) + rng.uniform(-1, 1, 3)


MANY = {
    "tip": lambda: trimesh.creation.cone(0.1, 0.3, sections=255).vertices,
    "tip of a fine cone": lambda: trimesh.creation.cone(0.1, 0.3, sections=1000).vertices,
    "flat caps": lambda: trimesh.creation.cylinder(0.1, 0.3, sections=256).vertices,
    "thin disc": lambda: trimesh.creation.cylinder(0.1, 1e-6, sections=256).vertices,
    "needle": lambda: trimesh.creation.cylinder(1e-5, 2.0, sections=256).vertices,
    "round": lambda: trimesh.creation.icosphere(4, 0.2).vertices,
} | {f"ellipsoid {k}": lambda k=k: rounded(k) for k in range(3)}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", MANY)
def test_a_hull_of_many_vertices_lies_in_a_simpler_solid(what, kind):
    """Coal crashes where a vertex has 255 neighbours, and thousands of vertices are slow."""
    points = np.array(MANY[what]())
    robot = one_link(mesh("kept"), meshes={"kept": points}, containers=Containers(kind))
    (replaced,) = robot.replacements
    assert Bodies(robot.urdf, "", robot.replacements).uncovered(robot.meshes) == []
    assert type(replaced.excess) is float
    original = Shape("", np.eye(4), points)
    surface = np.array(replaced.points)
    if kind == "capsule":
        out = np.random.default_rng(0).normal(size=(500, 3))
        out *= replaced.radius / np.linalg.norm(out, axis=1)[:, None]
        surface = (surface[:, None] + out).reshape(-1, 3)
    else:
        assert len(surface) <= 250
        assert replaced.by.startswith(f"solid of {len(surface)} vertices around the convex hull")
        assert replaced.excess < 0.021 * np.ptp(points, axis=0).max()
    beyond = sphere_distance(original, np.eye(4)[None], surface, np.zeros(len(surface)))[0]
    assert beyond.max() <= replaced.excess + 1e-9
    assert beyond.max() >= 0.98 * replaced.excess - 1e-8


def test_hulls_of_few_vertices_are_taken_as_they_are():
    points = np.array(trimesh.creation.cone(0.1, 0.3, sections=249).vertices)
    robot = one_link(mesh("kept"), meshes={"kept": points})
    assert robot.replacements[0].by == "convex hull of 250 vertices"
    assert robot.replacements[0].excess == 0.0


@given(seeds)
@settings(max_examples=20)
def test_hulls_are_centred_in_a_tight_box_of_their_own_frame(seed):
    points = blob(seed).vertices
    robot = one_link(mesh("kept", rpy=(0.3, 0.2, 0.1)), meshes={"kept": points})
    (shape,) = robot.collision_model.geometryObjects
    corners = np.array(shape.geometry.points())
    assert np.allclose(corners.min(axis=0), -corners.max(axis=0), atol=1e-15)
    tight = trimesh.bounds.oriented_bounds(points)[1]
    assert np.prod(np.ptp(corners, axis=0)) <= np.prod(tight) * (1 + 1e-9)
    assert np.linalg.det(shape.placement.rotation) == pytest.approx(1.0)


@given(seeds)
@settings(max_examples=30)
def test_self_distance_bounds_of_verification_match_coal(seed):
    robot = random_robot(seed, solids=(capsule, cylinder, cylinder))
    rng, query = np.random.default_rng(seed), SelfQuery(robot)
    bodies = Bodies(robot.urdf, "", robot.replacements)
    if query.empty:
        return
    from ffsr_plan.verification.urdf_reading import pose
    from tests.helpers.solid_distances import separation

    for _ in range(3):
        q = random_configuration(robot, rng)
        joints = {k: np.array([v]) for k, v in robot.components(q).joints.items()}
        poses = bodies.link_poses(pose(q[None, :3], q[None, 3:7]), joints)
        found = min(
            separation(a, poses[a.link] @ a.placement, b, poses[b.link] @ b.placement)[0]
            for a, b in bodies.pairs()
        )
        planned = query.distance(q)
        assert found <= max(planned, 0.0) + 1e-9
        assert (found > 0.0) == (planned > 0.0) or abs(planned) < 1e-6


@pytest.mark.parametrize("far", [0.21, 1.0, 5.0])
def test_sharpened_distances_to_a_finely_curved_hull_are_exact(far):
    """By default Coal is a millionth of the distance too far off, to the unsafe side."""
    points = np.array(trimesh.creation.uv_sphere(radius=0.2, count=[32, 64]).vertices)
    solid = convex(*hull(points, "", ""))
    shape = Shape("", np.eye(4), points)
    errors = {"default": 0.0, "sharpened": 0.0}
    away = np.random.default_rng(0).normal(size=(100, 3))
    centers = far * away / np.linalg.norm(away, axis=1)[:, None]
    true = sphere_distance(shape, np.eye(4)[None], centers, np.full(100, 0.001))[0]
    for center, expected in zip(centers, true, strict=True):
        for name in errors:
            request, place = coal.DistanceRequest(), coal.Transform3s()
            if name == "sharpened":
                sharpen(request)
            place.setTranslation(center)
            found = coal.distance(
                solid,
                coal.Transform3s(),
                coal.Sphere(0.001),
                place,
                request,
                coal.DistanceResult(),
            )
            errors[name] = max(errors[name], abs(found - expected))
    assert errors["sharpened"] < 1e-8
    assert errors["default"] < 1e-5 * far


def test_shapes_are_recorded_and_exact_ones_are_not(tmp_path):
    blob(2).export(tmp_path / "blob.stl")
    robot = one_link(
        box((1, 1, 1)),
        cylinder(0.1, 0.2),
        mesh("blob.stl"),
        capsule(0.1, 0.2),
        package_dirs=[str(tmp_path)],
    )
    assert [(r.link, r.number, r.shape) for r in robot.replacements] == [
        ("base", 1, "cylinder"),
        ("base", 2, "mesh blob.stl"),
    ]
    assert [r.by.split(" of")[0] for r in robot.replacements] == ["prism", "convex hull"]
    assert robot.replacements[1].excess == 0.0
    twin = pickle.loads(pickle.dumps(robot))
    q, scene = robot.neutral(), fp.Scene([[0.1, 1.2, 0.3]], [0.1])
    assert fp.clearance(twin, scene, q) == fp.clearance(robot, scene, q)


BAD_SHAPES = [
    ("<capsule radius='0' length='1'/>", "capsule, radius.*greater than 0"),
    ("<capsule radius='1'/>", "capsule, length.*1 finite number"),
    ("<cylinder radius='1' length='-1'/>", "cylinder, length.*greater than 0"),
    ("<cylinder radius='nan' length='1'/>", "cylinder, radius.*finite"),
    ("<mesh/>", "mesh, filename.*address"),
    ("<mesh filename='a.stl' scale='1 0 1'/>", "mesh, scale.*other than 0"),
    ("<mesh filename='a.stl' scale='1 1'/>", "mesh, scale.*3 finite"),
    ("<cone radius='1'/>", "box, sphere, capsule, cylinder, mesh"),
    ("", "one shape of"),
    ("<box size='1 1 1'/><sphere radius='1'/>", "one shape of"),
]


@pytest.mark.parametrize(("shape", "message"), BAD_SHAPES, ids=[s[0] for s in BAD_SHAPES])
def test_a_shape_that_is_not_one_is_refused_with_its_link(shape, message):
    text = f"<collision><geometry>{shape}</geometry></collision>"
    with pytest.raises(fp.InvalidInput, match=f"link 'base', collision.*{message}"):
        one_link(text)


def test_an_origin_that_is_no_number_is_refused():
    text = box((1, 1, 1)).replace("xyz='0.0 0.0 0.0'", "xyz='0 nan 0'")
    with pytest.raises(fp.InvalidInput, match="origin, xyz"):
        one_link(text)


def test_unknown_containers_are_refused():
    for wrong in (Containers("mesh"), Containers(cylinders="box")):
        with pytest.raises(fp.InvalidInput, match="hull, capsule"):
            one_link(box((1, 1, 1)), containers=wrong)
    with pytest.raises(fp.InvalidInput, match="did you mean 'capsule'"):
        fp.load_robot("point", cylinders="capsules")


@given(seeds)
@settings(max_examples=10)
def test_the_triangles_of_a_hull_face_outwards(seed):
    corners, triangles = hull(blob(seed).vertices, "", "")
    a, b, c = corners[triangles.T]
    assert np.all(np.sum(np.cross(b - a, c - a) * (a - corners.mean(axis=0)), axis=1) > 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_a_solid_that_does_not_contain_a_cylinder_is_found(kind):
    robot = one_link(cylinder(0.1, 0.5), containers=Containers(cylinders=kind))
    (good,) = robot.replacements
    points = np.array(good.points)
    narrow, short = points * (0.98, 0.98, 1.0), points * (1.0, 1.0, 0.98)
    aside = points + np.array([1e-3, 0.0, 0.0])
    for changed in (short, aside) if kind == "capsule" else (narrow, short, aside):
        bad = good._replace(points=tuple(map(tuple, changed.tolist())))
        assert Bodies(robot.urdf, "", [bad]).uncovered({}) == ["base"]
    if kind == "capsule":
        thin = good._replace(radius=good.radius - 1e-6)
        assert Bodies(robot.urdf, "", [thin]).uncovered({}) == ["base"]
    assert Bodies(robot.urdf, "", [good]).uncovered({}) == []

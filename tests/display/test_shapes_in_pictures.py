"""Figures, movies and pages show shapes and zones, and are large enough for them."""

import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
import umsgpack
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Polygon
from matplotlib.path import Path

import ffsr_plan as fp
from ffsr_plan.display import figures
from ffsr_plan.display.flights.flight_figure import flight_figure
from ffsr_plan.display.flights.flight_samples import FlownProblem
from ffsr_plan.display.live.opening_page import opening_page
from ffsr_plan.display.motion_page import Axis, PlayedMotion, motion_page, obstacle_names
from ffsr_plan.display.movie_frames import MovingScene, PanelCurve, pictures, robot_outlines
from ffsr_plan.display.movie_obstacles import RINGS, draw_shaded
from ffsr_plan.display.scenes.picture_data import drawn_solid, motion_frames, near_track
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.shape_outlines import mesh_of, outline_of
from ffsr_plan.lattice.layered_lattice import LayeredLattice

SHAPES = (
    fp.Box([1.6, 0.1, 0.8], [2.2, 2.0, 0.0], [0.5, 0.0, 0.0], "solar panel"),
    fp.Capsule(0.15, 1.0, [3.5, -1.9, 0.0], [0.0, 0.0, 1.3]),
    fp.Cylinder(0.35, 0.9, [1.0, -2.1, 0.0], [0.0, np.pi / 2.0, 0.0], "tank"),
    fp.Ellipsoid([0.8, 0.4, 0.3], [5.0, 1.6, 0.0], [0.4, 0.2, 0.1]),
    fp.Hull(np.random.default_rng(1).normal(size=(20, 3)) * 0.35, [0.2, 2.2, 0.0]),
)
ZONES = (fp.Box([16.0, 8.0, 3.0], [5, 0, 0], name="hall"), fp.HalfSpace([1.0, 0.2, 0], [11, 0, 0]))


def with_scene(plan, scene):
    return replace(plan, problem=replace(plan.problem, scene=scene))


@pytest.fixture(scope="module")
def shaped(fig2a_plan):
    old = fig2a_plan.problem.scene
    return with_scene(fig2a_plan, fp.Scene(old.centers, old.radii, shapes=SHAPES, keep_in=ZONES))


@pytest.fixture(scope="module")
def frames(shaped):
    return motion_frames(shaped.problem.robot, shaped.at(np.linspace(0.0, 1.0, 5)))


def legend(figure, ax):
    (shown,) = [*figure.legends, *([ax.get_legend()] if ax.get_legend() else [])]
    return [text.get_text() for text in shown.get_texts()]


@pytest.mark.parametrize("view", ["path", "side"])
def test_a_flat_figure_has_the_outline_of_each_shape(shaped, view):
    figure = figures.path_figure(shaped, view=view, colours={"obstacles": "#123456"})
    (ax,) = figure.axes
    axes = view_axes(shaped.problem)[[0, 1] if view == "path" else [0, 2]]
    drawn = [k for k in ax.collections if isinstance(k, PolyCollection)]
    solid = next(k for k in drawn if len(k.get_paths()) == len(SHAPES))
    for path, shape in zip(solid.get_paths(), SHAPES, strict=True):
        expected = outline_of(shape, axes)
        assert np.allclose(path.vertices[: len(expected)], expected)
    assert np.allclose(solid.get_facecolor()[0, :3], np.array([0x12, 0x34, 0x56]) / 255.0)
    count = len(shaped.problem.scene.radii)
    numbers = [str(k) for k in range(count)]
    names = ["solar panel", str(count + 1), "tank", str(count + 3), str(count + 4)]
    assert [text.get_text() for text in ax.texts] == numbers + names
    assert legend(figure, ax)[-1] == "keep-in zone: hall"
    assert ax.get_xlim()[0] < -3.0
    assert ax.get_xlim()[1] > 13.0


def test_what_is_outside_of_a_zone_is_tinted_and_its_border_dashed(shaped):
    figure = figures.path_figure(shaped)
    (ax,) = figure.axes
    borders = [
        k for k in ax.collections if isinstance(k, LineCollection) and len(k.get_paths()) == 1
    ]
    assert [len(k.get_paths()[0].vertices) for k in borders] == [5, 2]
    tints = [k.get_path() for k in ax.patches + list(ax.artists) if isinstance(k, PathPatch)]
    assert len(tints) == 2
    for point, tinted in (((0.0, 0.0), 0), ((-3.5, 0.0), 1), ((12.5, 0.0), 1), ((13.5, 0.0), 2)):
        rings = [
            [Path(ring).contains_point(point) for ring in path.to_polygons()] for path in tints
        ]
        assert sum(outer and not hole for outer, hole in rings) == tinted
    before = figures.path_figure(shaped).axes[0].dataLim
    without = replace(shaped.problem.scene, keep_in=ZONES[:1])
    after = figures.path_figure(with_scene(shaped, without)).axes[0].dataLim
    assert np.array_equal(before.get_points(), after.get_points())  # a half-space has no extent


def test_the_figure_in_perspective_holds_shapes_and_zones(shaped):
    figure = figures.path_figure(shaped, 3, view="3d")
    (ax,) = figure.axes
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    assert np.allclose(limits, [[-3.0, 13.0], [-4.0, 4.0], [-1.5, 1.5]])
    texts = [text.get_text() for text in ax.texts]
    assert texts[-5:] == ["solar panel", "7", "tank", "9", "10"]
    assert legend(figure, ax)[-1] == "keep-in zone: hall"
    (solids,) = ax.collections
    without = replace(shaped.problem.scene, shapes=())
    (spheres,) = figures.path_figure(with_scene(shaped, without), 3, view="3d").axes[0].collections
    assert len(solids._faces) > len(spheres._faces) + 100
    dashes = np.concatenate(
        [np.transpose(k.get_data_3d()) for k in ax.lines if len(k.get_data_3d()[0])]
    )
    dashes = dashes[np.isfinite(dashes).all(axis=1)]
    assert np.allclose(dashes.min(axis=0), [-3.0, -4.32, -1.82], atol=0.5)


def moving(plan, frames, scene):
    problem = replace(plan.problem, scene=scene)
    axes = view_axes(problem)
    curve = PanelCurve(np.linspace(0.0, 1.0, 5), [], "#ffffff")
    robot = robot_outlines(frames, axes, "visual")
    words = [[]] * 5
    return MovingScene(problem, "title", frames, axes, robot, [curve], words, None, 0.2)


def pixels(plan, frames, scene):
    first = pictures(moving(plan, frames, scene), 800)[0]
    return np.asarray(first).astype(int)


def test_a_movie_shows_shapes_where_they_are(shaped, frames):
    """The hall's outline gives the scale; pixels change at the shapes and their rings alone."""
    scene = shaped.problem.scene
    empty = replace(scene, shapes=())
    changed = np.abs(pixels(shaped, frames, scene) - pixels(shaped, frames, empty)).sum(axis=2) > 30
    low, scale = np.array([-3.3, -4.3]), 800 / 16.6
    height = round(800 * 8.6 / 16.6)
    rows, columns = np.nonzero(changed)
    points = np.column_stack([columns, height - rows]) / scale + low
    for shape in SHAPES:
        middle = outline_of(shape, np.eye(3)[:2]).mean(axis=0)
        assert np.min(np.linalg.norm(points - middle, axis=1)) < 0.1, shape.word
    corners = [outline_of(shape, np.eye(3)[:2]) for shape in SHAPES]
    far = np.min([np.linalg.norm(points[:, None] - k, axis=2).min(axis=1) for k in corners], axis=0)
    assert far.max() < 0.9


def test_a_movie_shows_zones(shaped, frames):
    scene = shaped.problem.scene
    change = pixels(shaped, frames, scene) - pixels(
        shaped, frames, replace(scene, keep_in=ZONES[:1])
    )
    tinted = np.abs(change).sum(axis=2) > 5
    columns = np.flatnonzero(tinted[:400].any(axis=0))
    assert columns.min() > 800 * (10.0 + 3.3) / 16.6
    assert columns.max() == 799


def rings_in(ax):
    dashed = [k for k in ax.patches if isinstance(k, Polygon) and k.get_linestyle() != "-"]
    return [k for k in dashed if np.allclose(k.get_edgecolor()[:3], to_rgb(RINGS))]


def test_rings_are_at_the_stated_distance_from_the_cut_of_a_shape():
    """The ball is above the plane of motion."""
    ax, above = Figure().subplots(1, 2)
    scene = fp.Scene(shapes=[fp.Cylinder(0.5, 4.0, [1.0, 0, 0]), fp.Ball(0.5, [0, 0, 3.0])])
    both = np.ones(2, dtype=bool)
    draw_shaded(ax, scene, np.eye(3), both, np.zeros((2, 3)), 0.3)
    (ring,) = rings_in(ax)
    assert np.allclose(np.linalg.norm(ring.get_xy() - [1.0, 0.0], axis=1), 0.8, atol=5e-3)
    draw_shaded(above, scene, np.eye(3), both, np.array([[0, 0, 0], [0, 0, 1.0]]), 0.3)
    assert not rings_in(above)  # the track leaves the plane


def commands_of(html):
    text = re.search(r'"commands": (\[.*?\])', html, flags=re.S)[1]
    unpacked = [umsgpack.unpackb(base64.b64decode(k)) for k in json.loads(text)]
    return {k["path"]: k["object"] for k in unpacked if k["type"] == "set_object"}


def positions(drawn):
    (geometry,) = drawn["geometries"]
    packed = geometry["data"]["attributes"]["position"]["array"]
    return np.frombuffer(packed.data, np.float32).reshape(-1, 3)


@pytest.fixture(scope="module")
def page(shaped, frames):
    axis = Axis("s", "", "s", 1.0, 1.0, 1)
    return motion_page(PlayedMotion(shaped.problem, frames, axis, [], "", "title", ""))


def test_a_page_has_one_mesh_of_all_solid_shapes_and_the_zones(page):
    drawn = commands_of(page)
    names = sorted(k.removeprefix("/meshcat/") for k in drawn if "obstacles" in k or "zones" in k)
    zones = [f"zones/{k}/{part}" for k in (0, 1) for part in ("edges", "sides")]
    assert names == ["obstacles/near", "obstacles/near_shapes", *zones]
    vertices = np.vstack([mesh_of(shape).vertices for shape in SHAPES])
    assert np.allclose(positions(drawn["/meshcat/obstacles/near_shapes"]), vertices, atol=1e-5)
    corners = positions(drawn["/meshcat/zones/0/sides"])
    assert np.allclose([corners.min(axis=0), corners.max(axis=0)], [[-3, -4, -1.5], [13, 4, 1.5]])
    plane = positions(drawn["/meshcat/zones/1/sides"])
    assert np.allclose(plane @ [1.0, 0.2, 0.0], 11.0, atol=1e-4)


def test_the_camera_of_a_page_sees_shapes_and_zones(page):
    size = json.loads(re.search(r'"size": (\[[^\]]*\]), "fov"', page)[1])
    assert np.allclose(size, np.array([16.0, 8.0, 3.0]) + 0.3)


def test_a_page_names_shapes_and_zones(page, shaped):
    names = json.loads(re.search(r'"names": (\[.*?\}\])', page)[1])
    assert [k["text"] for k in names[-6:]] == ["solar panel", "7", "tank", "9", "10", "hall"]
    assert names[-6]["at"] == [2.2, 2.0, 0.0]
    many = fp.Scene(np.eye(3)[[0] * 40], np.ones(40), shapes=SHAPES)
    assert [k["text"] for k in obstacle_names(many)] == ["solar panel", "tank"]


def test_a_live_view_opens_with_shapes_and_zones(shaped):
    problem = shaped.problem
    drawn = commands_of(opening_page(problem, LayeredLattice(problem), ""))
    assert "/meshcat/obstacles/near_shapes" in drawn
    assert "/meshcat/zones/1/sides" in drawn


def test_the_figure_of_a_flight_has_shapes_and_zones(flight):
    hall = fp.Box([90.0, 90.0, 90.0], name="hall")
    scene = fp.Scene([[5.0, 3.0, 0.0]], [0.5], shapes=SHAPES[:3], keep_in=[hall])
    flown = FlownProblem(replace(flight.problem, scene=scene), flight.limits, flight)
    figure = flight_figure(flown)
    ax = figure.axes[0]
    assert [text.get_text() for text in ax.texts[:4]] == ["0", "solar panel", "2", "tank"]
    assert "keep-in zone: hall" in [text.replace("\n", " ") for text in legend(figure, ax)]
    assert np.ptp(ax.get_xlim()) > 90.0


def test_near_shapes_agree_with_brute_force():
    rng = np.random.default_rng(4)
    places, turns = rng.uniform(-3.0, 3.0, (80, 3)), rng.normal(size=(80, 3))
    shapes = [
        fp.Box(rng.uniform(0.1, 1.0, 3), place, turn)
        if k % 2
        else fp.Capsule(0.2, 0.9, place, turn)
        for k, (place, turn) in enumerate(zip(places, turns, strict=True))
    ]
    scene = fp.Scene(rng.uniform(-3.0, 3.0, (30, 3)), rng.uniform(0.05, 0.5, 30), shapes=shapes)
    positions = rng.uniform(-2.0, 2.0, (25, 3))
    near = near_track(scene, positions, 0.4)
    assert np.array_equal(
        near[:30], near_track(fp.Scene(scene.centers, scene.radii), positions, 0.4)
    )
    for k, shape in enumerate(shapes, start=30):
        corners = mesh_of(shape).triangles
        inside = rng.dirichlet(np.ones(3), (len(corners), 40))  # points on its surface
        surface = np.einsum("kna,kac->knc", inside, corners).reshape(-1, 3)
        distance = np.linalg.norm(surface[:, None] - positions, axis=2).min()
        if abs(distance - 0.4) > 0.05 and distance > 0.1:
            assert near[k] == (distance < 0.4)
    assert 5 < np.count_nonzero(near[30:]) < 75


def test_of_many_shapes_the_near_ones_are_solid(shaped, frames):
    row = [fp.Box([0.1, 0.1, 0.1], [0.0, 0.3 * k, 0.0]) for k in range(61)]
    scene = fp.Scene([[9.0, 9.0, 9.0]], [0.1], shapes=row)
    solid = drawn_solid(scene, np.zeros((1, 3)))
    assert solid.tolist() == [False, True, True, True] + [False] * 58
    axis = Axis("s", "", "s", 1.0, 1.0, 1)
    problem = replace(shaped.problem, scene=scene)
    drawn = commands_of(motion_page(PlayedMotion(problem, frames, axis, [], "", "title", "")))
    counts = [
        len(positions(drawn[f"/meshcat/obstacles/{name}_shapes"])) for name in ("near", "far")
    ]
    assert sum(counts) == 61 * 36
    assert min(counts) > 0
    figure = figures.path_figure(with_scene(shaped, scene))
    groups = [
        (len(k.get_paths()), k.get_alpha())
        for k in figure.axes[0].collections
        if isinstance(k, PolyCollection) and k.get_zorder() <= 2.0
    ]
    assert [alpha for _, alpha in groups] == [1.0, 0.12]
    assert sum(count for count, _ in groups) == 61

"""Figures of a plan are drawn, on axes of their own or on given ones."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

import ffsr_plan as fp
from ffsr_plan.display import figures
from ffsr_plan.display.figure_style import write_figure
from ffsr_plan.display.spatial_figure import shape_triangles
from tests.helpers.picture_measures import colours_and_edges

DRAWN = [figures.path_figure, figures.clearance_figure, figures.convergence_figure]


def test_the_figures_are_drawn_and_not_blank(fig2a_plan, tmp_path):
    written = figures.write_figures(fig2a_plan, tmp_path)
    assert [p.name for p in written] == ["path.png", "clearance.png", "convergence.png"]
    for picture in written:
        colours, edges = colours_and_edges(picture)
        assert colours > 100
        assert edges > 0.002


@pytest.mark.parametrize("draw", DRAWN)
def test_figures_can_be_drawn_on_given_axes(fig2a_plan, draw):
    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert draw(fig2a_plan, ax=right) is figure
    assert right.get_xlabel()
    assert not left.get_xlabel()


@pytest.mark.parametrize(("draw", "name"), list(zip(DRAWN, ("path", "nodes", "best"), strict=True)))
def test_figures_take_colours_and_labels(fig2a_plan, draw, name):
    figure = draw(fig2a_plan, colours={name: "#123456"}, labels={name: "what I call it"})
    (line,) = [k for k in figure.axes[0].lines if k.get_label() == "what I call it"]
    assert to_rgba(line.get_color()) == to_rgba("#123456")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"colours": {"paths": "red"}}, "colours.*did you mean 'path'"),
        ({"colours": {"path": "reddish"}}, "colours.path.*reddish"),
        ({"labels": {"path": 3}}, "labels.path"),
        ({"view": "top"}, "view.*path, side, 3d"),
        ({"silhouettes": 1}, "silhouettes"),
        ({"ax": "left"}, "ax.*axes of a matplotlib figure"),
        ({"ax": Figure().add_subplot(), "view": "3d"}, 'ax.*projection="3d"'),
    ],
)
def test_what_a_figure_cannot_show_is_refused_by_name(fig2a_plan, given, message):
    with pytest.raises(fp.InvalidInput, match=message):
        figures.path_figure(fig2a_plan, **given)


def test_the_figure_in_perspective_has_axes_of_the_world_and_all_solids(fig2a_plan):
    figure = figures.path_figure(fig2a_plan, 3, view="3d")
    (ax,) = figure.axes
    assert [ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()] == ["x [m]", "y [m]", "z [m]"]
    scene = fig2a_plan.problem.scene
    assert [t.get_text() for t in ax.texts] == [str(k) for k in range(len(scene))]
    corners = np.vstack(
        [scene.centers - scene.radii[:, None], scene.centers + scene.radii[:, None]]
    )
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    assert np.all(corners.min(axis=0) >= limits[:, 0] - 1e-6)
    assert np.all(corners.max(axis=0) <= limits[:, 1] + 1e-6)


def test_triangles_of_a_shape_enclose_it_and_face_outwards(robot):
    for shape in robot.collision_model.geometryObjects:
        triangles = shape_triangles(shape)
        middle = triangles.mean(axis=(0, 1))
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        assert np.all(np.sum(normals * (triangles.mean(axis=1) - middle), axis=1) > -1e-12)


@pytest.mark.parametrize(
    ("suffix", "begin"), [("pdf", b"%PDF"), ("svg", b"<?xml"), ("png", b"\x89PNG")]
)
def test_figures_become_vectors_or_pixels_by_the_name_of_the_file(
    fig2a_plan, tmp_path, suffix, begin
):
    first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    for path in (first, second):
        write_figure(figures.clearance_figure(fig2a_plan), path)
    assert first.read_bytes().startswith(begin)
    assert first.read_bytes() == second.read_bytes()
    with pytest.raises(fp.InvalidInput, match=r"\.pdf or \.svg or \.png"):
        write_figure(figures.clearance_figure(fig2a_plan), tmp_path / "a.bmp")

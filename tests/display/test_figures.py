"""Figures of a plan are drawn, on axes of their own or on given ones."""

import pytest

from ffsr_plan.display import figures
from tests.helpers.picture_measures import colours_and_edges


def test_the_figures_are_drawn_and_not_blank(fig2a_plan, tmp_path):
    written = figures.write_figures(fig2a_plan, tmp_path)
    assert [p.name for p in written] == ["path.png", "clearance.png", "convergence.png"]
    for picture in written:
        colours, edges = colours_and_edges(picture)
        assert colours > 100
        assert edges > 0.002


@pytest.mark.parametrize(
    "draw", [figures.path_figure, figures.clearance_figure, figures.convergence_figure]
)
def test_figures_can_be_drawn_on_given_axes(fig2a_plan, draw):
    from matplotlib.figure import Figure

    figure = Figure()
    left, right = figure.subplots(1, 2)
    assert draw(fig2a_plan, axes=right) is figure
    assert right.get_xlabel()
    assert not left.get_xlabel()

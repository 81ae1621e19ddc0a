"""Pages, live views, figures and moving pictures of plans."""

from ffsr_plan.display.figure_style import write_figure
from ffsr_plan.display.figures import (
    clearance_figure,
    convergence_figure,
    path_figure,
    write_figures,
)
from ffsr_plan.display.moving_picture import write_gif

__all__ = [
    "clearance_figure",
    "convergence_figure",
    "path_figure",
    "write_figure",
    "write_figures",
    "write_gif",
]

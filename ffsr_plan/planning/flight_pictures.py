"""`FlightPictures`: figures, pages and moving pictures of a flight."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, cast

from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.display.flights.flight_samples import Flight, FlownProblem


class FlightPictures:
    """What flights through a scene show of themselves.

    Attributes:
        problem: robot, obstacles, start and goal.
        limits: those that the flight keeps.
    """

    problem: Problem
    limits: FlightLimits

    def figure(
        self,
        axes: Mapping[str, Axes] | None = None,
        *,
        silhouettes: int = 7,
        colours: Mapping[str, str] | None = None,
        labels: Mapping[str, str] | None = None,
    ) -> Figure:
        """Path among the obstacles, and speed, thrust, joint rates and attitude over time.

        Limits are dashed lines; one far above the peak is written instead. Thin lines are the times
        of the silhouettes.

        Args:
            axes: matplotlib axes by what is drawn on them: `path`, `speed`, `thrust`, `joints`,
                `slides` (rates of joints that rotate and slide), `attitude`, `wheels`, `clearance`.
                By default a new figure has all that the flight has, but for the clearance.
            silhouettes: of the robot, at equal steps of time.
            colours: matplotlib colours of `path`, `start`, `goal`, `robot`, `obstacles`, `rests`,
                `limit`, `speed`, `thrust`, `clearance`, of a joint by its name, and of `rotation x`
                to `rotation z` and `wheels x` to `wheels z`.
            labels: texts in the legends, by the same names; an empty one leaves an entry out.

        Returns:
            The figure.

        Raises:
            InvalidInput: a name that the figure does not have, or a value that is not allowed.
        """
        from ffsr_plan.display.flights.flight_figure import flight_figure

        style = {"silhouettes": silhouettes, "colours": colours, "labels": labels}
        return flight_figure(self._flown(), axes, **style)  # type: ignore[arg-type]

    def write_figure(self, path: str | Path) -> None:
        """Write the figure as vectors (PDF, SVG) or pixels (PNG).

        Args:
            path: of the file, `.pdf`, `.svg` or `.png`; an existing file is replaced.

        Raises:
            InvalidInput: another kind of file, or one that cannot be written.
        """
        from ffsr_plan.core.checks import path as checked_path
        from ffsr_plan.display.figure_style import FORMATS, write_figure

        target = checked_path("path", path, *FORMATS)
        write_figure(self.figure(), target)

    def _flown(self) -> FlownProblem:
        from ffsr_plan.display.flights.flight_samples import FlownProblem

        return FlownProblem(self.problem, self.limits, cast("Flight", self))

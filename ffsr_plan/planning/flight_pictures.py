"""`FlightPictures`: figures, pages and moving pictures of a flight."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import text
from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.display.flights.flight_samples import Flight, FlownProblem
    from ffsr_plan.display.web.page_server import PageServer


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
        from ffsr_plan.display.figure_style import FORMATS, write_figure

        target = checked_path("path", path, *FORMATS)
        write_figure(self.figure(), target)

    def write_html(self, path: str | Path, title: str = "", *, shapes: str = "visual") -> None:
        """Write one self-contained page that plays the flight in true time; it needs no network.

        Args:
            path: of the file; an existing file is replaced.
            title: heading; by default the robot and the mode.
            shapes: of the robot: `visual`, with meshes where its URDF has them, or `collision`.

        Raises:
            InvalidInput: a path or title that is none, or a file that cannot be written.
        """
        from ffsr_plan.core.text_files import write_text
        from ffsr_plan.display.flights.flight_page import flight_page

        target = checked_path("path", path)
        write_text("page", target, flight_page(self._flown(), text("title", title), shapes=shapes))

    def write_gif(
        self,
        path: str | Path,
        *,
        speed: float | None = None,
        width: int = 720,
        view: str = "path",
        shapes: str = "visual",
    ) -> None:
        """Write the flight as an animated GIF; see `write_movie`.

        Args:
            path: of the file, `.gif`; an existing file is replaced.
            speed: how many times as fast as the flight.
            width: of the picture [px].
            view: `path` or `side`.
            shapes: of the robot, `visual` or `collision`.

        Raises:
            InvalidInput: an argument that is not allowed, or a file that cannot be written.
        """
        from ffsr_plan.display.flights.flight_movie import write_flight_movie

        look: dict[str, Any] = {"width": width, "view": view, "shapes": shapes}
        write_flight_movie(self._flown(), path, (".gif",), speed=speed, **look)

    def write_movie(
        self,
        path: str | Path,
        *,
        speed: float | None = None,
        width: int = 720,
        view: str = "path",
        shapes: str = "visual",
    ) -> None:
        """Write the flight as an animated GIF or PNG, or as MP4 where the program ffmpeg is.

        It has 12.5 pictures a second. Below the scene are a close-up with the rotation of the base,
        the time, and speed and thrust over time. The title states the speed.

        Args:
            path: of the file, `.gif`, `.png` or `.mp4`; an existing file is replaced.
            speed: how many times as fast as the flight, 1 for true time; by default the least of
                1, 2, 5, 10, ... at which it takes 12 s at most.
            width: of the picture [px].
            view: `path`, seen along the normal y' of the path frame, or `side`, along x'.
            shapes: of the robot, `visual` or `collision`; meshes as their convex outlines.

        Raises:
            InvalidInput: an argument that is not allowed, a file that cannot be written, or MP4
                without ffmpeg.
        """
        from ffsr_plan.display.flights.flight_movie import write_flight_movie

        look: dict[str, Any] = {"width": width, "view": view, "shapes": shapes}
        write_flight_movie(self._flown(), path, speed=speed, **look)

    def show(
        self,
        port: int = 0,
        *,
        block: bool | None = None,
        open_browser: bool | None = None,
        title: str = "",
        shapes: str = "visual",
    ) -> PageServer:
        """Show the page of `write_html`, served on 127.0.0.1 by this process; in notebooks too.

        Args:
            port: 0 for any that is free.
            block: whether to go on only after Ctrl-C; by default in scripts.
            open_browser: whether to open the user's browser; by default unless in a notebook, where
                the page appears as a frame below the cell.
            title: as for `write_html`.
            shapes: as for `write_html`.

        Returns:
            The server, with its `url`; `stop()`, or the end of a `with` block, ends it.

        Raises:
            InvalidInput: a port that cannot be had, such as one in use.
        """
        from ffsr_plan.display.flights.flight_page import flight_page
        from ffsr_plan.display.web.browser import serve

        page = flight_page(self._flown(), text("title", title), shapes=shapes)
        return serve(page, port, block, open_browser)

    def _flown(self) -> FlownProblem:
        from ffsr_plan.display.flights.flight_samples import FlownProblem

        return FlownProblem(self.problem, self.limits, cast("Flight", self))

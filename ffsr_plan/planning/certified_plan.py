"""`Plan`: a certified motion with its verification, files, trajectories and pages."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ffsr_plan.core.checks import one_of, text, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import html_table, proven
from ffsr_plan.core.text_files import write_text
from ffsr_plan.planning.scenes_at_rest import refuse_bodies
from ffsr_plan.planning.timing import Timing
from ffsr_plan.plans import plan_file
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.plans.plan_summary import plan_rows
from ffsr_plan.trajectory.csv_tables import BYTES_PER_CELL, path_table, write_csv

if TYPE_CHECKING:
    from ffsr_plan.display.web.page_server import PageServer
    from ffsr_plan.meetings.departure import Departure
    from ffsr_plan.meetings.meeting import Meeting
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan
    from ffsr_plan.planning.smooth_plan import SmoothPlan
    from ffsr_plan.trajectory.flight_limits import FlightLimits
    from ffsr_plan.verification.verify import Report


@dataclass(frozen=True, eq=False, repr=False)
class Plan(Timing, PlanData):
    """A certified whole-body motion. Two plans are equal if all but the computing time is."""

    def _flown(
        self,
        limits: FlightLimits,
        corners: str,
        duration: float | None,
        ends: Meeting | Departure | None,
    ) -> SmoothFlight | TimedPlan:
        from ffsr_plan.planning.flights import smooth_flight, timed_plan
        from ffsr_plan.planning.flights_in_motion import flown_in_motion
        from ffsr_plan.planning.smooth_plan import flown_past_bodies

        if ends is not None:
            return flown_in_motion(self, limits, corners, duration, ends)
        if one_of("corners", corners, ("smooth", "rest")) == "smooth":
            if self.problem.scene.moves:
                return flown_past_bodies(self, limits, duration)
            return smooth_flight(self.smooth(), limits, duration)
        if duration is not None:
            raise InvalidInput("duration", duration, "None with corners='rest'")
        return timed_plan(self, limits)

    def smooth(self) -> SmoothPlan:
        """The plan along a smooth curve without corners, proven free as the plan is.

        The nodes become control points of a cubic spline. Where it comes too close to something,
        more control points are taken, or in the last resort the plan's own path with rests; `kind`
        of the result tells which. Past bodies that move it is proven for the times of the plan: the
        curve is where it belongs to a node when the plan is there.

        Raises:
            UnprovenCurve: nothing could be proven, not even the plan's path with rests.
        """
        from ffsr_plan.planning.smooth_plan import smoothed

        return smoothed(self)

    def least_fuel(self, margin: float = 0.0) -> SmoothPlan:
        """The plan along a smooth curve that needs little fuel, proven free as the plan is.

        The joints move as along `smooth`; the base is displaced so that the velocity of the centre
        of mass changes little, also to hurry or wait while arms move. It is a local search from the
        plan's path: `fp.LeastFuel` also looks for another way past the obstacles of a lattice.
        Where nothing better is found the curve of `smooth` is returned.

        Args:
            margin: clearance to keep beyond the problem's `min_clearance`; less than that of start
                and goal [m].

        Raises:
            InvalidInput: a mode without thrusters, a margin that cannot be kept, or bodies of the
                scene that move.
            UnprovenCurve: see `smooth`.
        """
        from ffsr_plan.planning.smooth_plan import least_fuel

        refuse_bodies("least_fuel", self.problem)
        return least_fuel(self, margin)

    def verify(
        self, samples: int | None = None, on_progress: Callable[[float], object] | None = None
    ) -> Report:
        """Check the plan again, all along and by other code than the planner's; see `Report`.

        Args:
            samples: least number of equal time steps on each edge, 50 by default. Where links are
                closer to obstacles or to each other than they can move in such a step, it is halved
                until nothing can be hidden between two samples.
            on_progress: called with the share of the motion that is done, from 0 to 1.

        Raises:
            InvalidInput: `samples` is not a positive whole number, or too large.
        """
        from ffsr_plan.verification.verify import SAMPLES, verify

        return verify(self, SAMPLES if samples is None else samples, on_progress)

    def save(self, path: str | Path) -> None:
        """Write everything to a JSON file; `Plan.load` gives the same plan back, bit for bit."""
        plan_file.write(self, checked_path("path", path))

    @staticmethod
    def load(path: str | Path) -> Plan:
        """Read a plan that `save` wrote. The file holds the robot's URDF too.

        Raises:
            InvalidInput: no such file, cut short, or changed since it was written.
        """
        return Plan._of(plan_file.read(checked_path("plan file", path)))

    def to_dict(self) -> dict[str, Any]:
        """Everything, as in the file that `save` writes, in plain Python values fit for JSON."""
        return plan_file.to_dict(self)

    @staticmethod
    def from_dict(data: dict[str, Any]) -> Plan:
        """The inverse of `to_dict`.

        Raises:
            InvalidInput: not what `to_dict` gives.
        """
        return Plan._of(plan_file.checked("plan", data))

    @classmethod
    def _of(cls, data: PlanData) -> Plan:
        return cls(**{field.name: getattr(data, field.name) for field in fields(PlanData)})

    def to_csv(self, path: str | Path, samples: int | None = None) -> None:
        """Write the path as a table, one configuration a row, reaction included, units on top.

        Columns: the time where the problem has a duration, path parameter, base origin in the
        world, its quaternion and ZYX angles, joints. An existing file is replaced.
        `timed(...).to_csv` writes a trajectory.

        Args:
            path: of the file.
            samples: rows, evenly spaced in s; without, one for each node.

        Raises:
            InvalidInput: a file that cannot be written, or fewer than two samples.
        """
        rows = self.edges + 1
        if samples is not None:
            rows = whole_number("samples", samples, at_least=2, at_most=1_000_000)
        target, columns = checked_path("path", path), 12 + self.problem.robot.nd
        size = {"samples": rows, "columns": columns}
        check_memory("samples", size, BYTES_PER_CELL, "fewer samples")
        pace = self.problem.pace(self.edges)
        write_csv(target, path_table(self.motion, np.linspace(0.0, 1.0, rows), pace))

    def write_html(self, path: str | Path, title: str = "", *, shapes: str = "visual") -> None:
        """Write one self-contained page that shows the motion; it needs no network.

        Args:
            path: of the file; an existing file is replaced.
            title: heading; by default the robot and the mode.
            shapes: of the robot: `visual`, with meshes where its URDF has them, or `collision`.

        Raises:
            InvalidInput: a path or title that is none, or a file that cannot be written.
        """
        from ffsr_plan.display.plan_page import page

        target = checked_path("path", path)
        write_text("page", target, page(self, text("title", title), shapes=shapes))

    def write_gif(
        self,
        path: str | Path,
        *,
        frames: int = 60,
        width: int = 720,
        view: str = "path",
        shapes: str = "visual",
    ) -> None:
        """Write the motion as an animated GIF that repeats for ever.

        Args:
            path: of the file; an existing file is replaced.
            frames: number of pictures, at equal steps of the path parameter.
            width: of the picture [px].
            view: `path`, seen along the normal y' of the path frame, or `side`, along x'.
            shapes: of the robot, `visual` or `collision`; meshes as their convex outlines.

        Raises:
            InvalidInput: an argument that is not allowed, or a file that cannot be written.
        """
        from ffsr_plan.display.moving_picture import write_gif

        write_gif(self, path, frames=frames, width=width, view=view, shapes=shapes)

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
            block: whether to go on only after Ctrl-C; by default in scripts, whose end ends the
                server, and not in notebooks and at prompts.
            open_browser: whether to open the user's browser; by default unless in a notebook, where
                the page appears as a frame below the cell.
            title: as for `write_html`.
            shapes: as for `write_html`.

        Returns:
            The server, with its `url`; `stop()`, or the end of a `with` block, ends it.

        Raises:
            InvalidInput: a port that cannot be had, such as one in use.
        """
        from ffsr_plan.display.plan_page import page
        from ffsr_plan.display.web.browser import serve

        shown = page(self, text("title", title), shapes=shapes)
        return serve(shown, port, block, open_browser)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Plan):
            return NotImplemented
        return self.to_dict() | {"seconds": 0.0} == other.to_dict() | {"seconds": 0.0}

    __hash__ = None  # type: ignore[assignment]  # equality is by content

    def __repr__(self) -> str:
        problem = self.problem
        gap = f"gap {self.gap:.2%}" if self.optimum_is_exact else f"{self.gap:.2%} above a bound"
        clearance = f"proven clearance {proven(self.certificate.least_clearance)}"
        parts = [
            problem.robot.name,
            str(problem.mode),
            self.planner.name,
            f"L {self.length:.4g} m",
            f"F {self.objective:.6g}",
            gap,
            clearance if len(problem.scene) else "no obstacles",
            *(["interrupted"] if self.interrupted else []),
        ]
        return f"Plan({', '.join(parts)})"

    def _repr_html_(self) -> str:
        return html_table("Plan", dict(plan_rows(self)))

"""Live view of a colony in a browser on this machine."""

from __future__ import annotations

import json
import math
import time
from functools import cache

from ffsr_plan.core.checks import number, text, truth
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.browser import in_notebook, open_in_browser
from ffsr_plan.display.cycle_picture import Snapshot, commands, take
from ffsr_plan.display.meshcat_objects import CommandLog
from ffsr_plan.display.page_server import PageServer
from ffsr_plan.display.picture_data import drawn_solid, motion_frames
from ffsr_plan.display.plan_page import page
from ffsr_plan.display.scene_objects import add_ends, add_obstacles, set_up
from ffsr_plan.display.web.html_template import html_page
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Cycle

_LEAST_INTERVAL = 0.1  # between two pictures [s]
_TIME_SHARE = 0.02  # of the computing time, at most, is spent on pictures
_CURVE_POINTS = 300  # of the curves of F, at most
_BROWSER_TIMEOUT = 5.0  # [s] that a browser has to load the page before the search starts


class LiveView:
    """A page that shows a colony during the search, and finally its plan.

    ```python
    with fp.LiveView(problem) as view:
        plan = fp.plan(problem, on_cycle=view.on_cycle)
        view.finish(plan)
    ```

    Ribbons show pheromone in excess of the least one, dots show the ants of the cycle (larger where
    there are more), and the best path so far is yellow. The view does not change the plan. The page
    shows the newest cycle, at most ten a second.

    Attributes:
        url: address of the page, on 127.0.0.1.
    """

    def __init__(
        self,
        problem: Problem,
        port: int = 0,
        *,
        open_browser: bool | None = None,
        pace: float = 0.0,
        title: str = "",
    ) -> None:
        """Start to serve the page, and wait some seconds for the user's browser to load it.

        Args:
            problem: the problem that will be planned.
            port: TCP port; 0 for any free one.
            open_browser: whether to open the user's browser; by default it is opened except from a
                notebook, where the view appears as a frame.
            pace: least duration of a cycle [s], to slow down fast colonies.
            title: heading; by default the robot and the mode.

        Raises:
            InvalidInput: an argument that is not allowed, such as a port in use.
        """
        if not isinstance(problem, Problem):
            raise InvalidInput("problem", problem, "a Problem")
        opens = not in_notebook() if open_browser is None else truth("open_browser", open_browser)
        self._pace = number("pace", pace, at_least=0.0, at_most=60.0)
        self._title = title = text("title", title)
        self._lattice = LayeredLattice(problem)
        self._history: list[tuple[int, float | None, float | None]] = []
        self._next_picture = self._last_cycle = -math.inf
        self._server = PageServer(_page(self._lattice, title), port)
        self.url = self._server.url
        if opens and open_in_browser(self.url):
            self._server.wait_for_listener(_BROWSER_TIMEOUT)

    def on_cycle(self, cycle: Cycle) -> None:
        """Show a cycle. Pass this method as `plan(on_cycle=...)`.

        Args:
            cycle: the cycle that the colony has completed.

        Raises:
            InvalidInput: the cycle belongs to another lattice.
        """
        begin = time.monotonic()
        entry = (cycle.number, _known(cycle.best), _known(cycle.iteration_best))
        self._history.append(entry)
        if begin >= self._next_picture or cycle.number == cycle.cycles:
            self._show(take(cycle, self._lattice), cycle)
            end = time.monotonic()
            self._next_picture = end + max(_LEAST_INTERVAL, (end - begin) / _TIME_SHARE)
        remaining = self._last_cycle + self._pace - time.monotonic()
        if self._pace and remaining > 0.0:
            time.sleep(remaining)
        self._last_cycle = time.monotonic()

    def finish(self, plan: PlanData) -> None:
        """Play the plan on the page, which no longer needs the server then.

        Waits until open pages have loaded it, at most five seconds.

        Args:
            plan: the plan.

        Raises:
            InvalidInput: `plan` is not a Plan.
        """
        if not isinstance(plan, PlanData):
            raise InvalidInput("plan", plan, "a Plan")
        self._server.replace(page(plan, self._title, playing=True), json.dumps({"over": ""}))

    def stop(self) -> None:
        """Stop the server. Open pages stay as they are."""
        self._server.stop()

    def _show(self, snapshot: Snapshot, cycle: Cycle) -> None:
        step = -(-len(self._history) // _CURVE_POINTS)
        facts = {
            "number": cycle.number,
            "cycles": cycle.cycles,
            "best": _known(cycle.best),
            "distinct": cycle.distinct,
            "ants": int(snapshot.counts[0].sum()),
            "history": [*self._history[:-1:step], self._history[-1]],
        }
        lattice = self._lattice
        self._server.publish(
            cache(lambda: json.dumps({**facts, "commands": commands(snapshot, lattice)}))
        )

    def __enter__(self) -> LiveView:
        if in_notebook():
            from IPython.display import display

            display(self)  # type: ignore[no-untyped-call]
            self._server.wait_for_listener(_BROWSER_TIMEOUT)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: object
    ) -> None:
        if kind is not None:
            reason = str(error) or kind.__name__
            self._server.publish(lambda: json.dumps({"over": reason}))
        self.stop()

    def _repr_html_(self) -> str:
        return self._server._repr_html_()


def _page(lattice: LayeredLattice, title: str) -> str:
    """The page before the first cycle. The camera sees the inner half of the lattice."""
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    problem, scene = lattice.problem, lattice.problem.scene
    straight = lattice.nominal.configurations()
    frames = motion_frames(problem.robot, straight)
    centers, radii = frames.bounding_spheres()
    corners = 0.5 * lattice.offsets[[0, lattice.origin, -1]]  # few ants go farther out
    view = set_up(viewer, problem, centers + corners[:, None, None], radii)
    add_obstacles(viewer["obstacles"], scene, drawn_solid(scene, centers))
    goal = problem.goal if problem.reach_attitude else straight[-1]
    add_ends(viewer, problem.robot, problem.start, goal)
    data = {
        "title": title or f"{problem.robot.name}, {problem.mode}",
        "subtitle": f"search over {lattice.divisions} edges, {lattice.size} offsets a layer, "
        f"δ {problem.delta:g}",
        "commands": log.commands,
        "view": view,
    }
    return html_page("live", data)


def _known(value: float) -> float | None:
    """The value, or None if JSON cannot hold it."""
    return value if math.isfinite(value) else None

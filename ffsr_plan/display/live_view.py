"""`LiveView`: the colony watched while it runs, in a browser on this machine."""

from __future__ import annotations

import json
import math
import time
from functools import cache
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.collision.shape_placements import near_track, shape_placements
from ffsr_plan.core.checks import number, truth
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.browser import in_notebook, open_in_browser
from ffsr_plan.display.cycle_snapshot import Snapshot, commands, take
from ffsr_plan.display.html_template import filled
from ffsr_plan.display.meshcat_objects import CommandLog
from ffsr_plan.display.page_server import PageServer
from ffsr_plan.display.scene_objects import FEW, NEAR, add_ends, add_obstacles, set_up
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Cycle

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_BEAT = 0.1  # least seconds between two pictures
_SHARE = 0.02  # of the colony's time that taking pictures may cost
_POINTS = 300  # of the curves of F
_PATIENCE = 5.0  # seconds that a browser has to show the page before the ants set out
_PLAY = '<script>byId("play").click();</script>\n</body>'


class LiveView:
    """A page that shows a colony at work, and in the end its plan.

    ```python
    with fp.LiveView(problem) as view:
        plan = fp.plan(problem, on_cycle=view.on_cycle)
        view.finish(plan)
    ```

    Pheromone glows where it lies above that of edges without any, dots are the ants of the cycle
    (larger where many pass), the best path so far is yellow. Plans are the same, watched or not. A
    page shows what is newest: cycles that come faster than ten a second are not all drawn.

    Attributes:
        url: where the page is, on 127.0.0.1.
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
        """Start to serve the page; in the user's browser it has a few seconds to appear.

        Args:
            problem: what will be planned.
            port: 0 for any that is free.
            open_browser: whether to open the user's browser; by default unless in a notebook, where
                the view appears as a frame.
            pace: least time of a cycle [s], for colonies too quick for the eye.
            title: instead of robot and mode.

        Raises:
            InvalidInput: an argument that is not allowed, such as a port in use.
        """
        if not isinstance(problem, Problem):
            raise InvalidInput("problem", problem, "a Problem")
        opens = not in_notebook() if open_browser is None else truth("open_browser", open_browser)
        self._pace = number("pace", pace, at_least=0.0, at_most=60.0)
        self._title = title
        self._lattice = LayeredLattice(problem)
        self._history: list[tuple[int, float | None, float | None]] = []
        self._due = self._paced = -math.inf
        self._server = PageServer(_page(self._lattice, title), port)
        self.url = self._server.url
        if opens and open_in_browser(self.url):
            self._server.wait_for_listener(_PATIENCE)

    def on_cycle(self, cycle: Cycle) -> None:
        """Show a cycle; to be handed to `plan(on_cycle=...)`.

        Raises:
            InvalidInput: the cycle is of a colony on another lattice.
        """
        begin = time.monotonic()
        entry = (cycle.number, _known(cycle.best), _known(cycle.iteration_best))
        self._history.append(entry)
        if begin >= self._due or cycle.number == cycle.cycles:
            self._show(take(cycle, self._lattice), cycle)
            end = time.monotonic()
            self._due = end + max(_BEAT, (end - begin) / _SHARE)
        rest = self._paced + self._pace - time.monotonic()
        if self._pace and rest > 0.0:
            time.sleep(rest)
        self._paced = time.monotonic()

    def finish(self, plan: PlanData) -> None:
        """Play the plan on the page, with its play bar; the page then no longer needs the server.

        Waits until open pages have it, five seconds at most.
        """
        from ffsr_plan.display.page import page

        if not isinstance(plan, PlanData):
            raise InvalidInput("plan", plan, "a Plan")
        before, _, after = page(plan, self._title).rpartition("</body>")
        self._server.replace(before + _PLAY + after, json.dumps({"over": ""}))

    def stop(self) -> None:
        """Stop to serve; pages that are open stay as they are."""
        self._server.stop()

    def _show(self, snapshot: Snapshot, cycle: Cycle) -> None:
        step = -(-len(self._history) // _POINTS)
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
            self._server.wait_for_listener(_PATIENCE)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            reason = str(error) or kind.__name__
            self._server.publish(lambda: json.dumps({"over": reason}))
        self.stop()

    def _repr_html_(self) -> str:
        return self._server._repr_html_()


def _page(lattice: LayeredLattice, title: str) -> str:
    """The page before the first cycle; the camera sees the inner half of the lattice."""
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    problem, nominal = lattice.problem, lattice.nominal
    straight = nominal.configurations()
    corners = 0.5 * lattice.offsets[[0, lattice.origin, -1]]  # farther out, few ants go
    wide = np.concatenate([straight + np.pad(c, (0, straight.shape[1] - 3)) for c in corners])
    view = set_up(viewer, problem, wide)
    scene, near = problem.scene, np.ones(len(problem.scene), dtype=bool)
    if len(scene) > FEW:
        near = near_track(scene, shape_placements(problem.robot, straight).positions, NEAR)
    add_obstacles(viewer["obstacles"], scene, near)
    goal = problem.goal if problem.reach_attitude else straight[-1]
    add_ends(viewer, problem.robot, problem.start, goal)
    data = {
        "title": title or f"{problem.robot.name}, {problem.mode}",
        "subtitle": f"ants at work on {lattice.divisions} edges, {lattice.size} offsets a layer, "
        f"δ {problem.delta:g}",
        "commands": log.commands,
        "view": view,
    }
    return filled("live.html", data)


def _known(value: float) -> float | None:
    """A number that JSON can hold."""
    return value if math.isfinite(value) else None

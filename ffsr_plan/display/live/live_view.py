"""Live view of a search in a browser on this machine."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from functools import cache

from ffsr_plan.core.checks import number, text, truth
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.live import tree_picture
from ffsr_plan.display.live.cycle_picture import commands, take
from ffsr_plan.display.live.opening_page import opening_page
from ffsr_plan.display.plan_page import page
from ffsr_plan.display.web.browser import in_notebook, open_in_browser
from ffsr_plan.display.web.page_server import PageServer
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Cycle, TreeCycle

_LEAST_INTERVAL = 0.1  # between two pictures [s]
_TIME_SHARE = 0.02  # of the computing time, at most, is spent on pictures
_CURVE_POINTS = 300  # of the curves of F, at most
_BROWSER_TIMEOUT = 5.0  # [s] that a browser has to load the page before the search starts


class LiveView:
    """A page that shows a search while it goes on, and finally its plan.

    ```python
    with fp.LiveView(problem) as view:
        plan = fp.plan(problem, on_cycle=view.on_cycle)
        view.finish(plan)
    ```

    Of a colony, ribbons show pheromone in excess of the least one, and dots the ants of the cycle
    (larger where there are more). Of a search by trees, ribbons show the branches of the last two
    trees, that from the start brighter, and the robot stands at the end of the best path; where the
    robot floats, branches are not drawn. The best path so far is yellow. The view does not change
    the plan. The page shows the newest cycle, at most ten a second.

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
        self._problem = problem
        self._lattice = None if problem.lattice is None else LayeredLattice(problem)
        self._history: list[tuple[int, float | None, float | None]] = []
        self._next_picture = self._last_cycle = -math.inf
        self._server = PageServer(opening_page(problem, self._lattice, title), port)
        self.url = self._server.url
        if opens and open_in_browser(self.url):
            self._server.wait_for_listener(_BROWSER_TIMEOUT)

    def on_cycle(self, cycle: Cycle | TreeCycle) -> None:
        """Show a cycle. Pass this method as `plan(on_cycle=...)`.

        Args:
            cycle: the cycle that the colony has completed, or the round of a search by trees.

        Raises:
            InvalidInput: the cycle belongs to another lattice.
        """
        begin = time.monotonic()
        if self._history and cycle.number <= self._history[-1][0]:
            self._history.clear()  # another search begins, such as the trees of a portfolio
        entry = (cycle.number, _known(cycle.best), _known(cycle.iteration_best))
        self._history.append(entry)
        if begin >= self._next_picture or cycle.number == cycle.cycles:
            self._show(cycle)
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

    def _show(self, cycle: Cycle | TreeCycle) -> None:
        facts, commands_of_picture = self._picture(cycle)
        step = -(-len(self._history) // _CURVE_POINTS)
        facts |= {
            "number": cycle.number,
            "cycles": max(cycle.number, cycle.cycles),
            "best": _known(cycle.best),
            "history": [*self._history[:-1:step], self._history[-1]],
        }
        self._server.publish(
            cache(lambda: json.dumps({**facts, "commands": commands_of_picture()}))
        )

    def _picture(
        self, cycle: Cycle | TreeCycle
    ) -> tuple[dict[str, object], Callable[[], list[str]]]:
        """What the page says of a cycle, and a function that draws it."""
        if isinstance(cycle, TreeCycle):
            said: dict[str, object] = {"checks": cycle.checks, "nodes": cycle.nodes}
            return said, lambda: tree_picture.commands(cycle, self._problem)
        lattice = self._lattice
        if lattice is None:
            raise InvalidInput("cycle", "one of a colony", "rounds of trees, without a lattice")
        snapshot = take(cycle, lattice)
        ants = int(snapshot.counts[0].sum())
        return {"distinct": cycle.distinct, "ants": ants}, lambda: commands(snapshot, lattice)

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


def _known(value: float) -> float | None:
    """The value, or None if JSON cannot hold it."""
    return value if math.isfinite(value) else None

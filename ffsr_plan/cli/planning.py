"""Planning at the terminal: scenario and options, progress, the colony watched in a browser."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ffsr_plan.cli.files import write_results
from ffsr_plan.cli.tables import plan_table
from ffsr_plan.cli.terminal import err_console, out_console, with_spinner
from ffsr_plan.core.errors import InvalidInput, PlanningError

if TYPE_CHECKING:
    from ffsr_plan.planning.plan import Plan
    from ffsr_plan.scenario_files.scenario import Scenario
    from ffsr_plan.search.records import Cycle


class Watched(NamedTuple):
    """How the colony is shown while it works."""

    port: int
    browser: bool
    pace: float


class Options(NamedTuple):
    """What the command line may say otherwise than the scenario."""

    planner: str | None = None
    seed: int | None = None
    refine: bool | None = None
    colonies: int = 1
    workers: int = 1
    time_limit: float | None = None
    duration: float = 600.0
    watched: Watched | None = None


def plan_and_report(source: str, options: Options, target: Path | None, check: bool) -> None:
    """Plan a scenario, write and print the result, re-check it."""
    from ffsr_plan.core.checks import number, one_of, whole_number
    from ffsr_plan.plans.planners import PLANNERS
    from ffsr_plan.scenario_files.scenario import read_scenario

    duration = number("--duration", options.duration, above=0.0)
    scenario = read_scenario(source)
    if options.planner is not None:
        settings = PLANNERS[one_of("--planner", options.planner, list(PLANNERS))]()
        scenario = scenario._replace(planner=settings)
    if options.seed is not None:
        scenario = scenario._replace(seed=whole_number("--seed", options.seed, at_least=0))
    if options.refine is not None:
        scenario = scenario._replace(refine=options.refine)
    found = planned(scenario, options) if options.watched is None else shown(scenario, options)
    if target is not None:
        write_results(found, scenario.title, target)
    report = with_spinner("verifying", found.verify) if check else None
    out_console.print(plan_table(scenario.title, found, report, duration))
    if target is not None:
        out_console.print(f"Written to {target}: open {target / 'plan.html'} in a browser.")
    if report is not None and not report.ok:
        raise PlanningError("the plan does not verify: " + "; ".join(report.problems))


def shown(scenario: Scenario, options: Options) -> Plan:
    """Plan while a page shows the colony, and in the end the plan."""
    from ffsr_plan.display.live_view import LiveView

    watched = options.watched
    assert watched is not None
    if options.colonies > 1:
        raise InvalidInput("--watch", f"{options.colonies} colonies", "a single colony to look at")
    view = LiveView(
        scenario.problem, watched.port, open_browser=watched.browser, pace=watched.pace,
        title=scenario.title,
    )  # fmt: skip
    with view:
        err_console.print(f"{view.url} shows the colony at work")
        found = planned(scenario, options, view.on_cycle)
        view.finish(found)
    return found


def planned(
    scenario: Scenario, options: Options, on_cycle: Callable[[Cycle], None] | None = None
) -> Plan:
    """Plan with a progress bar on a terminal, once it has taken a second."""
    from rich.progress import Progress

    from ffsr_plan.planning.planner import plan as make_plan

    begin, followed = time.monotonic(), err_console.is_terminal
    with Progress(console=err_console, transient=True, auto_refresh=False) as progress:
        task = progress.add_task("ants", visible=False)

        def show(cycle: Cycle) -> None:
            if on_cycle is not None:
                on_cycle(cycle)
            if followed and time.monotonic() - begin > 1.0:
                progress.update(
                    task,
                    visible=True,
                    total=cycle.cycles,
                    completed=cycle.number,
                    description=f"ants, best F {cycle.best:.2f}",
                )
                progress.refresh()

        return make_plan(
            scenario.problem,
            scenario.planner,
            scenario.seed,
            refine=scenario.refine,
            colonies=options.colonies,
            workers=options.workers,
            time_limit=options.time_limit,
            on_cycle=show if options.colonies == 1 and (followed or on_cycle) else None,
        )

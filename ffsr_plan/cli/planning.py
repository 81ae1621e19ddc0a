"""The commands `plan` and `demo`: planning with progress output, and a live view on request."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, cast

from ffsr_plan.cli.console.output import Output
from ffsr_plan.cli.console.result_files import write_results
from ffsr_plan.cli.console.terminal import err_console, with_progress
from ffsr_plan.cli.plan_figures import plan_figures, report_figures
from ffsr_plan.cli.printed_tables import plan_table, times_table
from ffsr_plan.cli.step_times import StepTimes
from ffsr_plan.core.errors import InvalidInput, PlanNotVerified

if TYPE_CHECKING:
    from rich.console import RenderableType

    from ffsr_plan.planning.certified_plan import Plan
    from ffsr_plan.scenario_files.scenario import Scenario
    from ffsr_plan.search.records import Cycle, TreeCycle

_QUIET_SECONDS = 1.0  # before the progress bar appears


class LiveOptions(NamedTuple):
    """Options of the live view.

    Attributes:
        port: of the page on 127.0.0.1; 0 for any free one.
        browser: whether to open the page.
        pace: least duration of a cycle [s].
    """

    port: int
    browser: bool
    pace: float


class Options(NamedTuple):
    """Options of the command line that replace or complete those of the scenario.

    Attributes:
        planner: name of a planner, used with default settings; None for the scenario's.
        seed: None for the scenario's.
        refine: None for the scenario's.
        colonies: number of independent colonies.
        workers: number of processes.
        time_limit: of the planning [s].
        until: `first` for the first path that is proven.
        duration: of the motion [s], for the peak momentum of the wheels.
        live: options of the live view; None for no live view.
        pictures: whether to draw the figures.
    """

    planner: str | None = None
    seed: int | None = None
    refine: bool | None = None
    colonies: int = 1
    workers: int = 1
    time_limit: float | None = None
    until: str = "end"
    duration: float = 600.0
    live: LiveOptions | None = None
    pictures: bool = True


def plan_and_report(
    source: str, options: Options, target: Path | None, check: bool, output: Output
) -> None:
    """Plan a scenario, write and print the result, and verify it.

    Args:
        source: path or name of the scenario.
        options: of the command line.
        target: directory for the results, or None.
        check: whether to verify the plan.
        output: where results and times are shown.

    Raises:
        PlanNotVerified: the plan does not verify; it is written and printed before.
        InvalidInput, PlanningError: see `Scenario.load` and `plan`.
    """
    from ffsr_plan.core.checks import number

    times = StepTimes()
    with times.step("loading", "loading the program"):
        from ffsr_plan.planning import plan_and_refine  # noqa: F401 - which takes a while
        from ffsr_plan.scenario_files.scenario import Scenario
    duration = number("--duration", options.duration, above=0.0)
    with times.step("reading", "reading scenario and robot"):
        scenario = _with_options(Scenario.load(source), options)
    run = _plan_with_progress if options.live is None else _plan_with_live_view
    with times.step("planning", _planning_words(scenario)):
        plan = run(scenario, options, output)
    report, files = None, []
    if target is not None:
        with times.step("writing", "page and pictures" if options.pictures else "page"):
            files = write_results(plan, scenario.title, target, options.pictures)
    if check:
        with times.step("verification", "verification"):
            report = with_progress(
                "verifying", lambda told: plan.verify(on_progress=told), not output.quiet
            )

    def readable() -> Iterator[RenderableType]:
        yield plan_table(scenario.title, plan, report, duration)
        yield times_table(times)
        if target is not None:
            yield f"Written to {target}: open {target / 'plan.html'} in a browser."

    def data() -> dict[str, Any]:
        return {
            "plan": plan_figures(plan, scenario.title, duration),
            "report": report_figures(report),
            "times": times.seconds(),
            "files": [str(path) for path in files],
        }

    output.show(readable, data)
    if report is not None and not report.ok:
        raise PlanNotVerified(report.problems)


def _planning_words(scenario: Scenario) -> str:
    """What planning consists of; its parts interleave and cannot be timed one by one."""
    lattice = scenario.problem.lattice
    refined = scenario.refine is not False and lattice is not None and not lattice.postures
    return "search, proof, refinement" if refined else "search and proof"


def _with_options(scenario: Scenario, options: Options) -> Scenario:
    """The scenario with planner, seed and refinement of the command line where they are given."""
    from ffsr_plan.core.checks import one_of, whole_number
    from ffsr_plan.plans.planner_registry import PLANNERS

    changes: dict[str, Any] = {}
    if options.planner is not None:
        changes["planner"] = PLANNERS[one_of("--planner", options.planner, list(PLANNERS))]()
    if options.seed is not None:
        changes["seed"] = whole_number("--seed", options.seed, at_least=0)
    if options.refine is not None:
        changes["refine"] = options.refine
    return replace(scenario, **changes)


def _plan_with_live_view(scenario: Scenario, options: Options, output: Output) -> Plan:
    """Plan while a page shows the search; afterwards it shows the plan."""
    from ffsr_plan.display.live.live_view import LiveView

    live = options.live
    assert live is not None
    if options.colonies > 1:
        raise InvalidInput("--watch", f"{options.colonies} colonies", "a single colony")
    view = LiveView(
        scenario.problem,
        live.port,
        open_browser=live.browser,
        pace=live.pace,
        title=scenario.title,
    )
    with view:
        err_console.print(f"{view.url} shows the search")
        plan = _plan_with_progress(scenario, options, output, view.on_cycle)
        view.finish(plan)
    return plan


def _plan_with_progress(
    scenario: Scenario,
    options: Options,
    output: Output,
    on_cycle: Callable[[Cycle | TreeCycle], None] | None = None,
) -> Plan:
    """Plan with a progress bar on a terminal if the search takes more than a second."""
    from rich.progress import Progress

    from ffsr_plan.planning.plan_and_refine import plan as make_plan
    from ffsr_plan.search.records import TreeCycle

    begin, on_terminal = time.monotonic(), err_console.is_terminal and not output.quiet
    with Progress(
        console=err_console, transient=True, auto_refresh=False, disable=not on_terminal
    ) as progress:
        task = progress.add_task("ants", visible=False)

        def show(cycle: Cycle | TreeCycle) -> None:
            if on_cycle is not None:
                on_cycle(cycle)
            searching = "trees" if isinstance(cycle, TreeCycle) else "ants"
            if on_terminal and time.monotonic() - begin > _QUIET_SECONDS:
                progress.update(
                    task,
                    visible=True,
                    total=cycle.cycles,
                    completed=cycle.number,
                    description=f"{searching}, best F {cycle.best:.2f}",
                )
                progress.refresh()

        exact = scenario.planner is not None and scenario.planner.exact
        has_cycles = options.colonies == 1 and not exact
        return make_plan(
            scenario.problem,
            scenario.planner,
            scenario.seed,
            refine=scenario.refine,
            colonies=options.colonies,
            workers=options.workers,
            time_limit=options.time_limit,
            until=cast("Literal['end', 'first']", options.until),
            on_cycle=show if has_cycles and (on_terminal or on_cycle) else None,
        )

"""`Study`: a grid of problems, planners and seeds, each of which is planned once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ffsr_plan.clusters.cluster_client import connected
from ffsr_plan.core.checks import one_of, truth, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.studies.engines.engine import Engine
from ffsr_plan.studies.interruption import Interruption
from ffsr_plan.studies.progress_bar import progress_shown
from ffsr_plan.studies.records.record import Record
from ffsr_plan.studies.running import OnProgress, Run
from ffsr_plan.studies.study_result import StudyResult
from ffsr_plan.studies.tasks.given_values import (
    GivenAxes,
    GivenPlanners,
    GivenProblems,
    given_memory_limit,
    given_planners,
    given_problems,
    given_seeds,
    given_time_limit,
    given_title,
)
from ffsr_plan.studies.tasks.grid import Grid
from ffsr_plan.studies.tasks.row import package_version

if TYPE_CHECKING:
    from distributed import Client

_MOST_WORKERS = 256  # each is a process of some hundred megabytes
_ENGINES = ("auto", "in-process", "processes", "dask")


class Study:
    """A grid of problems x planners x seeds, of which each point is planned once.

    `run` plans what is not planned yet. It can be cut at any time, and goes on where it was.

    Attributes:
        title: of the study, may be empty.
        grid: its tasks.
    """

    def __init__(
        self,
        problems: GivenProblems,
        planners: GivenPlanners = None,
        seeds: int | Sequence[int] | range = 1,
        *,
        title: str = "",
        axes: GivenAxes | None = None,
        refine: bool | Mapping[str, bool] | None = None,
        time_limit: float | Mapping[str, float] | None = None,
        memory_limit: float | None = None,
        plans: bool = True,
    ) -> None:
        """See the class.

        Args:
            problems: `Problem` objects, or names or paths of scenarios, by name or in a list.
            planners: settings of planners, their names, or None for the default of each problem;
                by name or in a list. Any other planner is an object that can be pickled, with a
                method `plan(problem, seed)`, or a function of both; it returns a `Plan`, or a
                `Trajectory`, which is judged by `certify`, or one of them and a mapping of further
                figures. If it has an argument `time_limit`, it is given that too.
            seeds: how many, counted from 0; or a list or range of them.
            title: of the study.
            axes: values by axis by problem, such as `{"gate 1": {"width": 0.4}}`; they become
                columns, and reports compare them.
            refine: as of `plan`, for all planners or by the planner's name.
            time_limit: of one plan [s], for all problems or by the problem's name. Plans that it
                ends are not the same on machines of another speed.
            memory_limit: of one plan, beyond what its process has in use before [GB].
            plans: whether the plans are kept; each takes some 40 to 400 kB.

        Raises:
            InvalidInput: an argument that is not allowed.
        """
        sources = given_problems(problems, axes)
        self.title = given_title(title)
        self.grid = Grid(
            sources,
            given_planners(planners, refine),
            given_seeds(seeds),
            given_time_limit(time_limit, [source.name for source in sources]),
            given_memory_limit(memory_limit),
            truth("plans", plans),
        )

    @classmethod
    def load(cls, path: str | Path) -> Study:
        """The study of a TOML file.

        Args:
            path: of the file.

        Raises:
            InvalidInput: no such file, not TOML, an unknown key or axis (the nearest one is
                suggested), or a value that is not allowed; the message names file and key.
        """
        from ffsr_plan.studies.study_files.reading import read_study

        made = cls.__new__(cls)
        made.title, made.grid = read_study(path)
        return made

    def __len__(self) -> int:
        return len(self.grid)

    def __repr__(self) -> str:
        grid = self.grid
        sizes = f"{len(grid.sources)} problems x {len(grid.planners)} planners x {len(grid.seeds)}"
        return f"Study({self.title!r}, {sizes} seeds = {len(grid)} plans)"

    def run(
        self,
        directory: str | Path,
        *,
        workers: int = 1,
        scheduler: str | Client | None = None,
        engine: Literal["auto", "in-process", "processes", "dask"] = "auto",
        retry_failed: bool = False,
        progress: bool = True,
        on_progress: OnProgress | None = None,
    ) -> StudyResult:
        """Plan whatever has no row yet; the rows are the same on any number of workers.

        Each row is written as it comes. When the run is cut, as by Ctrl-C, `kill -9` or a full
        disk, the next one goes on from there; a plan that was being made is begun again. A task
        whose worker died is done again, twice at most, and its row names the worker.

        Args:
            directory: for the rows and the plans, made if it is not there.
            workers: processes on this computer.
            scheduler: address of a Dask scheduler whose workers are used, such as
                `tcp://10.0.0.1:8786`, or a `distributed.Client`.
            engine: `in-process`, `processes` (by loky) or `dask` (a cluster on this computer); by
                default the first for one worker, and for several the last if it is installed.
            retry_failed: whether tasks are done again whose row has no plan.
            progress: whether to show progress on standard error, if that is a terminal.
            on_progress: called with a `StudyProgress` whenever rows have been written.

        Returns:
            The rows, those of earlier runs included.

        Raises:
            InvalidInput: an argument that is not allowed, a file that cannot be written, a
                directory that another run writes to, or one with rows of other problems, planners
                or versions by the same names.
            KeyboardInterrupt: Ctrl-C, when what came back is written.
        """
        folder = checked_path("directory", directory)
        chosen = one_of("engine", engine, _ENGINES)
        count = whole_number("workers", workers, at_least=1, at_most=_MOST_WORKERS)
        if on_progress is not None and not callable(on_progress):
            raise InvalidInput("on_progress", on_progress, "a function, or None")
        again = truth("retry_failed", retry_failed)
        interruption = Interruption()
        with Record.opened(folder) as record, interruption:
            record.begin(self.title, _axes(self.grid), package_version())
            with (
                _engine(self.grid, chosen, count, scheduler) as made,
                progress_shown(len(self), truth("progress", progress)) as shown,
            ):
                tell = shown if on_progress is None else _both(shown, on_progress)
                Run(self.grid, record, made, tell, again).go(interruption)
        if interruption.pressed:
            raise KeyboardInterrupt
        return StudyResult(folder)


def _both(first: OnProgress, second: OnProgress) -> OnProgress:
    def tell(progress: Any) -> None:  # noqa: ANN401 - a StudyProgress
        first(progress)
        second(progress)

    return tell


def _axes(grid: Grid) -> list[str]:
    """Names of all axes; problems of a file all have the same ones."""
    found: dict[str, None] = {}
    for source in grid.sources:
        found |= dict.fromkeys(source.axes)
        if not isinstance(grid.sources, tuple):
            break
    for planner in grid.planners:
        found |= dict.fromkeys(planner.axes)
    return list(found)


@contextmanager
def _engine(
    grid: Grid, chosen: str, workers: int, scheduler: str | Client | None
) -> Iterator[Engine]:
    """The engine that was asked for, closed after the body."""
    if scheduler is not None and chosen not in ("auto", "dask"):
        raise InvalidInput("engine", chosen, "'dask' or 'auto' together with a scheduler")
    if chosen == "in-process" and workers > 1:
        raise InvalidInput("workers", workers, "1 with engine='in-process'")
    if chosen == "auto":
        several = "processes" if find_spec("distributed") is None else "dask"
        chosen = several if workers > 1 else "in-process"
    if scheduler is not None or chosen == "dask":
        from ffsr_plan.studies.engines import dask_cluster

        own = 0 if scheduler is not None else workers
        there = dask_cluster.local(own) if own else connected(scheduler)
        with there as client, _closed(dask_cluster.DaskCluster(grid, client, own)) as engine:
            yield engine
    elif chosen == "processes":
        from ffsr_plan.studies.engines.processes import Processes

        with _closed(Processes(grid, workers)) as engine:
            yield engine
    else:
        from ffsr_plan.studies.engines.in_process import InProcess

        with _closed(InProcess(grid)) as engine:
            yield engine


@contextmanager
def _closed(engine: Engine) -> Iterator[Engine]:
    try:
        yield engine
    finally:
        engine.close()

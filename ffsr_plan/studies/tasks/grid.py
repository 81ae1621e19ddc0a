"""The grid of a study: problems x planners x seeds, and the task at each of its points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from ffsr_plan.plans.planner_registry import Planner
from ffsr_plan.studies.tasks.canonical import digest, planner_description
from ffsr_plan.studies.tasks.sources import Sources

AnyPlanner = Planner | Callable[..., Any] | None
"""Settings of a planner, any function of a problem and a seed, or None for the default."""
_DIGITS = 32  # of a key: 128 bits, in which no two of 10^9 tasks agree by chance


@dataclass(frozen=True)
class NamedPlanner:
    """A planner of a study.

    Attributes:
        name: different from all others of the study.
        planner: the planner.
        refine: whether to move paths off the lattice in the end; None for the default of `plan`.
        axes: values of the study's axes that are settings of planners.
    """

    name: str
    planner: AnyPlanner
    refine: bool | None = None
    axes: Mapping[str, object] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """What changes with anything that decides a plan; 64 hexadecimal digits."""
        return digest([planner_description(self.planner), self.refine])


class Task(NamedTuple):
    """One plan to be made.

    Attributes:
        key: 32 hexadecimal digits, the same whenever and wherever the task is described.
        problem: number of the problem in the grid.
        planner: number of the planner in the grid.
        seed: of the planner's random numbers.
    """

    key: str
    problem: int
    planner: int
    seed: int


@dataclass(frozen=True)
class Grid:
    """All tasks of a study.

    Attributes:
        sources: the problems.
        planners: the planners.
        seeds: the seeds.
        time_limit: of one plan [s], by the name of the problem, or for all; None for no limit.
        memory_limit: of one plan, beyond what its process has in use before [bytes]; None for no
            limit. It decides no plan, so that it is not in the key.
        plans: whether plans are kept.
    """

    sources: Sources
    planners: tuple[NamedPlanner, ...]
    seeds: tuple[int, ...] | range
    time_limit: Mapping[str, float] | float | None = None
    memory_limit: int | None = None
    plans: bool = True

    def __len__(self) -> int:
        return len(self.sources) * len(self.planners) * len(self.seeds)

    def seconds(self, problem: str) -> float | None:
        """The time limit of a problem [s], or None.

        Args:
            problem: its name.
        """
        limit = self.time_limit
        return limit.get(problem) if isinstance(limit, Mapping) else limit

    def tasks(self) -> Iterator[Task]:
        """All tasks; those of one problem follow one another, as making it takes time."""
        for number, source in enumerate(self.sources):
            begin = [source.digest, self.seconds(source.name)]
            for which, planner in enumerate(self.planners):
                part = digest([*begin, planner.digest])
                for seed in self.seeds:
                    yield Task(digest([part, seed])[:_DIGITS], number, which, seed)

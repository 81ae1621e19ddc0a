"""Where the problems of a study come from: objects, or descriptions that become problems late.

A problem that is described is made where it is planned, and no earlier: a hundred thousand problems
need not be in memory, and none has to travel to a worker.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

from ffsr_plan.problem.problem import Problem
from ffsr_plan.studies.tasks.canonical import digest, problem_description


class ProblemSource(Protocol):
    """One problem of a study."""

    @property
    def name(self) -> str:
        """Of the problem, different from all others of the study."""
        ...

    @property
    def axes(self) -> Mapping[str, object]:
        """Values of the study's axes, by the name of the axis."""
        ...

    @property
    def digest(self) -> str:
        """What changes with anything that decides a plan; 64 hexadecimal digits."""
        ...

    def problem(self) -> Problem:
        """The problem.

        Raises:
            FfsrPlanError: there is no such problem, as where a goal is in collision.
        """
        ...


Sources = Sequence[ProblemSource]
"""All problems of a study; those of files are made when they are asked for."""


@dataclass(frozen=True)
class GivenProblem:
    """A problem that is an object.

    Attributes:
        name: of the problem.
        given: the problem.
        axes: values of axes, by the name of the axis.
    """

    name: str
    given: Problem
    axes: Mapping[str, object] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """See `ProblemSource`."""
        return digest(problem_description(self.given))

    def problem(self) -> Problem:
        """See `ProblemSource`."""
        return self.given

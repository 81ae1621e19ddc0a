"""Problems of the set as problems of a study: read where they are planned, and no earlier."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.set_index import ProblemSet


@dataclass(frozen=True)
class BenchSource:
    """A problem of the set.

    Attributes:
        name: of the problem.
        family: its family.
        digest: SHA-256 of its file.
        folder: of the set's data.
    """

    name: str
    family: str
    digest: str
    folder: str

    @property
    def axes(self) -> Mapping[str, object]:
        """The family, as an axis of the study."""
        return {"family": self.family}

    def problem(self) -> Problem:
        """The problem.

        Raises:
            InvalidInput: its file is not there or has changed.
        """
        return ProblemSet(self.folder)[self.name].problem

"""`Engine`: runs jobs, each of which is a few tasks of a study, and says what came of them."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ffsr_plan.studies.tasks.grid import Task
from ffsr_plan.studies.tasks.row import Outcome


class Job(NamedTuple):
    """Tasks that are sent together, because each of them takes less than a second.

    Attributes:
        number: of the job; each job of a run has another.
        tasks: what to do.
    """

    number: int
    tasks: tuple[Task, ...]


class JobEnd(NamedTuple):
    """What came of a job.

    Attributes:
        number: of the job.
        outcomes: one for each of its tasks; None if its worker died, or the job never began.
        lost: workers that died with it, with what is known of their end.
        fault: why there are no outcomes though no worker died; empty otherwise.
    """

    number: int
    outcomes: tuple[Outcome, ...] | None
    lost: tuple[str, ...] = ()
    fault: str = ""


class Engine(Protocol):
    """Runs jobs. One thread uses it."""

    @property
    def in_this_process(self) -> bool:
        """Whether `next` itself does the work."""
        ...

    def slots(self) -> int:
        """Jobs that are worked on at the same time; this may change, as clusters grow."""
        ...

    def submit(self, job: Job) -> None:
        """Take a job; jobs wait for their turn.

        Args:
            job: the job.
        """
        ...

    def next(self, timeout: float) -> JobEnd | None:
        """The end of some job that was submitted, or None if there is none in time.

        Args:
            timeout: [s] to wait.
        """
        ...

    def close(self) -> None:
        """End all that the engine has started; jobs in hand are dropped."""
        ...

"""The engine that runs jobs on a Dask cluster: one that is there already, or one of its own.

Each worker is sent the study once, by a plugin, which Dask also gives to workers that come later.
Jobs are handed out a few at a time.
"""

from __future__ import annotations

import queue
import sys
import threading
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.search.workers import ctrl_c_blocked
from ffsr_plan.studies.engines.engine import Job, JobEnd
from ffsr_plan.studies.engines.worker_side import forget, hold, packed, run_job
from ffsr_plan.studies.tasks.grid import Grid
from ffsr_plan.studies.tasks.row import Outcome

if TYPE_CHECKING:
    from distributed import Client, Future, WorkerPlugin

_COUNTING = 5.0  # [s] between two questions how many workers there are
_LOOKS_AFTER_LOSS = 20  # questions at every occasion, after a worker was lost
_LOST = "a Dask scheduler that goes on answering; the study goes on from here when it is run again"


class DaskCluster:
    """See `Engine`."""

    in_this_process = False

    def __init__(self, grid: Grid, client: Client, workers: int = 0) -> None:
        """Send the study to a cluster. `cluster_client.connected` and `local` make clients.

        Args:
            grid: the study.
            client: of the cluster; it stays open.
            workers: that a cluster of this computer should have; it starts others in place of those
                that Dask has given up, as it does where one dies while it starts.

        Raises:
            InvalidInput: a planner that cannot be pickled.
        """
        self._client, self._name = client, f"ffsr-plan-study-{uuid.uuid4().hex}"
        self._workers = workers
        self._ends: queue.SimpleQueue[tuple[Job, Future]] = queue.SimpleQueue()
        self._futures: dict[int, Future] = {}
        self._lost: dict[str, list[str]] = {}
        self._lock = threading.Lock()
        self._counted, self._count = -float("inf"), 1
        self._losses = 0
        plugin = _study_plugin(self._name, packed(grid))
        with _answering():
            client.subscribe_topic("all", self._hear)
            client.register_plugin(plugin, name=self._name)

    def slots(self) -> int:
        """The number of workers, at least 1; after a loss it is asked for each time."""
        if self._losses or time.monotonic() - self._counted > _COUNTING:
            with _answering():
                there, self._counted = len(self._client.nthreads()), time.monotonic()
            self._count, self._losses = max(1, there), max(0, self._losses - 1)
            if there < self._workers:
                self._client.cluster.scale(self._workers)
        return self._count

    def submit(self, job: Job) -> None:
        """See `Engine`."""
        future = self._client.submit(
            _run_on_worker, self._name, job, key=self._key(job.number), pure=False
        )
        self._futures[job.number] = future
        future.add_done_callback(lambda done: self._ends.put((job, done)))

    def next(self, timeout: float) -> JobEnd | None:
        """See `Engine`.

        Raises:
            InvalidInput: the scheduler is lost.
        """
        from distributed.scheduler import KilledWorker

        try:
            job, future = self._ends.get(timeout=timeout)
        except queue.Empty:
            if self._client.status != "running":
                raise InvalidInput("scheduler", self._client.status, _LOST) from None
            return None
        if future.status in ("cancelled", "lost"):
            raise InvalidInput("scheduler", future.status, _LOST)
        del self._futures[job.number]
        try:
            outcomes, fault = future.result(), ""
        except KilledWorker as error:
            outcomes, fault = None, ""
            self._note([future.key], str(error.last_worker.address))
        except Exception as error:  # as where a worker has another version of the package
            outcomes, fault = None, f"{type(error).__name__}: {error}"
        with self._lock:
            lost = self._lost.pop(self._key(job.number), [])
        return JobEnd(job.number, outcomes, tuple(lost), fault)

    def close(self) -> None:
        """Forget the study on the cluster; jobs that have not begun never will."""
        with suppress(Exception):  # of a scheduler that is lost, which is told elsewhere
            self._client.unsubscribe_topic("all")
            self._client.cancel(list(self._futures.values()), force=True)
            self._client.unregister_worker_plugin(self._name)
        self._futures.clear()

    def _key(self, number: int) -> str:
        return f"{self._name}-{number}"

    def _hear(self, event: tuple[float, dict[str, Any]]) -> None:
        """Note which jobs a worker had in hand when it died; called on Dask's own thread."""
        _, told = event
        if told.get("action") == "remove-worker" and not told.get("expected"):
            self._losses = _LOOKS_AFTER_LOSS
            self._note(told.get("processing-tasks", ()), str(told.get("worker")))

    def _note(self, keys: Any, worker: str) -> None:  # noqa: ANN401 - of Dask
        with self._lock:
            for key in map(str, keys):
                known = self._lost.setdefault(key, []) if key.startswith(self._name) else [worker]
                if worker not in known:
                    known.append(worker)


@contextmanager
def _answering() -> Iterator[None]:
    """In the body, a scheduler that does not answer becomes an error that says so.

    Raises:
        InvalidInput: it does not.
    """
    try:
        yield
    except OSError as error:  # Dask's errors of communication are of this class
        raise InvalidInput("scheduler", str(error), _LOST) from None


def _study_plugin(name: str, blob: bytes) -> WorkerPlugin:
    """What gives a study to a worker when it starts, and takes it away in the end."""
    from distributed import WorkerPlugin

    class StudyPlugin(WorkerPlugin):  # type: ignore[misc]
        def setup(self, worker: object) -> None:
            hold(name, blob)

        def teardown(self, worker: object) -> None:
            forget(name)

    return StudyPlugin()


def _run_on_worker(name: str, job: Job) -> tuple[Outcome, ...]:
    """Run a job on the worker that this process is."""
    from distributed import get_worker

    return run_job(name, job, get_worker().address)


@contextmanager
def local(workers: int) -> Iterator[Client]:
    """A client of a new cluster of processes on this computer, which ends after the body.

    A task whose worker died comes back at once: the study itself hands it out again, and counts.

    Args:
        workers: number of processes, of one thread each.
    """
    import dask
    from distributed import Client, LocalCluster

    own = {
        "distributed.scheduler.allowed-failures": 0,
        "distributed.scheduler.worker-saturation": 1.0,  # so that a worker dies with one job
        "distributed.worker.use-file-locking": False,
        "distributed.admin.low-level-log-length": 0,
    }
    with dask.config.set(own), _main_hidden():
        with ctrl_c_blocked():  # its thread and all processes of it never receive Ctrl-C
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address="127.0.0.1:0",  # any free port, and for nobody else
                memory_limit=0,  # without it, Dask would kill workers by a limit of its own
                silence_logs=50,
            )
        with cluster, Client(cluster, set_as_default=False) as client:
            yield client


@contextmanager
def _main_hidden() -> Iterator[None]:
    """Processes that are started during the body do not run the caller's script once more.

    Python's `multiprocessing` does that by the script's name, and a script without a guard would
    start its study in each of them; what workers need of the script is sent to them by value.
    """
    main = sys.modules["__main__"]
    names: dict[str, object] = vars(main)
    hidden: dict[str, object] = {
        name: names[name] for name in ("__file__", "__spec__") if name in names
    }
    names |= dict.fromkeys(hidden)
    try:
        yield
    finally:
        names |= hidden

"""A study's chunks on Dask: given out, and what is lost given out again.

A few chunks a thread are with the scheduler at a time. A worker keeps its results itself; a task that comes again
finds them. Chunks in which workers die are done last, job by job and one at a time: then it is known whose fault it is.
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue
from typing import Any

from gearsim.errors import GearsimError, InputError
from gearsim.studies.local_workers import local_workers
from gearsim.studies.progress import StudyProgress
from gearsim.studies.records import Outcome, counted
from gearsim.studies.store import Store
from gearsim.studies.worker import RUN_CHUNK, Errand, errand, keep_chunk, one_job
from gearsim.studies.writing import GO_ON

_CONNECT_S = 20.0
_WITHOUT_PORTS = ("inproc://", "ucx://")
_AHEAD = 2  # chunks with the scheduler, times its threads


class ClusterError(GearsimError):
    """The cluster was lost, or never there."""


def run_cluster(
    store: Store, chunks: Sequence[int], progress: StudyProgress, *, workers: int | None = None,
    scheduler: str | None = None, device: str = "cpu", compute: str = RUN_CHUNK,
) -> None:  # fmt: skip
    """Compute and keep chunks by ``workers`` new processes of one core each, or by those of a running ``scheduler``.

    Raises InputError where Dask is not installed, a worker cannot take part, or the disk refuses the results;
    ClusterError where no scheduler answers or it is lost. What was kept stays.
    """
    asked = errand(store, device, compute)
    with _client(workers, scheduler) as (client, all_gone):
        flow = _Flow(client, progress, all_gone)
        for chunk in flow.chunks(asked, chunks, store):
            flow.job_by_job(asked, chunk, store)


@contextmanager
def _client(workers: int | None, scheduler: str | None) -> Iterator[tuple[Any, Callable[[], str]]]:
    """A client of new workers or of a running scheduler, and what says why all workers are gone, if they are."""
    quiet()
    with local_workers(workers) if scheduler is None else _joined(scheduler) as (address, all_gone):
        try:
            from distributed import Client

            client = Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ClusterError(
                f"no Dask scheduler answers at {address} ({error}); start one: dask scheduler, and workers: "
                f"dask worker {address}"
            ) from None
        try:
            yield client, all_gone
        finally:
            with suppress(Exception):  # a lost scheduler cannot be told
                client.close(timeout=2.0)


@contextmanager
def _joined(address: str) -> Iterator[tuple[str, Callable[[], str]]]:
    """A scheduler's address, seen to be one first: a client that was given none complains when the process ends."""
    from distributed.comm.addressing import get_address_host_port

    try:
        if not address.startswith(_WITHOUT_PORTS):
            get_address_host_port(address)
    except ValueError as error:
        raise InputError(f"scheduler {address!r}: {error}; expected an address like tcp://HOST:8786") from None
    yield address, lambda: ""


def quiet() -> None:
    """Keep what Dask logs off the screen. Raises InputError where it is not installed."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise InputError("Dask is not installed; it comes with pip install 'gearsim[batch]'") from None
    for name in [n for n in logging.root.manager.loggerDict if n.partition(".")[0] in ("distributed", "tornado")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)


class _Flow:
    """Tasks given out a few at a time; a queue holds those that have ended."""

    def __init__(self, client: Any, progress: StudyProgress, all_gone: Callable[[], str]) -> None:
        self._client, self._progress, self._all_gone = client, progress, all_gone
        self._ended: SimpleQueue[Any] = SimpleQueue()

    def chunks(self, asked: Errand, chunks: Sequence[int], store: Store) -> list[int]:
        """Give out all chunks; those that could not be done for the workers' sake. Raises as ``run_cluster``."""
        waiting, running, suspected = deque(chunks), dict[Any, int](), list[int]()
        try:
            while waiting or running:
                while waiting and len(running) < max(4, _AHEAD * self._threads()):
                    chunk = waiting.popleft()
                    running[self._started(keep_chunk, asked, chunk)] = chunk
                future = self._next()
                chunk = running.pop(future)
                result, error = self._outcome(future)
                if error is None:
                    self._progress.advance(len(store.study.jobs_of(chunk)), result)
                else:
                    suspected.append(chunk)
        finally:
            with suppress(Exception):  # a lost scheduler cannot be told
                self._client.cancel(list(running))
        return suspected

    def job_by_job(self, asked: Errand, chunk: int, store: Store) -> None:
        """Keep a chunk whose jobs are done one at a time; one that ends a worker each time is an error."""
        outcomes = list[Outcome]()
        for job in store.study.jobs_of(chunk):
            self._started(one_job, asked, job)
            outcome, error = self._outcome(self._next())
            outcomes.append(outcome if error is None else Outcome(job, "error", error=_told(error)))
        store.put(chunk, outcomes, {}, asked.device)
        self._progress.advance(len(outcomes), counted(outcomes))

    def _started(self, task: Callable[..., Any], *arguments: Any) -> Any:
        future = self._client.submit(task, *arguments, pure=False)
        future.add_done_callback(self._ended.put)
        return future

    def _next(self) -> Any:
        """The next task that ends. Raises ClusterError where the scheduler or all workers of ours are gone."""
        while True:
            try:
                ended = self._ended.get(timeout=1.0)
                self._progress.tell("")
                return ended
            except Empty:
                if gone := self._all_gone():
                    raise ClusterError(gone) from None
                if not self._threads():
                    self._progress.tell("waiting for workers")

    def _outcome(self, future: Any) -> tuple[Any, BaseException | None]:
        """A task's result, or why it has none. Raises what ends the study."""
        try:
            error = future.exception() if future.status == "error" else None
            if error is None:
                return future.result(), None
        except (CancelledError, OSError, TimeoutError):
            raise _lost() from None
        if isinstance(error, GearsimError | OSError):
            raise error
        if isinstance(error, ModuleNotFoundError) and str(error.name).partition(".")[0] == "gearsim":
            raise InputError(
                f"a worker cannot import gearsim ({error}); install it there: pip install 'gearsim[batch]'"
            )
        return None, error

    def _threads(self) -> int:
        """Threads of all workers at the moment."""
        if self._client.status != "running":
            raise _lost()
        try:
            return int(sum(self._client.nthreads().values()))
        except (OSError, TimeoutError):
            raise _lost() from None


def _lost() -> ClusterError:
    return ClusterError(f"the Dask scheduler was lost; {GO_ON}, once a scheduler runs")


def _told(error: BaseException) -> str:
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        return f"{error.allowed_failures + 1} workers died of it, one after the other: out of memory, perhaps"
    return f"{type(error).__name__}: {error}"

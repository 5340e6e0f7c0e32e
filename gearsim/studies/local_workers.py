"""Dask workers of this machine, one core each, for as long as a study needs them.

The scheduler lives in this process and the workers in sessions of their own: Ctrl-C reaches this process alone, and
when it is killed, the workers end by themselves as they lose their scheduler.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from logging import CRITICAL
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO

_OPTIONS = ("--nthreads", "1", "--memory-limit", "0", "--no-dashboard", "--host", "127.0.0.1", "--death-timeout", "60")
_NO_PAGES = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}  # a server of metrics there is all the same
_Started = list[tuple[subprocess.Popen[bytes], IO[bytes]]]


@contextmanager
def local_workers(count: int | None) -> Iterator[tuple[str, Callable[[], str]]]:
    """The scheduler's address, and a function that says why all workers are gone, if they are."""
    from distributed import LocalCluster

    with ExitStack() as stack:
        scratch = stack.enter_context(TemporaryDirectory(ignore_cleanup_errors=True))
        cluster = LocalCluster(n_workers=0, silence_logs=CRITICAL, scheduler_kwargs=_NO_PAGES)
        stack.callback(cluster.close, timeout=2.0)
        started: _Started = []
        stack.callback(_end, started)
        for _ in range(count or 1):
            log = stack.enter_context(TemporaryFile())
            started.append((_worker(cluster.scheduler_address, scratch, log), log))
        yield cluster.scheduler_address, lambda: _why_gone(started)


def _worker(address: str, scratch: str, log: IO[bytes]) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-P", "-m", "distributed.cli.dask_worker", address, *_OPTIONS]
    return subprocess.Popen(
        [*command, "--local-directory", scratch],
        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=log, start_new_session=True,
    )  # fmt: skip


def _why_gone(started: _Started) -> str:
    if any(process.poll() is None for process, _ in started):
        return ""
    log = started[-1][1]
    log.seek(0)
    lines = log.read().decode(errors="replace").strip().splitlines() or ["nothing"]
    return f"all workers have ended; the last one's last word was: {lines[-1]}"


def _end(started: _Started) -> None:
    """Workers are killed as they stand: what they have done is kept, and what they are at would not be."""
    for process, _ in started:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()

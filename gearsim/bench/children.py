"""What a command takes in a process of its own: time from start to exit, CPU time, peaks of memory."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from threading import Event, Thread
from time import perf_counter
from types import TracebackType
from typing import NamedTuple

PERIOD_S = 0.02
_MAXRSS_UNIT = 1 if sys.platform == "darwin" else 1024


class Usage(NamedTuple):
    """What a command and the processes it started took.

    ``exit_code``; ``seconds``: wall time; ``cpu_s``: CPU time of all; ``largest``: peak of the process that held most
    [bytes]; ``together``: the most that all held at one time [bytes], pages that they share counted in each;
    ``said``: what it wrote to stderr.
    """

    exit_code: int
    seconds: float
    cpu_s: float
    largest: int
    together: int
    said: str


def watched(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> Usage:
    """Run a command in a folder to its end; its output is dropped. Raises OSError where it cannot be started."""
    with TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        started = perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=said)
        with _MemoryWatch(process.pid) as memory:
            _, status, used = os.wait4(process.pid, 0)
        seconds = perf_counter() - started
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        text = said.read().strip()
    least = 0 if memory.largest else used.ru_maxrss * _MAXRSS_UNIT  # no /proc, or gone before the first look
    largest, cpu_s = max(memory.largest, least), used.ru_utime + used.ru_stime
    return Usage(process.returncode, seconds, cpu_s, largest, max(memory.together, largest), text)


class _MemoryWatch:
    """Looks at a process and its descendants every few milliseconds, on a thread of its own."""

    def __init__(self, pid: int) -> None:
        self.largest = self.together = self._last = 0
        self._ended = Event()
        self._thread = Thread(target=self._watch, args=(pid,), daemon=True)

    def __enter__(self) -> _MemoryWatch:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self, pid: int) -> None:
        while not self._ended.wait(PERIOD_S):
            held = [memory_of(p) for p in _family(pid)]
            self.largest = max((self.largest, *(peak for _, peak in held)))
            now = sum(resident for resident, _ in held)
            # a process about to start another is seen twice for an instant: only what two looks saw counts
            self.together = max(self.together, min(self._last, now))
            self._last = now


def _family(pid: int) -> Iterator[int]:
    """A process and its descendants that still run."""
    yield pid
    for listed in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            children = listed.read_text(encoding="ascii").split()
        except OSError:  # the thread has ended
            continue
        for child in children:
            yield from _family(int(child))


def memory_of(pid: int) -> tuple[int, int]:
    """Bytes that a process holds and held at its peak, as /proc has them; zeros where it does not.

    ru_maxrss counts also what the process that started it held.
    """
    try:
        lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 0, 0
    sizes = dict(line.split(":", 1) for line in lines if line.startswith(("VmRSS", "VmHWM")))
    resident, peak = (1024 * int(sizes.get(name, "0 kB").split()[0]) for name in ("VmRSS", "VmHWM"))
    return resident, peak

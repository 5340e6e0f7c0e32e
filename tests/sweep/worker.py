"""Cases run by the command's own entry in a process beside, within limits of time and memory."""

import io
import multiprocessing
import os
import resource
import sys
import traceback
import warnings
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

_ROOM = 3 << 30  # bytes of addresses above what the loaded process has; a third of them is used at most


@dataclass(frozen=True)
class Outcome:
    """How a case ended: the exit code (None: a traceback, a dead process or none in time) and what was said."""

    code: int | None
    out: str
    err: str


@contextmanager
def _found():
    """Meanwhile processes that are started find the tests, however these were started."""
    sys.path.append(str(Path(__file__).parents[2]))
    try:
        yield
    finally:
        sys.path.pop()


def _serve(pipe):
    from gearsim.cli import main
    from gearsim.simulation.removal import open_device

    open_device("cpu")
    warnings.simplefilter("always")
    limit = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE") + _ROOM
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    while True:
        arguments = pipe.recv()
        out, err = io.StringIO(), io.StringIO()
        code = None
        with redirect_stdout(out), redirect_stderr(err):
            try:
                code = main(arguments)
            except SystemExit as stop:
                code = stop.code
            except BaseException:
                traceback.print_exc(limit=-4)
        pipe.send((code, out.getvalue(), err.getvalue()))


class Worker:
    """A process that runs one case after the other; a new one where it died or was too slow. Use as a context."""

    def __init__(self, seconds):
        self._seconds, self._process = seconds, None

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self._stop()

    def run(self, arguments) -> Outcome:
        """What ``gearsim ARGUMENTS`` does."""
        if self._process is None:
            self._start()
        try:
            self._pipe.send(arguments)
            if self._pipe.poll(self._seconds):
                return Outcome(*self._pipe.recv())
            said = f"not done in {self._seconds:g} s"
        except (EOFError, OSError):
            said = "the process died"
        self._stop()
        return Outcome(None, "", said)

    def _start(self):
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        with _found():
            self._process.start()
        theirs.close()

    def _stop(self):
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
            self._process = None

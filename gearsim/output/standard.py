"""Standard output and error whose reader has left, or that are closed: the job goes on and ends as it would."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from gearsim.errors import InputError


@contextmanager
def safe_streams() -> Iterator[None]:
    """Within it, what is printed to closed streams, or to pipes that nobody reads, is dropped.

    When it ends everything is written. Raises InputError where standard output takes no more, as on a full disk; the
    rest is dropped, as is all that standard error does not take. Streams that others have put in their places stay.
    """
    _fill_closed()
    before = sys.stdout, sys.stderr
    if sys.stdout is sys.__stdout__:
        sys.stdout = _guarded(sys.stdout, refuse=True)
    if sys.stderr is sys.__stderr__:
        sys.stderr = _guarded(sys.stderr, refuse=False)
    try:
        yield
    finally:
        try:
            sys.stdout.flush()
        finally:
            sys.stdout, sys.stderr = before


def _guarded(stream: Any, refuse: bool) -> io.TextIOWrapper:
    stream.flush()
    raw = io.BufferedWriter(_Output(stream.fileno(), refuse))
    return io.TextIOWrapper(raw, stream.encoding, stream.errors, line_buffering=stream.line_buffering)


class _Output(io.FileIO):
    """A stream's bytes. After an error they go nowhere; it is told where the caller asked to ``refuse`` it."""

    def __init__(self, number: int, refuse: bool) -> None:
        super().__init__(number, "w", closefd=False)
        self.refuse = refuse

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError as error:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.fileno())
            os.close(nowhere)
            if self.refuse and not isinstance(error, BrokenPipeError):
                raise InputError(f"cannot write to standard output: {error.strerror}") from error
            return super().write(data)


def _fill_closed() -> None:
    """Open what was closed when we were started, before some file takes its number and receives what is printed."""
    for number, name in ((0, "stdin"), (1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            found = os.open(os.devnull, os.O_RDWR)
            if found != number:
                os.dup2(found, number)
                os.close(found)
            stream = open(number, "w" if number else "r", closefd=False)  # noqa: SIM115 - stays to the end
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)

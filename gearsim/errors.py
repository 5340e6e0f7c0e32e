"""Exceptions, files that cannot be read or written, and what the status bits of a kernel mean to a person."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from enum import IntFlag
from pathlib import Path

from gearsim.scratch import hold, making, scratch_beside


class GearsimError(Exception):
    """A failure with one clear message; ``exit_code`` is what the command line returns."""

    exit_code = 2


class InputError(GearsimError):
    """The input cannot be used: it names the file, line or field, what is wrong, what would be right."""


def read_input(file: Path, what: str) -> str:
    """The text of an input file, its lines parted by line feeds, without a byte-order mark; ``what`` it should be.

    Raises InputError where it cannot be read.
    """
    data = read_input_bytes(file, what)
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise InputError(f"cannot read {what} {file}: it is not UTF-8 text (byte {error.start})") from error


def is_file(path: Path) -> bool:
    """Whether there is such a file; no name, however odd, raises."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """Whether there is such a folder; no name, however odd, raises."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_input_bytes(file: Path, what: str) -> bytes:
    """The bytes of an input file; ``what`` it should be. Raises InputError where it cannot be read."""
    try:
        return file.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {what} {file}: {error.strerror}") from error
    except ValueError as error:  # of names with a NUL in them
        raise InputError(f"cannot read {what} {str(file)!r}: {error}") from error


@contextmanager
def written(file: Path, what: str = "") -> Iterator[Path]:
    """A scratch file beside ``file`` that takes its place when the block ends without an error; devices are written to.

    ``what`` it is stands in the message. What killed processes have left beside it is cleared. Raises InputError where
    it cannot be written; then an older file is as it was.
    """
    target = file.resolve()
    device = target.exists() and not target.is_file()
    try:
        with nullcontext(target) if device else _replacing(target) as scratch:
            yield scratch
    except OSError as error:
        raise InputError(f"cannot write {f'{what} ' * bool(what)}{file}: {error.strerror or error}") from error


@contextmanager
def _replacing(target: Path) -> Iterator[Path]:
    scratch = scratch_beside(target)
    with making(target.parent):
        scratch.touch()
        lock = hold(scratch)
    try:
        yield scratch
        os.replace(scratch, target)
    finally:
        os.close(lock)
        with suppress(OSError):
            scratch.unlink()


class NumericalError(GearsimError):
    """The computation ran, but a numerical status forbids trusting its result."""

    exit_code = 3


class Status(IntFlag):
    """Status bits a ray can carry; the kernels use the same values (kernels/sweep.py)."""

    OK = 0
    INTERVALS_OVERFLOW = 1
    NOT_CONVERGED = 2
    GAP_UNDECIDED = 4


REMEDIES = {
    Status.INTERVALS_OVERFLOW: "a ray was cut into more pieces than its interval list holds; "
    "raise `simulation.interval_slots`",
    Status.NOT_CONVERGED: "the search for a swept interval's end used up its evaluations before meeting "
    "`simulation.tolerance_mm`; loosen the tolerance or split the motion into shorter steps",
    Status.GAP_UNDECIDED: "whether what a step removes from a ray is one stretch or two was not decided; "
    "split the motion into shorter steps",
}


def explain(status: int) -> list[str]:
    """Say in words what is wrong and what to do, one sentence per set bit of ``status``."""
    return [f"{bit.name}: {remedy}" for bit, remedy in REMEDIES.items() if status & bit]

"""Scratch files and folders: what is written aside, locked while its process lives, cleared when that was killed."""

from __future__ import annotations

import fcntl
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PREFIX = ".unfinished-"
_FILE = re.compile(rf"{re.escape(PREFIX)}\d+-.+", re.DOTALL)


@contextmanager
def making(folder: Path) -> Iterator[None]:
    """Meanwhile no other process makes scratch in a folder; what killed ones have left there is gone.

    Nothing is seen between its making and its lock, if both happen in here. Where folders cannot be locked nothing is
    cleared. Scratch itself is its process's alone, and locked already.
    """
    if folder.name.startswith(PREFIX):
        yield
        return
    try:
        lock = os.open(folder, os.O_RDONLY)
    except PermissionError:  # it may be written all the same
        yield
        return
    try:
        with suppress(OSError):
            fcntl.flock(lock, fcntl.LOCK_EX)
            for old in folder.glob(f"{PREFIX}*"):
                if old.is_dir() or _FILE.fullmatch(old.name):
                    _clear(old)
        yield
    finally:
        os.close(lock)


def hold(scratch: Path) -> int:
    """Lock a scratch file or folder; the lock ends when what is returned is closed, or with the process."""
    lock = os.open(scratch, os.O_RDONLY)
    with suppress(OSError):
        fcntl.flock(lock, fcntl.LOCK_EX)
    return lock


def scratch_beside(target: Path) -> Path:
    """The scratch file of this process for a file."""
    return target.with_name(f"{PREFIX}{os.getpid()}-{target.name}")


def _clear(old: Path) -> None:
    """Remove scratch that no living process holds."""
    with suppress(OSError):
        lock = os.open(old, os.O_RDONLY | os.O_NOFOLLOW)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if old.is_dir():
                shutil.rmtree(old, ignore_errors=True)
            else:
                old.unlink()
        finally:
            os.close(lock)

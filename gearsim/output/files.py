"""The output folder: everything is written aside and moved in place only when it is complete."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from gearsim.errors import InputError

LAST = "report.json"
_UNFINISHED = ".unfinished-"
SAMPLES = "samples.parquet"
MESHES = "tooth.vtp"


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """A scratch folder inside ``folder`` whose files move there when the block ends without an error.

    report.json goes away first and comes back last, so that a folder that holds it is complete. Scratch folders of
    killed runs are cleared; that of a run that lives is locked. Raises InputError where the folder cannot be made or
    written; a folder that was made for nothing is gone again.
    """
    with into(folder):
        made = not folder.exists()
        folder.mkdir(parents=True, exist_ok=True)
        stage, lock = _scratch(folder)
    try:
        yield stage
        with into(folder):
            (folder / LAST).unlink(missing_ok=True)
            for file in sorted(stage.iterdir(), key=lambda f: f.name == LAST):
                os.replace(file, folder / file.name)
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        os.close(lock)
        if made:
            with suppress(OSError):  # it is not empty
                folder.rmdir()


@contextmanager
def into(folder: Path) -> Iterator[None]:
    """Whatever the disk refuses meanwhile, as InputError: the folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise InputError(
            f"cannot write into output folder {folder}: {error.strerror or error}; choose another with --out"
        ) from error


def _scratch(folder: Path) -> tuple[Path, int]:
    """A new scratch folder and its lock, which ends with its process; those of killed runs are cleared.

    Where folders cannot be locked nothing is cleared.
    """
    parent = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(parent, fcntl.LOCK_EX)  # no scratch folder is seen between its making and its lock
            for old in folder.glob(f"{_UNFINISHED}*/"):
                _clear(old)
        stage = Path(tempfile.mkdtemp(prefix=_UNFINISHED, dir=folder))
        lock = os.open(stage, os.O_RDONLY)
        with suppress(OSError):
            fcntl.flock(lock, fcntl.LOCK_EX)
        return stage, lock
    finally:
        os.close(parent)


def _clear(old: Path) -> None:
    """Remove a scratch folder that no living run holds."""
    with suppress(OSError):
        lock = os.open(old, os.O_RDONLY)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(old, ignore_errors=True)
        finally:
            os.close(lock)

"""The output folder: everything is written aside and moved in place only when it is complete."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from gearsim.errors import InputError
from gearsim.scratch import PREFIX, hold, making

LAST = "report.json"
SAMPLES = "samples.parquet"
MESHES = "tooth.vtp"
PART = "part.vtp"
STOCK = "stock.parquet"
CHECKPOINTS = ".stock-so-far"  # of a whole part, until its run is complete
VIEW = "view"  # the interactive one, which stands in report.html


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """A scratch folder inside ``folder`` whose files move there when the block ends without an error.

    report.json goes away first and comes back last, so that a folder that holds it is complete. What killed runs have
    left is cleared; the scratch folder of a run that lives is locked. Raises InputError where the folder cannot be
    made or written; a folder that was made for nothing is gone again.
    """
    with into(folder):
        made = not folder.exists()
        folder.mkdir(parents=True, exist_ok=True)
        with making(folder):
            stage = Path(tempfile.mkdtemp(prefix=PREFIX, dir=folder))
            lock = hold(stage)
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

"""The output folder: everything is written aside and moved in place only when it is complete."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gearsim.errors import InputError

LAST = "report.json"
SAMPLES = "samples.parquet"
MESHES = "tooth.vtp"


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """A scratch folder inside ``folder`` whose files move there when the block ends without an error.

    report.json goes away first and comes back last, so that a folder that holds it is complete. Raises
    InputError where the folder cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=folder))
    except OSError as error:
        raise InputError(
            f"cannot write into output folder {folder}: {error.strerror}; choose another with --out"
        ) from error
    try:
        yield stage
        (folder / LAST).unlink(missing_ok=True)
        for file in sorted(stage.iterdir(), key=lambda f: f.name == LAST):
            os.replace(file, folder / file.name)
    finally:
        shutil.rmtree(stage, ignore_errors=True)

"""Files of a study's folder: each written aside, and moved into its place when it is whole."""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
import weakref
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from gearsim.errors import InputError
from gearsim.scratch import PREFIX, hold, making

GO_ON = "what was kept so far is whole: the same command with the same --out goes on from there"


class Writer:
    """Writes files of a ``folder`` from a scratch folder in it, locked while this process lives.

    What killed processes have left there is cleared when the scratch folder is made, by the first file.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._scratch: Path | None = None

    def put(self, file: Path, data: bytes) -> None:
        """Write a file of the folder. Raises InputError where the disk refuses it; an older one is then as it was."""
        with self.into(file) as scratch:
            scratch.write_bytes(data)

    @contextmanager
    def into(self, file: Path) -> Iterator[Path]:
        """A scratch file that takes the place of ``file`` when the block ends without an error; else as ``put``."""
        try:
            handle, name = tempfile.mkstemp(dir=self._made())
            os.close(handle)
            scratch = Path(name)
            try:
                yield scratch
                scratch.chmod(0o644)
                file.parent.mkdir(parents=True, exist_ok=True)
                os.replace(scratch, file)
            finally:
                scratch.unlink(missing_ok=True)
        except OSError as error:
            raise refused(self.folder, error) from error

    def link(self, source: Path, file: Path) -> None:
        """Let a file have the contents of another one, without a copy where the disk can; else as ``put``."""
        with self.into(file) as scratch:
            scratch.unlink()
            try:
                os.link(source, scratch)
            except OSError:
                shutil.copyfile(source, scratch)

    def _made(self) -> Path:
        if self._scratch is None or not self._scratch.is_dir():
            with making(self.folder):
                self._scratch = Path(tempfile.mkdtemp(prefix=PREFIX, dir=self.folder))
                lock = hold(self._scratch)
            self._clear = weakref.finalize(self, _clear, self._scratch, lock, os.getpid())
        return self._scratch

    def release(self) -> None:
        """Clear the scratch folder; the next file makes another."""
        if self._scratch is not None:
            self._clear()
            self._scratch = None


def _clear(scratch: Path, lock: int, process: int) -> None:
    if os.getpid() == process:  # a forked child has a copy of the writer
        shutil.rmtree(scratch, ignore_errors=True)
    with suppress(OSError):
        os.close(lock)


def refused(folder: Path, error: OSError) -> InputError:
    """What the disk refused, and how to go on."""
    return InputError(f"cannot write into the study's folder {folder}: {error.strerror or error}; {GO_ON}")


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def sha256_of(file: Path) -> str:
    """The checksum of a file's contents."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()

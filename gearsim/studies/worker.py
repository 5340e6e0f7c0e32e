"""What a worker of a cluster does: a chunk of a study's jobs, computed and kept by the worker itself."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from threading import get_ident
from typing import cast

from gearsim.errors import InputError
from gearsim.result import versions
from gearsim.studies.careful import Compute, careful
from gearsim.studies.records import Outcome, counted
from gearsim.studies.store import STUDY, Store
from gearsim.studies.writing import sha256

RUN_CHUNK = "gearsim.studies.chunk:run_chunk"


@dataclass(frozen=True)
class Errand:
    """What all tasks of a study have in common.

    ``digest`` of its study.json, by which a worker knows that it sees the same folder; ``versions`` of what computes;
    ``compute``: module and name of what does a chunk, ``run_chunk`` but in tests.
    """

    folder: str
    digest: str
    device: str
    versions: tuple[tuple[str, str], ...]
    compute: str = RUN_CHUNK


def errand(store: Store, device: str, compute: str = RUN_CHUNK) -> Errand:
    """What the workers of a study need to know; the folder must be one that they see, too."""
    folder = store.folder.resolve()
    return Errand(str(folder), sha256((folder / STUDY).read_bytes()), device, tuple(versions().items()), compute)


def keep_chunk(asked: Errand, chunk: int) -> dict[str, int]:
    """Compute and keep a chunk, if nobody has; how many of its jobs have each verdict.

    Raises InputError where this worker cannot take part, or the disk refuses the results.
    """
    store = _store(asked, get_ident())
    if store.has(chunk):  # a task comes again where the worker was lost that had done it
        return {}
    outcomes, seconds = careful(_compute(asked), store.study, store.study.jobs_of(chunk), asked.device, 1)
    store.put(chunk, outcomes, seconds, asked.device)
    store.release()
    return counted(outcomes)


def one_job(asked: Errand, job: int) -> Outcome:
    """What comes of one job, kept nowhere."""
    (outcome,), _ = careful(_compute(asked), _store(asked, get_ident()).study, [job], asked.device, 1)
    return outcome


def _compute(asked: Errand) -> Compute:
    module, _, name = asked.compute.partition(":")
    return cast(Compute, getattr(import_module(module), name))


@lru_cache(maxsize=64)
def _store(asked: Errand, _thread: int) -> Store:
    """The study's folder as this worker sees it, one for each of its threads.

    Raises InputError where it sees none, or another study's, or computes with other versions.
    """
    me = f"the worker {os.uname().nodename} (process {os.getpid()})"
    differ = [f"{name} {version}" for name, version in versions().items() if (name, version) not in asked.versions]
    if differ:
        wanted = ", ".join(f"{name} {version}" for name, version in asked.versions)
        raise InputError(f"{me} has {', '.join(differ)}; this study is computed by {wanted}: install the same there")
    try:
        data = (Path(asked.folder) / STUDY).read_bytes()
    except OSError as error:
        raise InputError(
            f"{me} does not see the study's folder {asked.folder} ({error.strerror}); it must lie on a disk that all "
            "workers have under the same path"
        ) from None
    if sha256(data) != asked.digest:
        raise InputError(f"{me} sees another study in {asked.folder}; all workers must have the same disk there")
    return Store.open(Path(asked.folder))

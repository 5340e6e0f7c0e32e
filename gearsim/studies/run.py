"""The verb: compute a study's jobs, those that are not kept yet, and make its data set."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearsim.errors import InputError
from gearsim.scratch import making
from gearsim.studies.progress import Silent, StudyProgress
from gearsim.studies.reading import read_study
from gearsim.studies.records import Study, counted
from gearsim.studies.store import JOBS, Store

if TYPE_CHECKING:
    import pyarrow as pa


@dataclass(frozen=True)
class StudyResult:
    """What a study has left in its ``folder``; ``counts``: how many jobs have each verdict."""

    study: Study
    folder: Path
    counts: Mapping[str, int]

    @property
    def table(self) -> pa.Table:
        """jobs.parquet: a row a job, its parameters, figures, verdict and error."""
        import pyarrow.parquet as pq

        return pq.read_table(self.folder / JOBS)

    @property
    def exit_code(self) -> int:
        """0: every job has its result, whatever its verdict; 1: some have an error in its place."""
        return 1 if self.counts.get("error") else 0


def study(
    source: str | Path | Mapping[str, Any] | Study, out: Path | str | None = None, *, device: str = "cpu",
    workers: int | None = None, scheduler: str | None = None, exr: bool = False,
    progress: StudyProgress | None = None, overrides: Sequence[str] = (), summary: bool = True,
) -> StudyResult:  # fmt: skip
    """Compute a study: a built-in one's name, the path of its TOML file, its nested tables, or what was read of it.

    ``out``: its folder (default: runs/NAME); jobs that stand there are not computed again. ``device`` is ``cpu`` or
    ``cuda:0``, .... Without ``workers`` and ``scheduler`` this process computes; ``workers``: so many processes of one
    core each; ``scheduler``: the address of a Dask scheduler, whose workers must see the folder. ``exr``: an EXR file
    a job, too. ``summary``: whether summary.html is written. ``overrides``: ``table.key=value``, of the study itself or
    for all its jobs.

    Raises InputError for what is wrong in the study or cannot be written, and GearsimError where a cluster is lost; a
    job that cannot be done is a row with its error. What was kept stays, and the same call goes on from there.
    """
    if workers is not None and scheduler is not None:
        raise InputError("workers and scheduler exclude each other: a scheduler has workers of its own")
    if workers is not None and (type(workers) is not int or workers < 1):
        raise InputError(f"workers: got {workers!r}; expected a whole number above 0")
    if not isinstance(source, Study):
        source = read_study(source, overrides=overrides)
    elif overrides:
        raise InputError(f"overrides ({', '.join(overrides)}) change a study as it is read; this one was read already")
    from gearsim.studies.summary_reading import summarise

    store = Store.create(Path(out) if out is not None else Path("runs") / source.name, source)
    done, progress = store.done(), progress or Silent()
    left = [chunk for chunk in range(source.chunks) if chunk not in done]
    progress.begin(len(source), sum(len(source.jobs_of(chunk)) for chunk in done))
    if left:
        _compute(store, left, progress, device, workers, scheduler)
    progress.tell("writing the data set")
    counts = store.finish(exr)
    if summary:
        progress.tell("summing up")
        summarise(store.folder)
    return StudyResult(source, store.folder, counts)


def _compute(
    store: Store, left: Sequence[int], progress: StudyProgress, device: str, workers: int | None, scheduler: str | None
) -> None:
    """Compute and keep the chunks that are left."""
    if workers is None and scheduler is None:
        from gearsim.studies.local import computed

        for chunk, outcomes, seconds in computed(store.study, left, device):
            store.put(chunk, outcomes, seconds, device)
            progress.advance(len(outcomes), counted(outcomes))
        return
    from gearsim.studies.cluster import run_cluster

    run_cluster(store, left, progress, workers=workers, scheduler=scheduler, device=device)
    with making(store.folder):  # what killed workers have left there is cleared
        pass

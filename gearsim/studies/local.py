"""A study computed in this process: the next chunk is planned while the rays of the one before are cut."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from gearsim.studies.careful import careful
from gearsim.studies.chunk import run_chunk
from gearsim.studies.records import Outcome, Study


def computed(
    study: Study, chunks: Sequence[int], device: str = "cpu", done: Callable[[int], None] = lambda jobs: None
) -> Iterator[tuple[int, list[Outcome], dict[str, float]]]:
    """Chunk after chunk with its outcomes and the seconds it took; ``done`` is told of jobs done."""
    for chunk in chunks:
        jobs = study.jobs_of(chunk)
        outcomes, seconds = careful(run_chunk, study, jobs, device)
        done(len(jobs))
        yield chunk, outcomes, seconds

"""A study computed in this process: the next chunk is planned while the rays of the one before are cut."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

from gearsim.studies.careful import careful
from gearsim.studies.chunk import PlannedChunk, measure_chunk, plan_chunk
from gearsim.studies.records import Outcome, Study


def computed(
    study: Study, chunks: Sequence[int], device: str = "cpu"
) -> Iterator[tuple[int, list[Outcome], dict[str, float]]]:
    """Chunk after chunk with its outcomes and the seconds it took."""
    ahead: dict[range, Future[PlannedChunk]] = {}

    def compute(
        study: Study, jobs: Sequence[int], device: str, cores: int | None
    ) -> tuple[list[Outcome], dict[str, float]]:
        planned = ahead.pop(jobs, None) if isinstance(jobs, range) else None
        return measure_chunk(study, jobs, planned.result() if planned else plan_chunk(study, jobs), device, cores)

    with ThreadPoolExecutor(1) as planner:
        for i, chunk in enumerate(chunks):
            for number in chunks[i : i + 2]:
                jobs = study.jobs_of(number)
                if jobs not in ahead:
                    ahead[jobs] = planner.submit(plan_chunk, study, jobs)
            yield chunk, *careful(compute, study, study.jobs_of(chunk), device)

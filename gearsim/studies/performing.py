"""Jobs of a chunk asked together: their rays in one launch, those that cannot be trusted by themselves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import GearsimError, InputError, NumericalError
from gearsim.metrology.gear_iso import GearMeasurement
from gearsim.metrology.grid import GridMeasurement
from gearsim.metrology.inspection import Reading, perform, together
from gearsim.metrology.job import Job
from gearsim.processes.brief import Planned
from gearsim.simulation.workshop import Workshop


class Done(NamedTuple):
    """A job and what its inspections read."""

    job: Job
    readings: list[Reading]


def performed(
    planned: Sequence[Planned | GearsimError], device: str, cores: int | None
) -> list[Done | GearsimError]:  # fmt: skip
    """Each job with its readings, or why it has none; jobs of the same settings are asked in one go.

    A job whose figures are not within what was planned for is made whole and asked again.
    """
    out: dict[int, Done | GearsimError] = {i: p for i, p in enumerate(planned) if isinstance(p, GearsimError)}
    alike: dict[tuple[float, int], list[int]] = {}
    for i, one in enumerate(planned):
        if isinstance(one, Planned):
            s = one.job.settings
            alike.setdefault((s.tolerance_mm, s.interval_slots), []).append(i)
    for settings, members in alike.items():
        jobs = [one.job for one in map(planned.__getitem__, members) if isinstance(one, Planned)]
        for i, done in zip(members, _asked(jobs, settings, device, cores), strict=True):
            out[i] = done
    for i, one in enumerate(planned):
        if isinstance(one, Planned) and one.whole is not None and not _within(out[i], one.within):
            out[i] = _again(one, device, cores)
    return [out[i] for i in range(len(planned))]


def _asked(
    jobs: Sequence[Job], settings: tuple[float, int], device: str, cores: int | None
) -> list[Done | GearsimError]:  # fmt: skip
    """Jobs of the same settings, one by one where one of them cannot be trusted."""
    workshop = Workshop(device, *settings, threads=cores)
    try:
        readings = perform(together([job.steps() for job in jobs]), workshop)
        return [Done(job, found) for job, found in zip(jobs, readings, strict=True)]
    except (NumericalError, InputError) as error:
        if len(jobs) == 1:
            return [error]
        return [done for job in jobs for done in _asked([job], settings, device, cores)]


def _again(one: Planned, device: str, cores: int | None) -> Done | GearsimError:
    assert one.whole is not None
    try:
        job = one.whole()
    except GearsimError as error:
        return error
    return _asked([job], (job.settings.tolerance_mm, job.settings.interval_slots), device, cores)[0]


def _within(done: Done | GearsimError, limit_mm: float) -> bool:
    """Whether everything was measured and is smaller than a limit."""
    if isinstance(done, GearsimError):
        return False
    measured = (m for reading in done.readings for m in reading.measurements)
    return all(bool((np.abs(um) < 1e3 * limit_mm).all()) for m in measured for um in _deviations_um(m))


def _deviations_um(measurement: object) -> Iterator[NDArray[np.floating]]:
    """All deviations that a measurement tells [um], nan where there is none."""
    if isinstance(measurement, GridMeasurement):
        yield 1e3 * measurement.deviation.value[measurement.measurable]
    elif isinstance(measurement, GearMeasurement):
        for traces in (*measurement.found.profile.values(), *measurement.found.helix.values()):
            yield traces.deviation_um

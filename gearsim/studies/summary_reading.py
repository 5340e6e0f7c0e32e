"""A study's data set read for its summary: the table by column, the maps job by job."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.studies.records import SurfaceMap
from gearsim.studies.store import JOBS, MAPS, STUDY
from gearsim.studies.study_file import read_study_file
from gearsim.studies.summary import SUMMARY, write_summary
from gearsim.studies.summary_frame import Frame, frame_of
from gearsim.studies.surface_arrays import read_field, surfaces_in


def summarise(folder: Path) -> Path:
    """Write summary.html into a study's folder whose data set is complete; its path.

    Raises InputError where the folder holds no study, or cannot be written.
    """
    study, _ = read_study_file(folder / STUDY)
    columns = read_columns(folder / JOBS)
    done = np.flatnonzero(columns["verdict"].astype(str) != "error")
    frame = frame_of(study, int(done[0])) if done.size else Frame()
    write_summary(study, columns, MapReader(folder / MAPS), folder / SUMMARY, frame)
    return folder / SUMMARY


def read_columns(file: Path) -> dict[str, NDArray[Any]]:
    """A table's columns, shape (rows,): numbers with nan for null, truth values, words with "" for null."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    table, out = pq.read_table(file), {}
    for name in table.column_names:
        column = table.column(name)
        if pa.types.is_string(column.type):
            out[name] = np.array([v or "" for v in column.to_pylist()], dtype=object)
        elif column.null_count and not pa.types.is_floating(column.type):
            out[name] = column.cast(pa.float64()).to_numpy()
        else:
            out[name] = column.to_numpy()
    return out


class MapReader:
    """The maps of a maps.zarr by job; none where there is no such array."""

    def __init__(self, folder: Path) -> None:
        import zarr

        self._group: Any = zarr.open_group(folder, mode="r") if (folder / "zarr.json").is_file() else None
        self._surfaces = surfaces_in(self._group) if self._group is not None else []

    def __call__(self, job: int) -> Mapping[str, SurfaceMap]:
        """Maps of a job by surface; those that were measured."""
        found = {s: SurfaceMap(*(self._of(s, f, job) for f in SurfaceMap.__dataclass_fields__)) for s in self._surfaces}
        return {s: m for s, m in found.items() if np.isfinite(m.deviation_um).any()}

    def _of(self, surface: str, field: str, job: int) -> NDArray[Any]:
        return np.asarray(read_field(self._group, surface, field, range(job, job + 1))[0])

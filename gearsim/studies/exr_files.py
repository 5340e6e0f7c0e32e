"""A job's maps as an EXR file each, with the channels of a run's deviation.exr."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import is_folder
from gearsim.metrology.deviation import Crossing
from gearsim.output.columns import CROSSINGS, YES_NO, Column, key_of_numbers
from gearsim.output.exr import header, write_exr
from gearsim.studies.records import SurfaceMap
from gearsim.studies.store import MAPS, Store
from gearsim.studies.surface_arrays import read_field, surfaces_in
from gearsim.studies.writing import Writer, refused

EXR = "exr"
_FRAME = "as in the runs of the scene: the frame of its part"


def write_exr_files(store: Store, writer: Writer) -> None:
    """Write exr/JOB.exr of every job that has maps, from maps.zarr as a whole; older ones go first."""
    import zarr

    try:
        with suppress(FileNotFoundError):
            shutil.rmtree(store.folder / EXR)
        (store.folder / EXR).mkdir()
    except OSError as error:
        raise refused(store.folder, error) from error
    if not is_folder(store.folder / MAPS):
        return
    maps: Any = zarr.open_group(store.folder / MAPS, mode="r")
    surfaces, fields = surfaces_in(maps), SurfaceMap.__dataclass_fields__
    for chunk in range(store.study.chunks):
        jobs = store.study.jobs_of(chunk)
        read = {s: {field: read_field(maps, s, field, jobs) for field in fields} for s in surfaces}
        for k, job in enumerate(jobs):
            parts = {s: _channels({field: v[k] for field, v in own.items()}) for s, own in read.items()}
            parts = {s: p for s, p in parts.items() if np.any(p["crossing.id"].values != Crossing.ABSENT)}
            if parts:
                values = {k: str(v) for k, v in store.study.values_of(job).items()}
                told = header(store.study.name, _FRAME, job=str(job), **values)
                with writer.into(store.folder / EXR / f"{job:06d}.exr") as scratch:
                    write_exr(parts, told, scratch)


def _channels(fields: Mapping[str, NDArray[Any]]) -> dict[str, Column]:
    shape = fields["crossing"].shape
    out = {
        "deviation.um": Column(fields["deviation_um"], "deviation under the whole program; positive: material left"),
        "valid": Column(fields["crossing"] == Crossing.MEASURED, "whether a deviation was measured", YES_NO),
        "crossing.id": Column(fields["crossing"], "what the ray along the normal met", key_of_numbers(CROSSINGS)),
    }
    for name, what, field in (
        ("P", "intended point [mm]", "point"),
        ("N", "unit normal out of the material", "normal"),
    ):
        for k, axis in enumerate("XYZ"):
            out[f"{name}.{axis}"] = Column(fields[field][..., k], f"{axis} of the {what}")
    along, up = np.broadcast_to(fields["v"], shape), np.broadcast_to(fields["u"][:, None], shape)
    return out | {
        "share.length": Column(along, "place along the surface as a share of its length, by columns"),
        "share.height": Column(up, "place up the surface as a share of its height, by rows"),
    }

"""maps.zarr as a whole: chunks as the workers left them, coordinates and parameters along the jobs, all described."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.studies.map_files import ArrayKind, group_file
from gearsim.studies.records import Parameter, Study
from gearsim.studies.rows import as_type, parameter_type
from gearsim.studies.store import GRIDS_KEPT, MAPS, Store
from gearsim.studies.surface_arrays import GRIDS, agree, common_dims, kinds, shared
from gearsim.studies.writing import Writer, refused

_ALONG = 65_536  # jobs in a chunk of what is one number a job


def join_maps(store: Store, writer: Writer, kept: Sequence[dict[str, Any]], notes: Mapping[str, str]) -> None:
    """Make maps.zarr one Zarr v3 group with consolidated metadata that xarray.open_zarr reads.

    What chunks say of their surfaces is in ``kept``. Where all jobs' samples lie at the same places, these stand there
    once; else once a job.
    """
    surfaces = _surfaces(kept)
    dims = common_dims(surfaces)
    made: list[ArrayKind] = []
    size = min(store.study.chunk, len(store.study))
    all_kinds = {s: kinds(s, shape, len(store.study), size, dims[s]) for s, shape in surfaces.items()}
    stay = {kind.name for own in all_kinds.values() for field, kind in own.items() if field not in GRIDS}
    _clear(store, stay)
    for surface, own in all_kinds.items():
        made += [kind for field, kind in own.items() if field not in GRIDS]
        made += _grids(store, writer, kept, surface, [own[field] for field in GRIDS])
    for kind in made:
        writer.put(store.folder / MAPS / kind.described, kind.files()[kind.described])
    made += _along_jobs(store, writer)
    writer.put(store.folder / MAPS / "zarr.json", group_file(made, notes))


def _surfaces(kept: Sequence[dict[str, Any]]) -> dict[str, tuple[int, int]]:
    found: dict[str, tuple[int, int]] = {}
    for told in kept:
        for surface, about in told["surfaces"].items():
            agree(found, surface, (int(about["shape"][0]), int(about["shape"][1])))
    return dict(sorted(found.items()))


def _clear(store: Store, stay: set[str]) -> None:
    """Remove what earlier joins made and what no surface is called any more."""
    try:
        for folder in (store.folder / MAPS).iterdir():
            if folder.is_dir() and folder.name not in stay:
                shutil.rmtree(folder)
    except OSError as error:
        raise refused(store.folder, error) from error


def _grids(
    store: Store, writer: Writer, kept: Sequence[dict[str, Any]], surface: str, own: Sequence[ArrayKind]
) -> list[ArrayKind]:
    """The places of a surface's samples: once where they are all jobs', else chunk by chunk as they were kept."""
    told = {chunk: about["surfaces"][surface] for chunk, about in enumerate(kept) if surface in about["surfaces"]}
    digests = {about["grid"] for about in told.values()}
    if len(digests) == 1 and "" not in digests:
        chunk, about = next(iter(told.items()))
        job = store.study.jobs_of(chunk).start + about["first"]
        return [_write(store, writer, shared(kind), _kept_grid(store, kind, job)) for kind in own]
    for kind in own:
        for chunk in told:
            writer.link(store.folder / GRIDS_KEPT / kind.place(chunk), store.folder / MAPS / kind.place(chunk))
    return list(own)


def _kept_grid(store: Store, kind: ArrayKind, job: int) -> NDArray[Any]:
    import zarr

    return np.asarray(zarr.open_array(store.folder / GRIDS_KEPT / kind.name, mode="r")[job])


def _along_jobs(store: Store, writer: Writer) -> list[ArrayKind]:
    """The jobs' numbers and their parameters, so that maps are found by them."""
    study = store.study
    along = ArrayKind(
        "job", (len(study),), (min(_ALONG, len(study)),), ("job",), "<i8", 0, {"long_name": "job, from 0"}
    )
    made = [_write(store, writer, along, np.arange(len(study)))]
    for parameter in study.parameters:
        attributes = {"units": parameter.unit, "long_name": f"parameter {parameter.key}: a key of the scene"}
        dtype, fill = _dtype(parameter)
        kind = replace(along, name=parameter.key, dtype=dtype, fill=fill, attributes=attributes)
        made.append(_write(store, writer, kind, _values(study, parameter, dtype)))
    return made


def _dtype(parameter: Parameter) -> tuple[Any, Any]:
    """An array's type as the column's of the same parameter."""
    return {"int64": ("<i8", 0), "double": ("<f8", np.nan), "bool": ("|b1", False)}.get(
        str(parameter_type(parameter)), (str, "")
    )


def _values(study: Study, parameter: Parameter, dtype: Any) -> NDArray[Any]:
    kind = parameter_type(parameter)
    values = [as_type(v, kind) for v in parameter.values]
    return np.array(values, dtype=np.dtypes.StringDType() if dtype is str else dtype)


def _write(store: Store, writer: Writer, kind: ArrayKind, values: NDArray[Any]) -> ArrayKind:
    for place, data in kind.files(values).items():
        writer.put(store.folder / MAPS / place, data)
    return kind

"""The data set of a study whose chunks are all done: jobs.parquet, timings.parquet, maps.zarr, manifest.json, exr/."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from typing import Any

from gearsim import __version__
from gearsim.errors import InputError, is_folder
from gearsim.output.exr import SIGN
from gearsim.studies.exr_files import EXR, write_exr_files
from gearsim.studies.joined_maps import join_maps
from gearsim.studies.records import Study
from gearsim.studies.rows import cast, figure_types, schema_of
from gearsim.studies.store import JOBS, MANIFEST, MAPS, STUDY, Store
from gearsim.studies.study_file import SCHEMA_VERSION, sources
from gearsim.studies.writing import Writer, sha256_of

TIMINGS = "timings.parquet"
UNITS = "each column's or array's own, as its name ends: um, mm, deg, ...; u and v of maps are shares from 0 to 1"
MISSING = "null in tables, nan in deviations; crossing says why there is none"
_ROWS = 16_384  # jobs in a row group, however many a chunk has
_LIBRARIES = ("numpy", "scipy", "warp-lang", "pyarrow", "zarr")


def join(store: Store, writer: Writer, exr: bool = False) -> dict[str, int]:
    """Join the parts of a study into its data set; how many jobs have each verdict.

    Everything but timings.parquet is the same, bit by bit, in whatever order and by whom the chunks were computed.
    manifest.json is last: a folder that has one is complete. Raises InputError where chunks are missing, or are not
    as they were written: such are forgotten, and a rerun computes them again.
    """
    if missing := sorted(set(range(store.study.chunks)) - store.done()):
        raise InputError(
            f"{len(missing)} of the study's {store.study.chunks} chunks are not done (the first: {missing[0]}); run it "
            "again with the same --out"
        )
    kept = [store.kept(chunk) for chunk in range(store.study.chunks)]
    _verify(store, kept)
    store.open_again()
    found = _write_jobs(store, writer)
    _write_timings(store, writer, kept)
    if is_folder(store.folder / MAPS):
        join_maps(store, writer, kept, notes(store.study))
    if exr or is_folder(store.folder / EXR):
        write_exr_files(store, writer)
    writer.put(store.folder / MANIFEST, _manifest(store, kept, found))
    return found


def notes(study: Study) -> dict[str, str]:
    """What every file of a data set says of itself."""
    return {"study": study.name, "sign": SIGN, "units": UNITS, "missing": MISSING, "version": __version__}


def _verify(store: Store, kept: Sequence[dict[str, Any]]) -> None:
    """Forget chunks whose maps are not what their parts say, or whose rows cannot be read."""
    bad = []
    for chunk, told in enumerate(kept):
        try:
            _rows(store, chunk)
            if any(sha256_of(store.folder / file) != known for file, (_, known) in told["files"].items()):
                raise OSError("not as it was written")
        except (OSError, ValueError):  # of pages, of what stands around them
            bad.append(chunk)
            store.forget(chunk)
    if bad:
        raise InputError(
            f"{len(bad)} chunks in {store.folder} are not as they were written (the first: {bad[0]}); they were "
            "forgotten: run the study again with the same --out"
        )


def _rows(store: Store, chunk: int) -> Any:
    import pyarrow.parquet as pq

    with pq.ParquetFile(store.part(chunk), page_checksum_verification=True) as opened:
        return opened.read()


def _write_jobs(store: Store, writer: Writer) -> dict[str, int]:
    import pyarrow.parquet as pq

    chunks = range(store.study.chunks)
    figures = figure_types(store.study, (pq.read_schema(store.part(k)) for k in chunks))
    schema = schema_of(store.study, figures, {**notes(store.study), "schema_version": str(SCHEMA_VERSION)})
    found: dict[str, int] = {}
    with writer.into(store.folder / JOBS) as scratch, pq.ParquetWriter(scratch, schema) as out:
        for table in _in_groups(cast(_rows(store, k), schema) for k in chunks):
            out.write_table(table, row_group_size=_ROWS)
            for verdict in table.column("verdict").to_pylist():
                found[verdict] = found.get(verdict, 0) + 1
    return found


def _in_groups(tables: Iterator[Any]) -> Iterator[Any]:
    """The same rows in tables of so many as a row group has, the last one of what is left."""
    import pyarrow as pa

    waiting: list[Any] = []
    for table in tables:
        waiting.append(table)
        if sum(map(len, waiting)) >= _ROWS:
            whole = pa.concat_tables(waiting).combine_chunks()
            full = len(whole) // _ROWS * _ROWS
            yield whole.slice(0, full)
            waiting = [whole.slice(full)]
    if sum(map(len, waiting)):
        yield pa.concat_tables(waiting).combine_chunks()


def _write_timings(store: Store, writer: Writer, kept: Sequence[dict[str, Any]]) -> None:
    """A row a chunk: what its computation took [s], and where it was computed."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    names = sorted({name for told in kept for name in told["seconds"]})
    jobs = [store.study.jobs_of(chunk) for chunk in range(len(kept))]
    columns = {
        "chunk": list(range(len(kept))),
        "first_job": [j.start for j in jobs],
        "jobs": [len(j) for j in jobs],
        "device": [told["device"] for told in kept],
        **{f"{name.removesuffix('_s')}_s": [told["seconds"].get(name) for told in kept] for name in names},
    }
    with writer.into(store.folder / TIMINGS) as scratch:
        pq.write_table(pa.table(columns), scratch)


def _manifest(store: Store, kept: Sequence[dict[str, Any]], verdicts: dict[str, int]) -> bytes:
    study = store.study
    told = {
        "schema_version": SCHEMA_VERSION,
        "study": {"name": study.name, "summary": study.summary, "method": study.method, "seed": study.seed},
        "measure": study.asked.measure,
        "cross_checked": study.asked.cross_checked,
        "jobs": len(study),
        "verdicts": dict(sorted(verdicts.items())),
        "versions": {"gearsim": __version__, "sources": sources(), "python": python_version(), **_libraries()},
        "devices": sorted({told["device"].split(":")[0] for told in kept}),
        "parameters": [
            {"key": p.key, "unit": p.unit, "lower": _bound(p.lower), "upper": _bound(p.upper)} for p in study.parameters
        ],
        "conventions": {"sign": SIGN, "units": UNITS, "missing": MISSING},
        "not_in_files": f"{TIMINGS} and what is made of the data set, which no rerun need leave the same",
        "files": _files(store.folder),
    }
    return (json.dumps(told, indent=1, ensure_ascii=False) + "\n").encode()


def _libraries() -> dict[str, str]:
    return {name: version(name) for name in _LIBRARIES}


def _bound(x: float) -> float | None:
    return None if x != x else x


def _files(folder: Path) -> dict[str, dict[str, Any]]:
    """Size and checksum of all files of the data set."""
    files = [folder / STUDY, folder / JOBS]
    files += sorted(f for group in (MAPS, EXR) for f in (folder / group).rglob("*") if f.is_file())
    return {
        f.relative_to(folder).as_posix(): {"bytes": f.stat().st_size, "sha256": sha256_of(f)}
        for f in files
    }  # fmt: skip

"""The folder of a study: what its workers keep as they go, whole chunks alone, so that a rerun goes on from there."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearsim.errors import InputError, is_file
from gearsim.studies.records import Outcome, Study
from gearsim.studies.study_file import Digests, as_json, differences, read_study_file, sources
from gearsim.studies.writing import Writer, refused, sha256

if TYPE_CHECKING:
    from gearsim.studies.map_files import ArrayKind

STUDY, PARTS, GRIDS_KEPT = "study.json", "parts", "parts/grids"
JOBS, MAPS, MANIFEST = "jobs.parquet", "maps.zarr", "manifest.json"
NOTE = b"gearsim.part"
_PART = re.compile(r"(\d{6,})-([0-9a-f]{16})\.parquet")
_SAMPLES = 2 * 32 * 64  # of a job whose scene does not say how many
_SHAPES = ("metrology.rows", "metrology.columns")


class Store:
    """A study's ``folder``, one of which every worker has for itself: ``create`` makes it, ``open`` joins it.

    A chunk counts once its part stands in parts/: rows, renamed into place after the chunk's maps, with their
    checksums; its name says what its results depend on, so that what another study, another scene file or
    another gearsim left behind is never taken for it.
    """

    def __init__(self, folder: Path, study: Study) -> None:
        self.folder, self.study = folder, study
        self._writer = Writer(folder)
        self._kept: dict[str, tuple[str, Path]] = {}

    @classmethod
    def create(cls, folder: Path, study: Study, samples: int | None = None) -> Store:
        """Make a study's folder, or open the one of this study to go on.

        ``samples``: of all maps of a job together; by default two surfaces of the scene's rows and columns. Raises
        InputError where the folder is another study's or cannot be written, the disk has not the room, or a parameter
        changes the size of the maps.
        """
        _refuse_shapes(study)
        store = cls(folder, study)
        store.refuse_another()
        data = as_json(study)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / PARTS).mkdir(exist_ok=True)
            if not store.done():  # whatever maps another gearsim left behind may have another shape
                for maps in (folder / MAPS, folder / GRIDS_KEPT):
                    shutil.rmtree(maps, ignore_errors=True)
        except OSError as error:
            raise InputError(
                f"cannot write into the study's folder {folder}: {error.strerror or error}; choose another with --out"
            ) from error
        store._refuse_size(samples)
        if not is_file(folder / STUDY) or (folder / STUDY).read_bytes() != data:
            store._writer.put(folder / STUDY, data)
        return store

    def refuse_another(self) -> None:
        """Raises InputError where the folder is a file, or holds another study."""
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"{self.folder} is a file; expected the study's folder, or none so far")
        if not is_file(self.folder / STUDY):
            return
        _, there = read_study_file(self.folder / STUDY)
        if differ := differences(there, json.loads(as_json(self.study))):
            raise InputError(
                f"{self.folder} holds another study: {'; '.join(differ[:8])}{'; ...' * (len(differ) > 8)}; "
                "choose another folder with --out, or remove this one"
            )

    @classmethod
    def open(cls, folder: Path) -> Store:
        """Join a study's folder as a worker. Raises InputError where there is none, or another gearsim made it."""
        study, told = read_study_file(folder / STUDY)
        if told["sources"] != sources():
            raise InputError(
                f"{folder} is computed by gearsim {told['gearsim']} with other sources ({told['sources']}) than this "
                f"process has ({sources()}); every worker needs the same gearsim"
            )
        return cls(folder, study)

    @cached_property
    def _digests(self) -> list[str]:
        digests = Digests(self.study)
        return [digests.of(chunk) for chunk in range(self.study.chunks)]

    @cached_property
    def _types(self) -> dict[str, Any]:
        from gearsim.studies.rows import parameter_types

        return parameter_types(self.study)

    def part(self, chunk: int) -> Path:
        """Where a chunk's rows stand, once it is done."""
        return self.folder / PARTS / f"{chunk:06d}-{self._digests[chunk]}.parquet"

    def done(self) -> set[int]:
        """The chunks that need not be computed: their part stands, and their maps have the size that it says."""
        try:
            names = {f.name for f in (self.folder / PARTS).iterdir()}
        except OSError as error:
            raise InputError(f"cannot read {self.folder / PARTS}: {error.strerror}") from error
        return {k for k in range(self.study.chunks) if self.part(k).name in names and self.has(k)}

    def has(self, chunk: int) -> bool:
        """Whether a chunk's part stands and is whole, its maps of the size that it says."""
        try:
            kept = self.kept(chunk)
            sizes = {self.folder / file: size for file, (size, _) in kept["files"].items()}
            return all(file.stat().st_size == size for file, size in sizes.items())
        except (OSError, ValueError, KeyError, TypeError):
            return False

    def kept(self, chunk: int) -> dict[str, Any]:
        """What a part says of its chunk: ``files`` with size and checksum, ``surfaces``, ``seconds``, ``device``.

        Raises OSError or ValueError where the part is not whole.
        """
        import pyarrow.parquet as pq

        meta = pq.read_metadata(self.part(chunk))
        if meta.num_rows != len(self.study.jobs_of(chunk)):
            raise ValueError(f"{self.part(chunk)} has {meta.num_rows} rows")
        return dict(json.loads(meta.metadata[NOTE]))

    def put(self, chunk: int, outcomes: Sequence[Outcome], seconds: Mapping[str, float], device: str = "cpu") -> None:
        """Keep a chunk: its maps first, then its rows, whose part is what counts. A chunk that is done stays as it is.

        ``seconds`` by what they were spent on. Raises InputError where the disk refuses it, and ValueError where
        outcomes are not those of the chunk's jobs.
        """
        import pyarrow.parquet as pq

        from gearsim.studies.rows import table_of

        outcomes = sorted(outcomes, key=lambda o: o.job)
        if [o.job for o in outcomes] != list(self.study.jobs_of(chunk)):
            raise ValueError(f"chunk {chunk} has jobs {self.study.jobs_of(chunk)}, got {[o.job for o in outcomes]}")
        table = table_of(self.study, self._types, outcomes)
        if self.has(chunk):
            return  # by another worker: a task may run twice at once
        self.open_again()
        note = self._put_maps(chunk, outcomes) | {"seconds": dict(seconds), "device": device}
        with self._writer.into(self.part(chunk)) as scratch:
            pq.write_table(table.replace_schema_metadata({NOTE: json.dumps(note)}), scratch, write_page_checksum=True)
        stale = (self.folder / PARTS).glob(f"{chunk:06d}-*.parquet")
        self._remove([file for file in stale if file != self.part(chunk) and _PART.fullmatch(file.name)])

    def release(self) -> None:
        """Leave no scratch in the folder, while others finish it."""
        self._writer.release()

    def forget(self, chunk: int) -> None:
        """Drop a chunk's part, so that the chunk is not done."""
        self._remove([self.part(chunk)])

    def open_again(self) -> None:
        """Say that the data set is not complete: it has no manifest until it is finished."""
        self._remove([self.folder / MANIFEST])

    def finish(self, exr: bool = False) -> dict[str, int]:
        """Make the data set of all chunks; how many jobs have each verdict.

        ``exr``: also an EXR file a job; once there, they are made anew without being asked for. Raises InputError
        where chunks are missing, or are not as they were written.
        """
        from gearsim.studies.data_set import join

        return join(self, self._writer, exr)

    def _put_maps(self, chunk: int, outcomes: Sequence[Outcome]) -> dict[str, Any]:
        """Write the chunk's files of all arrays; what its part says of them."""
        from gearsim.studies.surface_arrays import GRIDS, grid_digest, kinds_of, surfaces_of, values_of

        files: dict[str, tuple[int, str]] = {}
        surfaces: dict[str, Any] = {}
        for surface, shape in surfaces_of(outcomes).items():
            first = next(k for k, o in enumerate(outcomes) if surface in o.maps)
            surfaces[surface] = {"shape": shape, "grid": grid_digest(outcomes, surface), "first": first}
            for field, kind in kinds_of(self.study, surface, shape).items():
                group = GRIDS_KEPT if field in GRIDS else MAPS
                self._describe(kind, self.folder / group, surface)
                data = kind.chunk_file(values_of(field, kind, surface, outcomes))
                file = f"{group}/{kind.place(chunk)}"
                if data is not None:
                    files[file] = len(data), sha256(data)
                    self._keep(kind.name, self.folder / file, data, files[file][1])
        self._remove([file for file in self._all_of(chunk) if file.relative_to(self.folder).as_posix() not in files])
        return {"files": files, "surfaces": surfaces}

    def _keep(self, array: str, file: Path, data: bytes, checksum: str) -> None:
        """Write a chunk's file; where samples lie is mostly as in the chunk before, and then one file on the disk."""
        known, before = self._kept.get(array, ("", file))
        if known == checksum and before != file and is_file(before):
            self._writer.link(before, file)
        else:
            self._writer.put(file, data)
        self._kept[array] = checksum, file

    def _describe(self, kind: ArrayKind, group: Path, surface: str) -> None:
        """Write an array's metadata, or see that what stands there is of the same shape."""
        file, here = group / kind.described, list(kind.shape)
        if not is_file(file):
            self._writer.put(file, kind.files()[kind.described])
            return
        there = json.loads(file.read_bytes())["shape"]
        if here != there:
            raise InputError(f"{surface}: expected maps of shape {there[1:3]} as in the other jobs, got {here[1:3]}")

    def _all_of(self, chunk: int) -> list[Path]:
        """All files of a chunk that stand in arrays, this study's or left behind."""
        found = [self.folder / group for group in (MAPS, GRIDS_KEPT)]
        return [f for group in found for f in group.glob(f"*_*/c/{chunk}/**/*") if f.is_file()]

    def _remove(self, files: Sequence[Path]) -> None:
        try:
            for file in files:
                file.unlink(missing_ok=True)
        except OSError as error:
            raise refused(self.folder, error) from error

    def _refuse_size(self, samples: int | None) -> None:
        need, free = self.need(samples), shutil.disk_usage(self.folder).free
        if need > free:
            raise InputError(
                f"the study's {len(self.study):,} jobs need about {need / 1e6:,.0f} MB in {self.folder}, where "
                f"{free / 1e6:,.0f} MB are free; vary fewer values, lower metrology.rows and columns, or choose "
                "another folder with --out"
            )

    def need(self, samples: int | None = None) -> float:
        """About how many bytes the jobs take that are not done, from above."""
        if samples is None:
            table = self.study.tables.get("metrology", {})
            known = "rows" in table and "columns" in table
            samples = 2 * int(table["rows"]) * int(table["columns"]) if known else _SAMPLES
        maps = 10.0 * samples if "maps" in self.study.asked.measure else 0.0
        row = 20.0 * (len(self.study.parameters) + 40)
        return (maps + row) * len(self.study) * (1.0 - len(self.done()) / self.study.chunks) + 64.0 * samples


def _refuse_shapes(study: Study) -> None:
    for parameter in study.parameters:
        if parameter.key in _SHAPES and len(set(parameter.values)) > 1 and "maps" in study.asked.measure:
            raise InputError(
                f"{parameter.key} is varied, but the maps of all jobs stand in one array of one shape; fix it with "
                "[study.set], or leave maps out of study.measure"
            )

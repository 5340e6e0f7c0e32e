"""A finished study's data set, opened again: its table, its maps, what its manifest says."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, is_file
from gearsim.studies.store import JOBS, MANIFEST, MAPS, STUDY
from gearsim.studies.surface_arrays import array_name, surfaces_in
from gearsim.studies.writing import sha256_of


@dataclass(frozen=True)
class DataSet:
    """A finished study's folder, read back. Raises InputError where a file is missing or no such."""

    folder: Path

    @cached_property
    def manifest(self) -> dict[str, Any]:
        return dict(self._json(MANIFEST))

    def verify(self) -> None:
        """See that every file is as the manifest says. Raises InputError where one is gone or was changed."""
        files = self.manifest["files"]
        gone = [name for name in files if not is_file(self.folder / name)]
        changed = [n for n, told in files.items() if n not in gone and sha256_of(self.folder / n) != told["sha256"]]
        if bad := [*(f"{name} is gone" for name in gone), *(f"{name} was changed" for name in changed)]:
            raise InputError(
                f"{self.folder} is not as its {MANIFEST} says: {bad[0]} ({len(bad)} of {len(files)} files); run the "
                "study again with the same --out"
            )

    @cached_property
    def told(self) -> dict[str, Any]:
        """study.json as plain values."""
        return dict(self._json(STUDY))

    def _json(self, name: str) -> Any:
        try:
            return json.loads((self.folder / name).read_bytes())
        except (OSError, ValueError) as error:
            raise InputError(f"cannot read {self.folder / name}: {error}") from error

    @cached_property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The columns of the jobs' table: numbers with nan where there is none, or objects."""
        import pyarrow.parquet as pq

        try:
            return columns_of(pq.read_table(self.folder / JOBS))
        except (OSError, ValueError) as error:
            raise InputError(f"cannot read {self.folder / JOBS}: {error}") from error

    @property
    def keys(self) -> list[str]:
        """The keys of what is varied."""
        return [p["key"] for p in self.manifest["parameters"]]

    def values(self, key: str) -> list[Any]:
        """A scene's key in all jobs, varied or fixed."""
        if key in self.keys:
            return list(self.columns[key].tolist())
        value: Any = self.told["tables"]
        for part in key.split("."):
            try:
                value = value[int(part)] if isinstance(value, list) else value[part]
            except (KeyError, IndexError, ValueError, TypeError) as error:
                raise InputError(
                    f"{key} is varied in one study, but {self.folder / STUDY} does not state it; jobs cannot be matched"
                ) from error
        return [value] * len(self.columns["job"])

    @cached_property
    def maps(self) -> dict[str, tuple[Any, Any]]:
        """The arrays of deviations and of what was met, by surface; none where no maps were measured."""
        import zarr

        if not (self.folder / MAPS).is_dir():
            return {}
        group: Any = zarr.open_group(self.folder / MAPS, mode="r")
        return {s: (group[array_name(s, "deviation_um")], group[array_name(s, "crossing")]) for s in surfaces_in(group)}


def columns_of(table: Any) -> dict[str, NDArray[Any]]:
    """A table's columns: numbers as floats, nan where there is none; whatever else as objects."""
    import pyarrow as pa

    out = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        numbers = pa.types.is_integer(column.type) or pa.types.is_floating(column.type)
        out[name] = (
            column.cast(pa.float64()).to_numpy(zero_copy_only=False) if numbers
            else np.array(column.to_pylist(), dtype=object)
        )  # fmt: skip
    return out
